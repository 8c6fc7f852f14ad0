"""Membership functions: one closed union of shapes and their invariants.

A shape is data; its degrees are computed by :mod:`fuzzy.kernels.membership`, here and in every controller alike.
"""

from __future__ import annotations

import math
from typing import NamedTuple, assert_never

import msgspec
import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzy.errors import InvalidSystemError, expected
from fuzzy.kernels import membership


class Triangle(msgspec.Struct, frozen=True, tag="triangle"):
    """Rises from ``a`` to 1 at ``b`` and falls to ``c``; ``a`` or ``c`` may be infinite, an open shoulder."""

    a: float
    b: float
    c: float


class Trapezoid(msgspec.Struct, frozen=True, tag="trapezoid"):
    """Rises from ``a`` to 1 at ``b``, stays to ``c`` and falls to ``d``; ``a`` or ``d`` may be infinite."""

    a: float
    b: float
    c: float
    d: float


class Gaussian(msgspec.Struct, frozen=True, tag="gaussian"):
    """exp(-(x - mean)² / (2 sigma²))."""

    mean: float
    sigma: float


Shape = Triangle | Trapezoid | Gaussian

SHAPES: tuple[type[Shape], ...] = (Triangle, Trapezoid, Gaussian)
"""All kinds of shapes, in the order in which they are offered."""

_HALF_WIDTH = math.sqrt(2.0 * math.log(2.0))
"""Distance from a Gaussian's mean to where its degree is 1/2, in sigmas."""

PIECEWISE_LINEAR = (Triangle, Trapezoid)
"""Shapes whose centroids have a closed form."""


def kind(shape: Shape | type[Shape]) -> str:
    """Return the schema's word for a shape, such as ``triangle``."""
    config = shape.__struct_config__
    return str(config.tag)


def parameter_names(shape: Shape | type[Shape]) -> tuple[str, ...]:
    """Return the names of a shape's parameters, in their order in files."""
    return shape.__struct_fields__


def parameters(shape: Shape) -> tuple[float, ...]:
    """Return a shape's parameters, in the order of ``parameter_names``."""
    return tuple(float(getattr(shape, name)) for name in shape.__struct_fields__)


def encode(shape: Shape) -> tuple[int, tuple[float, float, float, float]]:
    """Return a shape as the kernels read it: its code and four parameters, see :mod:`fuzzy.kernels.membership`."""
    match shape:
        case Triangle(a=a, b=b, c=c):
            return membership.TRAPEZOID, (a, b, b, c)
        case Trapezoid(a=a, b=b, c=c, d=d):
            return membership.TRAPEZOID, (a, b, c, d)
        case Gaussian(mean=mean, sigma=sigma):
            return membership.GAUSSIAN, (mean, sigma, 0.0, 0.0)
        case _:
            assert_never(shape)


def degrees(shape: Shape, x: ArrayLike) -> NDArray[np.float64]:
    """Return the membership degree of every value of ``x``.

    Args:
        shape: A valid shape.
        x: Crisp values of any shape, in the variable's unit.

    Returns:
        Degrees in [0, 1], of the shape of ``x``.
    """
    values = np.asarray(x, dtype=np.float64)
    degree = np.empty(values.size)
    code, four = encode(shape)
    membership.degrees(code, np.array(four), values.ravel(), degree)
    return degree.reshape(values.shape)


class Segment(NamedTuple):
    """A straight part of a membership function; where the ends are infinite or the same, so are the degrees."""

    left: float
    right: float
    at_left: float
    at_right: float


def segments(shape: Shape) -> tuple[Segment, ...]:
    """Return the straight parts of a piecewise-linear shape from left to right, closed at both ends; () if curved."""
    match shape:
        case Triangle(a=a, b=b, c=d):
            c = b
        case Trapezoid(a=a, b=b, c=c, d=d):
            pass
        case Gaussian():
            return ()
        case _:
            assert_never(shape)
    rise = Segment(a, b, 1.0 if math.isinf(a) else 0.0, 1.0)
    fall = Segment(c, d, 1.0, 1.0 if math.isinf(d) else 0.0)
    return (*((rise,) if a < b else ()), Segment(b, c, 1.0, 1.0), *((fall,) if c < d else ()))


