"""One kind of set in the place of another: what a designer gets who chooses another shape for a term."""

from __future__ import annotations

import math
from typing import NamedTuple, assert_never

from fuzzy.errors import InvalidSystemError, expected
from fuzzy.shapes import (
    SHAPES,
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
    kind,
)

_HALF_WIDTH = math.sqrt(2.0 * math.log(2.0))
"""Distance from a Gaussian's mean to where its degree is 1/2, in sigmas."""

_NEARLY_ONE = math.log(99.0)
"""Distance from a sigmoid's center to where its degree is 0.99, in 1/slope."""


class Outline(NamedTuple):
    """Where a set crosses 1/2 and where its top begins and ends; infinite on an open side."""

    half_left: float
    top_left: float
    top_right: float
    half_right: float


def converted(shape: Shape, wanted: str) -> Shape:
    """Return another kind of shape that is 1 in the same place and crosses 1/2 at the same points.

    A side that is open stays open where the wanted kind can be; otherwise it mirrors the other side.

    Args:
        shape: A valid set.
        wanted: The schema's word for the wanted kind.

    Raises:
        InvalidSystemError: No such kind, or a linear function, which is no set.
    """
    kinds = {kind(entry): entry for entry in SHAPES}
    if wanted not in kinds:
        raise InvalidSystemError(f"unknown shape {expected(wanted, kinds)}")
    return shape if wanted == kind(shape) else _built(wanted, outline(shape))


def outline(shape: Shape) -> Outline:  # noqa: C901
    """Return where a set crosses 1/2 and where its top begins and ends."""
    match shape:
        case Triangle(a=a, b=b, c=c):
            return Outline((a + b) / 2, b, b, (b + c) / 2)
        case Trapezoid(a=a, b=b, c=c, d=d) | PiShape(a=a, b=b, c=c, d=d):
            return Outline((a + b) / 2, min(b, c), max(b, c), (c + d) / 2)
        case Rectangle(a=a, b=b):
            return Outline(a, a, b, b)
        case Singleton(value=value):
            return Outline(value, value, value, value)
        case Points(points=points):
            return _points_outline(points)
        case Gaussian(mean=mean, sigma=sigma):
            return Outline(mean - _HALF_WIDTH * sigma, mean, mean, mean + _HALF_WIDTH * sigma)
        case Gaussian2(left_mean=left, left_sigma=left_sigma, right_mean=right, right_sigma=right_sigma):
            return Outline(left - _HALF_WIDTH * left_sigma, left, right, right + _HALF_WIDTH * right_sigma)
        case Bell(center=center, width=width):
            return Outline(center - width, center, center, center + width)
        case Cosine(center=center, width=width):
            return Outline(center - width / 4, center, center, center + width / 4)
        case Spike(center=center, width=width):
            half = width * math.log(2.0) / 10
            return Outline(center - half, center, center, center + half)
        case Sigmoid(center=center, slope=slope):
            return _one_sided(center, center + (_NEARLY_ONE / slope if slope else 1.0), rises=slope >= 0)
        case (
            SigmoidDifference(left_center=one, right_center=other) | SigmoidProduct(left_center=one, right_center=other)
        ):
            left, right = sorted((one, other))
            return Outline(left, (left + right) / 2, (left + right) / 2, right)
        case SShape(a=a, b=b):
            return _one_sided((a + b) / 2, b, rises=True)
        case ZShape(a=a, b=b):
            return _one_sided((a + b) / 2, a, rises=False)
        case Ramp(start=start, end=end):
            return _one_sided((start + end) / 2, end, rises=start < end)
        case Concave(inflection=inflection, end=end):
            return _one_sided(inflection, end, rises=inflection < end)
        case Linear():
            raise InvalidSystemError("a linear function is no set: it cannot take another shape")
        case _:
            assert_never(shape)


def _one_sided(half: float, top: float, *, rises: bool) -> Outline:
    return Outline(half, top, math.inf, math.inf) if rises else Outline(-math.inf, -math.inf, top, half)


def _points_outline(points: tuple[tuple[float, float], ...]) -> Outline:
    highest = max(degree for _, degree in points)
    tops = [x for x, degree in points if degree == highest]
    above = [x for x, degree in points if 2 * degree >= highest]
    first, last = points[0], points[-1]
    left = -math.inf if 2 * first[1] >= highest else _half(points, above[0], highest, -1)
    right = math.inf if 2 * last[1] >= highest else _half(points, above[-1], highest, 1)
    top_left = -math.inf if math.isinf(left) else tops[0]
    top_right = math.inf if math.isinf(right) else tops[-1]
    if math.isinf(top_left) and math.isinf(top_right):
        return Outline(tops[0], tops[0], tops[-1], tops[-1])
    return Outline(left, top_left, top_right, right)


