"""Membership functions: degrees by their definition, straight parts that rebuild them, refusals."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzzy import sets, shapes
from fuzzy.errors import InvalidSystemError
from fuzzy.shapes import Gaussian, Shape, Trapezoid, Triangle
from fuzzy.validation.shapes import validate_shape
from tests import plain, reference, strategies

INF = math.inf


@given(strategies.shapes_on(-2.0, 3.0), st.lists(st.floats(-5.0, 6.0), min_size=1, max_size=20))
def test_degrees_follow_the_definition(shape: Shape, x: list[float]) -> None:
    x += [value for value in shapes.parameters(shape) if math.isfinite(value)]
    found = plain.degrees(shape, x)
    number = reference.exact if not isinstance(shape, Gaussian) else reference.number_of_curved
    wanted = [float(reference.degree(shape, number(value), number)) for value in x]
    assert found == pytest.approx(wanted, rel=5e-13, abs=1e-300)  # exp of up to -720
    assert found.min() >= 0
    assert found.max() <= 1


@pytest.mark.parametrize(
    ("shape", "x", "degree"),
    [
        (Triangle(0.0, 0.0, 1.0), [-1e-9, 0.0, 0.25, 1.0], [0.0, 1.0, 0.75, 0.0]),
        (Triangle(0.0, 1.0, 1.0), [0.0, 0.25, 1.0, 1.0 + 1e-9], [0.0, 0.25, 1.0, 0.0]),
        (Triangle(2.0, 2.0, 2.0), [1.9, 2.0, 2.1], [0.0, 1.0, 0.0]),
        (Triangle(-INF, 0.0, 1.0), [-1e300, 0.0, 0.5], [1.0, 1.0, 0.5]),
        (Triangle(0.0, 1.0, INF), [0.5, 1.0, 1e300], [0.5, 1.0, 1.0]),
        (Trapezoid(0.0, 0.0, 1.0, 1.0), [-1e-9, 0.0, 1.0, 1.0 + 1e-9], [0.0, 1.0, 1.0, 0.0]),
        (Trapezoid(-INF, 0.0, 1.0, INF), [-1e300, 0.5, 1e300], [1.0, 1.0, 1.0]),
        (Gaussian(1.0, 2.0), [1.0, 3.0, 1e300], [1.0, math.exp(-0.5), 0.0]),
    ],
)
def test_sides_may_be_vertical_or_open(shape, x, degree):
    assert plain.degrees(shape, x).tolist() == degree


def test_degrees_keep_the_form_of_their_argument():
    assert plain.degrees(Triangle(0.0, 1.0, 2.0), 0.5).shape == ()
    assert plain.degrees(Triangle(0.0, 1.0, 2.0), np.ones((2, 0, 3))).shape == (2, 0, 3)
    assert plain.degrees(Triangle(0.0, 1.0, 2.0), [[1, 2], [0, 1]]).tolist() == [[1.0, 0.0], [0.0, 1.0]]


@given(strategies.shapes_on(-2.0, 3.0, has_gaussians=False))
def test_straight_parts_join_and_rebuild_the_shape(shape: Shape) -> None:
    parts = sets.segments(plain.term(shape))
    for one, other in itertools.pairwise(parts):
        assert (one.right, one.at_right) == (other.left, other.at_left)
    for part in parts:
        left, right = max(part.left, -9.0), min(part.right, 9.0)
        inside = np.linspace(left, right, 5)
        if math.isfinite(part.left) and math.isfinite(part.right):
            line = np.linspace(part.at_left, part.at_right, 5)
        else:
            line = np.full(5, part.at_left)
        if left < right:
            assert plain.degrees(shape, inside[1:-1]) == pytest.approx(line[1:-1], abs=1e-12)
        else:
            assert plain.degrees(shape, left) == max(part.at_left, part.at_right)


@pytest.mark.parametrize(
    ("shape", "message"),
    [
        (Triangle(1.0, 0.0, 2.0), "triangle [1, 0, 2] is not in order: valid is a ≤ b ≤ c"),
        (Trapezoid(0.0, 2.0, 1.0, 3.0), "not in order: valid is a ≤ b ≤ c ≤ d"),
        (Triangle(math.nan, 0.0, 1.0), "not a number"),
        (Triangle(-INF, 0.0, INF), "at most one side may be open"),
        (Triangle(INF, INF, INF), "only the outer values may be infinite"),
        (Trapezoid(-INF, -INF, 0.0, 1.0), "only the outer values may be infinite"),
        (Gaussian(0.0, 0.0), "sigma finite and greater than 0"),
        (Gaussian(0.0, -1.0), "sigma finite and greater than 0"),
        (Gaussian(INF, 1.0), "all values must be finite"),
    ],
)
def test_what_is_no_set_is_refused(shape, message):
    with pytest.raises(InvalidSystemError) as caught:
        validate_shape(shape, "inputs.e.terms.NB")
    assert message in str(caught.value)
    assert caught.value.path == "inputs.e.terms.NB"


@given(strategies.shapes_on(-2.0, 3.0))
def test_generated_shapes_are_valid(shape: Shape) -> None:
    validate_shape(shape)
    assert all(math.isfinite(point) for point in sets.break_points(plain.term(shape)))
