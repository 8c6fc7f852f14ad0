"""A converted shape stands where the old one stood."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzzy import conversion, edits, formats, motion, shapes
from fuzzy.errors import InvalidSystemError
from fuzzy.shapes import Gaussian, Shape, Singleton, Trapezoid, Triangle
from fuzzy.validation.shapes import validate_shape
from tests import plain

_KINDS = [shapes.kind(shape) for shape in shapes.SHAPES]


def closed_shapes() -> st.SearchStrategy[Shape]:
    widths = st.floats(0.1, 10.0)
    center = st.floats(-10.0, 10.0)
    triangles = st.builds(lambda b, left, right: Triangle(b - left, b, b + right), center, widths, widths)
    trapezoids = st.builds(
        lambda b, left, top, right: Trapezoid(b - left, b, b + top, b + top + right), center, widths, widths, widths
    )
    return st.one_of(triangles, trapezoids, st.builds(Gaussian, center, widths))


EXACT = {"triangle", "trapezoid", "rectangle", "pi_shape", "points", "gaussian2"}
"""Kinds with two sides of their own."""

SYMMETRIC = {"gaussian", "bell", "cosine", "spike"}
"""Kinds of one width, which is that of both sides together."""

ONE_SIDED = {"s_shape", "z_shape", "ramp", "sigmoid", "concave"}
"""Kinds that take one side."""

OPEN_BOTH_ENDS = {"triangle", "trapezoid", "rectangle"}
"""Kinds whose parameters say that a side is open."""


@given(closed_shapes(), st.sampled_from(_KINDS))
def test_a_converted_shape_is_valid_and_crosses_one_half_in_the_same_places(shape: Shape, kind: str) -> None:
    converted = conversion.converted(shape, kind)
    validate_shape(converted)
    assert shapes.kind(converted) == kind
    x = np.linspace(-40.0, 40.0, 20_001)
    if kind == "singleton":
        assert isinstance(converted, Singleton)
        assert plain.degrees(shape, converted.value) > 0.5
        return
    before, after = (x[plain.degrees(each, x) >= 0.5] for each in (shape, converted))
    if kind in EXACT and not isinstance(shape, Gaussian):
        assert before[0] == pytest.approx(after[0], abs=0.01)
        assert before[-1] == pytest.approx(after[-1], abs=0.01)
    elif kind in SYMMETRIC or (kind in EXACT and isinstance(shape, Gaussian)):
        assert np.ptp(before) == pytest.approx(np.ptp(after), abs=0.02)
    elif kind in ONE_SIDED:
        assert min(abs(before[0] - after[0]), abs(before[-1] - after[-1])) < 0.01
    else:  # two sigmoids, which flatten each other a little
        assert kind in {"sigmoid_difference", "sigmoid_product"}
        assert np.ptp(after) == pytest.approx(np.ptp(before), rel=0.2, abs=0.02)


@pytest.mark.parametrize("kind", _KINDS)
@pytest.mark.parametrize(
    "shape", [Triangle(-math.inf, 0.0, 1.0), Triangle(0.0, 1.0, math.inf), Trapezoid(-math.inf, 0.0, 1.0, 2.0)]
)
def test_an_open_shoulder_stays_open_where_the_kind_can_be(shape: Shape, kind: str) -> None:
    converted = conversion.converted(shape, kind)
    validate_shape(converted)
    is_falling = math.isinf(shapes.parameters(shape)[0])
    if kind in OPEN_BOTH_ENDS:
        infinite = [math.isinf(value) for value in shapes.parameters(converted)]
        assert infinite[0] == is_falling
        assert infinite[-1] == (not is_falling)
    if kind in (OPEN_BOTH_ENDS | ONE_SIDED | {"gaussian2", "points"}) - {"s_shape", "z_shape"}:
        far = plain.degrees(converted, [-1e6, 1e6]).round(5).tolist()
        assert far == ([1.0, 0.0] if is_falling else [0.0, 1.0])


def _any_shape() -> st.SearchStrategy[Shape]:
    kinds = st.sampled_from(_KINDS)
    return st.builds(conversion.converted, closed_shapes(), kinds)


@given(_any_shape(), st.floats(-5.0, 5.0), st.floats(0.1, 10.0), st.floats(-5.0, 5.0))
def test_a_set_is_moved_with_its_universe(shape: Shape, x: float, factor: float, shift: float) -> None:
    moved = motion.moved(shape, lambda place: factor * place + shift, factor)
    near = plain.degrees(shape, [x - 1e-9, x, x + 1e-9])
    assert near.min() - 1e-6 <= plain.degrees(moved, factor * x + shift) <= near.max() + 1e-6


@given(_any_shape(), st.floats(-5.0, 5.0), st.floats(-5.0, 5.0))
def test_a_mirrored_set_has_the_degrees_of_the_mirrored_places(shape: Shape, middle: float, x: float) -> None:
    mirrored = motion.reflected(shape, middle)
    validate_shape(mirrored)
    near = plain.degrees(shape, [2 * middle - x - 1e-9, 2 * middle - x, 2 * middle - x + 1e-9])
    assert near.min() - 1e-6 <= plain.degrees(mirrored, x) <= near.max() + 1e-6
    again = motion.reflected(mirrored, middle)
    assert shapes.parameters(again) == pytest.approx(shapes.parameters(shape), abs=1e-12)


@given(_any_shape())
def test_a_shape_is_built_from_its_parameters(shape: Shape) -> None:
    assert shapes.build(shapes.kind(shape), shapes.parameters(shape)) == shape
    for name, value in zip(shapes.parameter_names(shape), shapes.parameters(shape), strict=True):
        assert shapes.with_parameter(shape, name, value) == shape


def test_an_edit_changes_one_term_and_refuses_what_is_not_a_shape() -> None:
    system = formats.load("rulebases/diagonal.yaml")
    changed = edits.set_shape_kind(system, "e", "Z", "gaussian")
    assert shapes.kind(changed.inputs[0].terms[3].shape) == "gaussian"
    assert edits.set_shape(changed, "e", "Z", system.inputs[0].terms[3].shape) == system
    with pytest.raises(InvalidSystemError, match="unknown shape 'gausian'; did you mean 'gaussian'"):
        edits.set_shape_kind(system, "e", "Z", "gausian")