def break_points(shape: Shape) -> tuple[float, ...]:
    """Return the finite points at which a piecewise-linear shape bends, or a curved shape's centre."""
    match shape:
        case Gaussian(mean=mean):
            return (mean,)
        case _:
            return tuple(value for value in parameters(shape) if math.isfinite(value))


def converted(shape: Shape, wanted: str) -> Shape:
    """Return another kind of shape that is 1 in the same place and crosses 1/2 at the same points.

    A side that is open stays open where the wanted kind can be; a Gaussian takes the width of its finite sides.

    Args:
        shape: A valid shape.
        wanted: The schema's word for the wanted kind.

    Raises:
        InvalidSystemError: No such kind.
    """
    kinds = {kind(entry): entry for entry in SHAPES}
    if wanted not in kinds:
        raise InvalidSystemError(f"unknown shape {expected(wanted, kinds)}")
    if wanted == kind(shape):
        return shape
    match shape:
        case Triangle(a=a, b=b, c=c):
            half_left, top_left, top_right, half_right = (a + b) / 2, b, b, (b + c) / 2
        case Trapezoid(a=a, b=b, c=c, d=d):
            half_left, top_left, top_right, half_right = (a + b) / 2, b, c, (c + d) / 2
        case Gaussian(mean=mean, sigma=sigma):
            half = _HALF_WIDTH * sigma
            half_left, top_left, top_right, half_right = mean - half, mean, mean, mean + half
    top = (top_left + top_right) / 2
    if wanted == "gaussian":
        halves = [width for width in (top - half_left, half_right - top) if math.isfinite(width) and width > 0]
        return Gaussian(top, sum(halves) / len(halves) / _HALF_WIDTH if halves else 1.0)
    if wanted == "triangle":
        return Triangle(2 * half_left - top, top, 2 * half_right - top)
    # A plateau that reaches half way from the top to the points of degree 1/2.
    left = (half_left + top) / 2 if math.isfinite(half_left) else top
    right = (half_right + top) / 2 if math.isfinite(half_right) else top
    return Trapezoid(2 * half_left - left, left, right, 2 * half_right - right)


def validate(shape: Shape, path: str = "") -> None:
    """Refuse a shape that is no fuzzy set.

    Raises:
        InvalidSystemError: With ``path``, the values found and the order that is valid.
    """
    values = parameters(shape)
    text = f"{kind(shape)} [{', '.join(f'{value:g}' for value in values)}]"
    if any(math.isnan(value) for value in values):
        raise InvalidSystemError(f"{text} holds a value that is not a number", path)
    match shape:
        case Gaussian(mean=mean, sigma=sigma):
            if not (math.isfinite(mean) and math.isfinite(sigma) and sigma > 0):
                raise InvalidSystemError(f"{text}: mean must be finite and sigma finite and greater than 0", path)
        case Triangle() | Trapezoid():
            names = " ≤ ".join(parameter_names(shape))
            if list(values) != sorted(values):
                raise InvalidSystemError(f"{text} is not in order: valid is {names}", path)
            if not all(math.isfinite(value) for value in values[1:-1]):
                raise InvalidSystemError(f"{text}: only the outer values may be infinite (.inf, -.inf)", path)
            if values[0] == math.inf or values[-1] == -math.inf:
                raise InvalidSystemError(f"{text}: an open shoulder is -.inf on the left or .inf on the right", path)
            if len(values) == 3 and math.isinf(values[0]) and math.isinf(values[2]):
                raise InvalidSystemError(f"{text} is 1 everywhere: at most one side may be open", path)
