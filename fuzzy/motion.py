"""Where a set goes when its universe is stretched, shifted or mirrored."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import assert_never

from msgspec.structs import replace

from fuzzy.shapes import (
    Bell,
    Concave,
    Cosine,
    Gaussian,
    Gaussian2,
    Linear,
    PiShape,
    Points,
    Ramp,
    Rectangle,
    Shape,
    Sigmoid,
    SigmoidDifference,
    SigmoidProduct,
    Singleton,
    Spike,
    SShape,
    Trapezoid,
    Triangle,
    ZShape,
    parameters,
)


def reflected(shape: Shape, middle: float) -> Shape:
    """Return the mirror image of a set about a place; a linear function stays as it is."""
    match shape:
        case SShape(a=a, b=b):
            return ZShape(2 * middle - b, 2 * middle - a)
        case ZShape(a=a, b=b):
            return SShape(2 * middle - b, 2 * middle - a)
        case Gaussian2(left_mean=left, left_sigma=left_sigma, right_mean=right, right_sigma=right_sigma):
            return Gaussian2(2 * middle - right, right_sigma, 2 * middle - left, left_sigma)
        case Sigmoid(center=center, slope=slope):
            return Sigmoid(2 * middle - center, -slope)
        case SigmoidDifference() | SigmoidProduct():
            left, left_slope, right, right_slope = parameters(shape)
            return type(shape)(2 * middle - right, -right_slope, 2 * middle - left, -left_slope)
        case Gaussian(mean=mean):
            return replace(shape, mean=2 * middle - mean)
        case Bell(center=center) | Cosine(center=center) | Spike(center=center):
            return replace(shape, center=2 * middle - center)
        case Points(points=points):
            return Points(tuple((2 * middle - x, degree) for x, degree in reversed(points)))
        case Triangle() | Trapezoid() | Rectangle() | PiShape() | Singleton():
            return type(shape)(*(2 * middle - value for value in reversed(parameters(shape))))
        case Ramp() | Concave():
            return type(shape)(*(2 * middle - value for value in parameters(shape)))
        case Linear():
            return shape
        case _:
            assert_never(shape)


def moved(shape: Shape, place: Callable[[float], float], factor: float) -> Shape:
    """Return a set whose universe was shifted and stretched.

    Args:
        shape: A set; a linear function stays as it is.
        place: Where a point of the universe goes; infinite ones stay.
        factor: By how much lengths are stretched, greater than 0.
    """
    match shape:
        case Linear():
            return shape
        case Points(points=points):
            return Points(tuple((place(x), degree) for x, degree in points))
        case Sigmoid(center=center, slope=slope):
            return Sigmoid(place(center), slope / factor)
        case SigmoidDifference() | SigmoidProduct():
            left, left_slope, right, right_slope = parameters(shape)
            return type(shape)(place(left), left_slope / factor, place(right), right_slope / factor)
        case Gaussian2(left_mean=left, right_mean=right):
            left, right = (place(value) if math.isfinite(value) else value for value in (left, right))
            return Gaussian2(left, shape.left_sigma * factor, right, shape.right_sigma * factor)
        case Gaussian(mean=mean, sigma=sigma):
            return Gaussian(place(mean), sigma * factor)
        case Bell() | Cosine() | Spike():
            return replace(shape, center=place(shape.center), width=shape.width * factor)
        case _:
            return type(shape)(*(place(value) if math.isfinite(value) else value for value in parameters(shape)))
