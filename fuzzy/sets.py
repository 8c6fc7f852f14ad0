"""The fuzzy set of a term: its shape, complemented where the term says so, times its height.

Piecewise-linear sets are lists of straight segments; all others reach the kernels as a code and parameters.
"""

from __future__ import annotations

import itertools
import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzy.kernels import codes, membership
from fuzzy.shapes import (
    PIECEWISE_LINEAR,
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
    locations,
)
from fuzzy.system import Term

_LEAST = 1.3e-14
"""Degree below which a curved set counts as 0: a Gaussian's beyond eight sigma."""

_LOG_LEAST = -math.log(_LEAST)


class Segment(NamedTuple):
    """A straight part of a membership function; where the ends are infinite or the same, so are the degrees."""

    left: float
    right: float
    at_left: float
    at_right: float


class Encoded(NamedTuple):
    """A set as the kernels read it; see :mod:`fuzzy.kernels.membership`."""

    code: int
    parameters: tuple[float, ...]  # codes.WIDTH of them
    values: tuple[float, ...]  # what does not fit in: the coordinates of points, the coefficients of a function


def is_linear(term: Term) -> bool:
    """Return whether a term's set is piecewise linear."""
    return isinstance(term.shape, PIECEWISE_LINEAR)


def is_singleton(term: Term) -> bool:
    """Return whether a term's set is a single point."""
    return isinstance(term.shape, Singleton) and not term.complement


def encode(term: Term) -> Encoded:
    """Return a term's set as the kernels read it; a set by points counts its values from 0."""
    code, four, values = _encoded(term.shape)
    offset, scale = (term.height, -term.height) if term.complement else (0.0, term.height)
    return Encoded(code, (*four, offset, scale, _peak(term.shape), 0.0), values)


def _encoded(shape: Shape) -> tuple[int, tuple[float, float, float, float], tuple[float, ...]]:  # noqa: C901
    inf = math.inf
    match shape:
        case Triangle(a=a, b=b, c=c):
            return codes.TRAPEZOID, (a, b, b, c), ()
        case Trapezoid(a=a, b=b, c=c, d=d):
            return codes.TRAPEZOID, (a, b, c, d), ()
        case Rectangle(a=a, b=b):
            inner = (b if math.isinf(a) else a, a if math.isinf(b) else b)
            return codes.TRAPEZOID, (a, *inner, b), ()
        case Ramp(start=start, end=end):
            corners = (start, end, end, inf) if start < end else (-inf, end, end, start)
            return codes.TRAPEZOID, corners, ()
        case Singleton(value=value):
            return codes.TRAPEZOID, (value, value, value, value), ()
        case Points(points=points):
            values = (*(x for x, _ in points), *(degree for _, degree in points))
            return codes.POINTS, (0.0, float(len(points)), 0.0, 0.0), values
        case Gaussian(mean=mean, sigma=sigma):
            return codes.GAUSSIAN, (mean, sigma, 0.0, 0.0), ()
        case Gaussian2(left_mean=left, left_sigma=left_sigma, right_mean=right, right_sigma=right_sigma):
            return codes.GAUSSIAN2, (left, left_sigma, right, right_sigma), ()
        case Bell(center=center, width=width, slope=slope):
            return codes.BELL, (center, width, slope, 0.0), ()
        case Sigmoid(center=center, slope=slope):
            return codes.SIGMOID, (center, slope, 0.0, 0.0), ()
        case SigmoidDifference(left_center=a, left_slope=b, right_center=c, right_slope=d):
            return codes.SIGMOID_DIFFERENCE, (a, b, c, d), ()
        case SigmoidProduct(left_center=a, left_slope=b, right_center=c, right_slope=d):
            return codes.SIGMOID_PRODUCT, (a, b, c, d), ()
        case SShape(a=a, b=b):
            return codes.PI_SHAPE, (a, b, inf, inf), ()
        case ZShape(a=a, b=b):
            return codes.PI_SHAPE, (-inf, -inf, a, b), ()
        case PiShape(a=a, b=b, c=c, d=d):
            return codes.PI_SHAPE, (a, b, c, d), ()
        case Cosine(center=center, width=width):
            return codes.COSINE, (center, width, 0.0, 0.0), ()
        case Spike(center=center, width=width):
            return codes.SPIKE, (center, width, 0.0, 0.0), ()
        case Concave(inflection=inflection, end=end):
            return codes.CONCAVE, (inflection, end, 0.0, 0.0), ()
        case Linear(coefficients=coefficients, constant=constant):
            return codes.LINEAR, (0.0, float(len(coefficients)), 0.0, 0.0), (*coefficients, constant)


