"""What the parameters of a shape must be, so that it is a fuzzy set."""

from __future__ import annotations

import math
from typing import assert_never

from fuzzy.errors import InvalidSystemError
from fuzzy.shapes import (
    MAX_POINTS,
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
    parameter_names,
    parameters,
)


def validate_shape(shape: Shape, path: str = "") -> None:
    """Refuse a shape that is no fuzzy set (or, if it is linear, no function).

    Raises:
        InvalidSystemError: With ``path``, the values found and the order that is valid.
    """
    values = parameters(shape)
    text = f"{kind(shape)} [{', '.join(f'{value:g}' for value in values[:8])}{', …' if len(values) > 8 else ''}]"
    if any(math.isnan(value) for value in values):
        raise InvalidSystemError(f"{text} holds a value that is not a number", path)
    wrong = _fault(shape, values)
    if wrong:
        raise InvalidSystemError(text + wrong, path)


def _fault(shape: Shape, values: tuple[float, ...]) -> str:  # noqa: C901
    """Return what is wrong with a shape's values, or an empty text."""
    match shape:
        case Triangle() | Trapezoid():
            return _corner_fault(shape, values, values[1:-1])
        case Rectangle():
            return _corner_fault(shape, values, ())
        case Gaussian2(left_mean=left, right_mean=right):
            sigmas = (shape.left_sigma, shape.right_sigma)
            if not all(math.isfinite(sigma) and sigma > 0 for sigma in sigmas):
                return ": both sigmas must be finite and greater than 0"
            if left == math.inf or right == -math.inf:
                return ": an open shoulder is -.inf on the left or .inf on the right"
            return ": at most one side may be open" if math.isinf(left) and math.isinf(right) else ""
        case Points(points=points):
            if not 1 <= len(points) <= MAX_POINTS:
                return f": {len(points)} points; valid are 1 to {MAX_POINTS}"
            if not all(map(math.isfinite, values)):
                return ": all points must be finite"
            if not all(0 <= degree <= 1 for _, degree in points):
                return ": a degree lies outside 0 to 1"
            places = [x for x, _ in points]
            if places != sorted(places):
                return " is not in order: valid is x1 ≤ x2 ≤ …"
            return ": more than two points stand at one x" if _is_thrice(places) else ""
    if not all(map(math.isfinite, values)):
        return ": all values must be finite"
    match shape:
        case Gaussian(sigma=sigma):
            return "" if sigma > 0 else ": mean must be finite and sigma finite and greater than 0"
        case Bell():
            return "" if shape.width > 0 and shape.slope > 0 else ": width and slope must be greater than 0"
        case Cosine(width=width) | Spike(width=width):
            return "" if width > 0 else ": width must be greater than 0"
        case Ramp(start=start, end=end):
            return "" if start != end else ": start and end must differ (a jump is a rectangle)"
        case Concave(inflection=inflection, end=end):
            return "" if inflection != end else ": inflection and end must differ"
        case SShape(a=a, b=b) | ZShape(a=a, b=b):
            return "" if a <= b else " is not in order: valid is a ≤ b"
        case PiShape(a=a, b=b, c=c, d=d):
            return "" if a <= b and c <= d and a <= d else " is not in order: valid is a ≤ b, c ≤ d and a ≤ d"
        case Sigmoid() | SigmoidDifference() | SigmoidProduct() | Singleton() | Linear():
            return ""
        case _:
            assert_never(shape)


def _corner_fault(shape: Shape, values: tuple[float, ...], inner: tuple[float, ...]) -> str:
    if list(values) != sorted(values):
        return f" is not in order: valid is {' ≤ '.join(parameter_names(shape))}"
    if not all(map(math.isfinite, inner)):
        return ": only the outer values may be infinite (.inf, -.inf)"
    first, last = values[0], values[-1]
    if first == math.inf or last == -math.inf:
        return ": an open shoulder is -.inf on the left or .inf on the right"
    if len(values) < 4 and math.isinf(first) and math.isinf(last):
        return " is 1 everywhere: at most one side may be open"
    return ""


def _is_thrice(places: list[float]) -> bool:
    return any(first == third for first, third in zip(places, places[2:], strict=False))