def _half(points: tuple[tuple[float, float], ...], inner: float, highest: float, side: int) -> float:
    """Return where the line from ``inner`` to the next point on a side (-1 left, 1 right) crosses half the height."""
    ordered = points[::side]
    number = next(i for i, (x, degree) in enumerate(ordered[::-1]) if x == inner and 2 * degree >= highest)
    number = len(ordered) - 1 - number
    (x1, y1), (x2, y2) = ordered[number], ordered[number + 1]
    return x1 + (x2 - x1) * (y1 - highest / 2) / (y1 - y2)


def _built(wanted: str, outline: Outline) -> Shape:  # noqa: C901
    half_left, top_left, top_right, half_right = outline
    is_falling = math.isinf(half_left) and not math.isinf(half_right)
    closed = _closed(outline)
    top = (closed.top_left + closed.top_right) / 2
    width = (closed.half_right - closed.half_left) / 2 or 1.0
    match wanted:
        case "triangle":
            return Triangle(2 * half_left - top, top, 2 * half_right - top)
        case "trapezoid":
            left, right = closed.top_left, closed.top_right
            if left == right:  # A plateau that reaches half way from the top to the points of degree 1/2.
                left = (half_left + top) / 2 if math.isfinite(half_left) else top
                right = (half_right + top) / 2 if math.isfinite(half_right) else top
            return Trapezoid(2 * half_left - left, left, right, 2 * half_right - right)
        case "gaussian":
            sides = (top - half_left, half_right - top)
            halves = [side for side in sides if math.isfinite(side) and side > 0]
            return Gaussian(top, sum(halves) / len(halves) / _HALF_WIDTH if halves else 1.0)
        case "gaussian2":
            sigmas = [
                (side or width) / _HALF_WIDTH
                for side in (closed.top_left - closed.half_left, closed.half_right - closed.top_right)
            ]
            left = top_left if math.isfinite(half_left) else -math.inf
            right = top_right if math.isfinite(half_right) else math.inf
            return Gaussian2(left, sigmas[0], right, sigmas[1])
        case "bell":
            return Bell((closed.half_left + closed.half_right) / 2, width, 2.0)
        case "sigmoid":
            half, edge = (half_right, top_right) if is_falling else (closed.half_left, closed.top_left)
            return Sigmoid(half, _NEARLY_ONE / (edge - half or (-width if is_falling else width)))
        case "sigmoid_difference" | "sigmoid_product":
            slope = _NEARLY_ONE / width
            kind_of = SigmoidDifference if wanted == "sigmoid_difference" else SigmoidProduct
            return kind_of(
                closed.half_left, slope, closed.half_right, slope if kind_of is SigmoidDifference else -slope
            )
        case "s_shape":
            return SShape(2 * closed.half_left - closed.top_left, closed.top_left)
        case "z_shape":
            return ZShape(closed.top_right, 2 * closed.half_right - closed.top_right)
        case "pi_shape":
            left, right = closed.top_left, closed.top_right
            return PiShape(2 * closed.half_left - left, left, right, 2 * closed.half_right - right)
        case "ramp" | "concave":
            half, edge = (half_right, top_right) if is_falling else (closed.half_left, closed.top_left)
            if half == edge:
                half = edge + (width if is_falling else -width)
            return Ramp(2 * half - edge, edge) if wanted == "ramp" else Concave(half, edge)
        case "rectangle":
            return Rectangle(half_left, half_right)
        case "singleton":
            return Singleton(top)
        case "cosine":
            return Cosine((closed.half_left + closed.half_right) / 2, 4 * width)
        case "spike":
            return Spike(top, 10 * width / math.log(2.0))
        case _:
            corners = [(2 * half_left - top_left, 0.0), (top_left, 1.0), (top_right, 1.0)]
            corners.append((2 * half_right - top_right, 0.0))
            return Points(tuple(dict.fromkeys(corner for corner in corners if math.isfinite(corner[0]))))


def _closed(outline: Outline) -> Outline:
    """Return an outline with both sides finite: an open side mirrors the other one."""
    half_left, top_left, top_right, half_right = outline
    if not math.isfinite(top_left):
        top_left = top_right
    if not math.isfinite(top_right):
        top_right = top_left
    if not math.isfinite(half_left):
        half_left = top_left - (half_right - top_right)
    if not math.isfinite(half_right):
        half_right = top_right + (top_left - half_left)
    return Outline(half_left, top_left, top_right, half_right)