def _peak(shape: Shape) -> float:
    """Return where a curve stops rising or falling; any of its places if it never does, or is no curve."""
    match shape:
        case Gaussian(mean=place) | Concave(end=place):
            return place
        case Bell(center=place) | Sigmoid(center=place) | Cosine(center=place) | Spike(center=place):
            return place
        case SShape(b=place) | ZShape(a=place):
            return place
        case Gaussian2(left_mean=left, right_mean=right) if left <= right:
            return left if math.isfinite(left) else right
        case Gaussian2(left_mean=left, right_mean=right):  # both sides fall in between: the product is Gaussian there
            left_share, right_share = shape.left_sigma**-2, shape.right_sigma**-2
            return (left * left_share + right * right_share) / (left_share + right_share)
        case PiShape(b=b, c=c) if b <= c:
            return b
        case PiShape():
            return _searched_peak(shape, shape.c, shape.b)
        case SigmoidProduct() | SigmoidDifference():
            low, high = sorted((shape.left_center, shape.right_center))
            margin = max(8 / max(abs(slope), 1e-300) for slope in (shape.left_slope, shape.right_slope))
            return _searched_peak(shape, low - min(margin, 1e12), high + min(margin, 1e12))
        case _:
            return 0.0


def _searched_peak(shape: Shape, low: float, high: float) -> float:
    best = low
    for _ in range(12):  # the grid of 64 narrows by 32 in every step
        grid = np.linspace(low, high, 65)
        best = float(grid[int(np.argmax(degrees(Term("", shape), grid)))])
        step = (high - low) / 64
        low, high = best - step, best + step
    return best


def degrees(term: Term, x: ArrayLike) -> NDArray[np.float64]:
    """Return the membership degree of every value of ``x``.

    Args:
        term: A valid term; its name does not matter.
        x: Crisp values of any shape, in the variable's unit.

    Returns:
        Degrees in [0, 1], of the shape of ``x``; 0 for a linear function.
    """
    values = np.asarray(x, dtype=np.float64)
    degree = np.empty(values.size)
    code, four, extra = _encoded(term.shape)
    offset, scale = (term.height, -term.height) if term.complement else (0.0, term.height)
    row = np.array((*four, offset, scale, 0.0, 0.0))
    membership.degrees(code, row, np.array(extra or (0.0,)), values.ravel(), degree)
    return degree.reshape(values.shape)


def segments(term: Term) -> tuple[Segment, ...]:
    """Return the straight parts of a piecewise-linear set from left to right, closed at both ends; () if curved.

    Where no segment is, the set is 0.
    """
    found = _segments(term.shape)
    if not found or not (term.complement or term.height != 1.0):
        return found
    if term.complement:
        found = _filled(found)
    low, high = (1.0, 0.0) if term.complement else (0.0, 1.0)

    def mapped(degree: float) -> float:
        return term.height * (low + (high - low) * degree)

    return tuple(Segment(left, right, mapped(first), mapped(second)) for left, right, first, second in found)


def _segments(shape: Shape) -> tuple[Segment, ...]:
    match shape:
        case Points(points=points):
            inner = (
                Segment(left, right, first, second) for (left, first), (right, second) in itertools.pairwise(points)
            )
            (start, first), (end, last) = points[0], points[-1]
            outer = (Segment(-math.inf, start, first, first), Segment(end, math.inf, last, last))
            between = tuple(segment for segment in inner if segment.left < segment.right)
            return (outer[0], *between, outer[1])
        case Triangle() | Trapezoid() | Rectangle() | Ramp() | Singleton():
            a, b, c, d = _encoded(shape)[1]
        case _:
            return ()
    rise = Segment(a, b, 1.0 if math.isinf(a) else 0.0, 1.0)
    fall = Segment(c, d, 1.0, 1.0 if math.isinf(d) else 0.0)
    return (*((rise,) if a < b else ()), Segment(b, c, 1.0, 1.0), *((fall,) if c < d else ()))


