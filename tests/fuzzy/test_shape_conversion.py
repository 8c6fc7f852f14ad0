"""A converted shape stands where the old one stood."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzzy import edits, formats, shapes
from fuzzy.errors import InvalidSystemError
from fuzzy.shapes import Gaussian, Shape, Trapezoid, Triangle

_KINDS = [shapes.kind(shape) for shape in shapes.SHAPES]


def closed_shapes() -> st.SearchStrategy[Shape]:
    widths = st.floats(0.1, 10.0)
    center = st.floats(-10.0, 10.0)
    triangles = st.builds(lambda b, left, right: Triangle(b - left, b, b + right), center, widths, widths)
    trapezoids = st.builds(
        lambda b, left, top, right: Trapezoid(b - left, b, b + top, b + top + right), center, widths, widths, widths
    )
    return st.one_of(triangles, trapezoids, st.builds(Gaussian, center, widths))


@given(closed_shapes(), st.sampled_from(_KINDS))
def test_a_converted_shape_is_valid_and_crosses_one_half_in_the_same_places(shape: Shape, kind: str) -> None:
    converted = shapes.converted(shape, kind)
    shapes.validate(converted)
    assert shapes.kind(converted) == kind
    x = np.linspace(-40.0, 40.0, 20_001)
    before, after = (x[shapes.degrees(each, x) >= 0.5] for each in (shape, converted))
    if "gaussian" in (kind, shapes.kind(shape)):  # symmetric: the widths agree, unless the sides differed
        widths = np.ptp(before), np.ptp(after)
        assert widths[0] == pytest.approx(widths[1], abs=0.02)
    else:
        assert before[0] == pytest.approx(after[0], abs=0.01)
        assert before[-1] == pytest.approx(after[-1], abs=0.01)


@pytest.mark.parametrize("kind", _KINDS)
@pytest.mark.parametrize(
    "shape", [Triangle(-math.inf, 0.0, 1.0), Triangle(0.0, 1.0, math.inf), Trapezoid(-math.inf, 0.0, 1.0, 2.0)]
)
def test_an_open_shoulder_stays_open_where_the_kind_can_be(shape: Shape, kind: str) -> None:
    converted = shapes.converted(shape, kind)
    shapes.validate(converted)
    if kind != "gaussian":
        infinite = [math.isinf(value) for value in shapes.parameters(converted)]
        assert infinite[0] == math.isinf(shapes.parameters(shape)[0])
        assert infinite[-1] == math.isinf(shapes.parameters(shape)[-1])


def test_an_edit_changes_one_term_and_refuses_what_is_not_a_shape() -> None:
    system = formats.load("rulebases/diagonal.yaml")
    changed = edits.set_shape_kind(system, "e", "Z", "gaussian")
    assert shapes.kind(changed.inputs[0].terms[3].shape) == "gaussian"
    assert edits.set_shape(changed, "e", "Z", system.inputs[0].terms[3].shape) == system
    with pytest.raises(InvalidSystemError, match="unknown shape 'gausian'; did you mean 'gaussian'"):
        edits.set_shape_kind(system, "e", "Z", "gausian")