def _filled(found: tuple[Segment, ...]) -> tuple[Segment, ...]:
    """Return the segments and, outside them, segments of degree 0."""
    left, right = found[0].left, found[-1].right
    before = (Segment(-math.inf, left, 0.0, 0.0),) if math.isfinite(left) else ()
    after = (Segment(right, math.inf, 0.0, 0.0),) if math.isfinite(right) else ()
    return (*before, *found, *after)


def break_points(term: Term) -> tuple[float, ...]:
    """Return the finite points at which a piecewise-linear set bends, or a curved set's places."""
    return tuple(value for value in locations(term.shape) if math.isfinite(value))


def support(term: Term, low: float, high: float) -> tuple[float, float]:
    """Return where a set is above 0 inside [low, high], or the interval from the first such place to the last one.

    Left > right where the set is 0 all over the range. A curved set counts as 0 where it is below 1.3e-14.
    """
    if isinstance(term.shape, Linear):
        return low, high
    found = [segment for segment in segments(term) if max(segment.at_left, segment.at_right) > 0.0]
    if is_linear(term):
        left = min((segment.left for segment in found), default=math.inf)
        right = max((segment.right for segment in found), default=-math.inf)
    elif term.complement:
        left, right = -math.inf, math.inf
    else:
        left, right = _curved_support(term.shape)
    return max(left, low), min(right, high)


def _curved_support(shape: Shape) -> tuple[float, float]:
    inf = math.inf
    match shape:
        case Gaussian(mean=mean, sigma=sigma):
            return mean - 8 * sigma, mean + 8 * sigma
        case Gaussian2():
            return shape.left_mean - 8 * shape.left_sigma, shape.right_mean + 8 * shape.right_sigma
        case Bell(center=center, width=width, slope=slope):
            reach = width * math.exp(min(_LOG_LEAST / (2 * slope), 700.0))
            return center - reach, center + reach
        case Sigmoid(center=center, slope=slope):
            if slope == 0:
                return -inf, inf
            edge = center - _LOG_LEAST / slope
            return (edge, inf) if slope > 0 else (-inf, edge)
        case SigmoidProduct(left_center=a, left_slope=b, right_center=c, right_slope=d):
            one, other = (_curved_support(Sigmoid(*pair)) for pair in ((a, b), (c, d)))
            return max(one[0], other[0]), min(one[1], other[1])
        case SShape(a=a):
            return a, inf
        case ZShape(b=b):
            return -inf, b
        case PiShape(a=a, d=d):
            return a, d
        case Cosine(center=center, width=width):
            return center - width / 2, center + width / 2
        case Spike(center=center, width=width):
            return center - width / 10 * _LOG_LEAST, center + width / 10 * _LOG_LEAST
        case _:
            return -inf, inf


def is_positive(term: Term, x: float) -> bool:
    """Return whether a set is above 0 at ``x``; a curved set counts as 0 where it is below 1.3e-14."""
    return float(degrees(term, x)) > (0.0 if is_linear(term) else _LEAST)


def core(term: Term, low: float, high: float) -> tuple[float, float]:
    """Return the ends of the interval in [low, high] on which a set is largest, to 1e-9 of the range."""
    ends = [value for value in (*locations(term.shape), _peak(term.shape)) if low <= value <= high]
    places = np.unique([low, high, *ends, *np.linspace(low, high, 129)])
    found = degrees(term, places)
    highest = float(found.max())
    best = places[found >= highest * (1 - 1e-12)]
    return float(best[0]), float(best[-1])


def is_monotone(term: Term, low: float, high: float) -> bool:
    """Return whether a set rises or falls all over [low, high], staying level at most at its end values."""
    if isinstance(term.shape, Ramp | Sigmoid | SShape | ZShape | Concave):
        return bool(np.diff(degrees(term, np.array([low, high])))[0] != 0)
    places = np.unique([*(value for value in break_points(term) if low < value < high), *np.linspace(low, high, 257)])
    steps = np.diff(degrees(term, places))
    return bool((steps >= 0).all() or (steps <= 0).all()) and bool((steps != 0).any())
