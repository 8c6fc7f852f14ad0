"""Names, shapes and values as FML has them."""

from __future__ import annotations

import math
from collections.abc import Iterable
from xml.sax.saxutils import quoteattr

from fuzzy.formats.saying import Adapter, bounded, digits
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
from fuzzy.system import Output, Variable


def quoted_name(name: str, path: str, adapter: Adapter) -> str:
    """Return a name as an attribute's value."""
    return quoteattr(plain_name(name, path, adapter))


def plain_name(name: str, path: str, adapter: Adapter) -> str:
    """Return a name without double blanks, which XML takes for one."""
    plain = " ".join(name.split())
    if plain != name:
        adapter.cannot(f"the name '{name}' with its blanks", path, f"'{plain}'")
    return plain


def default_value(output: Output, adapter: Adapter) -> float:
    """Return what an output is when no rule fires."""
    middle = 0.5 * (output.low + output.high)
    policy = output.no_fire.policy
    if policy in ("hold", "nan"):
        adapter.cannot(f"no_fire: {policy}", f"outputs.{output.name}.no_fire", f"{{default: {middle:g}}}")
    return output.no_fire.value if policy == "default" else middle


def shape_element(shape: Shape, entry: Variable) -> str | None:  # noqa: C901
    """Return the element of a shape; None where there is none."""
    match shape:
        case Gaussian2(left_mean=left, right_mean=right):
            if left == -math.inf:
                return element("leftGaussianShape", (right, shape.right_sigma))
            if right == math.inf:
                return element("rightGaussianShape", (left, shape.left_sigma))
            return None
        case PiShape(a=a, b=b, c=c, d=d):
            return element("piShape", (a, b)) if b == c and a < b and d == b + abs(b - a) else None
        case Ramp(start=start, end=end):
            rises = start < end
            return element("rightLinearShape", (start, end)) if rises else element("leftLinearShape", (end, start))
        case Points(points=points):
            return points_element("pointSetShape", points)
        case Triangle() | Trapezoid() | Rectangle():
            closed = bounded(shape, entry.low, entry.high)
            words_of = {Triangle: "triangularShape", Trapezoid: "trapezoidShape", Rectangle: "rectangularShape"}
            return element(words_of[type(closed)], parameters(closed))  # type: ignore[index]
        case Gaussian():
            return element("gaussianShape", parameters(shape))
        case Singleton():
            return element("singletonShape", parameters(shape))
        case SShape():
            return element("sShape", parameters(shape))
        case ZShape():
            return element("zShape", parameters(shape))
        case Bell() | Sigmoid() | SigmoidDifference() | SigmoidProduct() | Cosine() | Spike() | Concave() | Linear():
            return None


def element(tag: str, values: tuple[float, ...]) -> str:
    """Return an element whose attributes are its parameters."""
    attributes = " ".join(f'param{place}="{digits(value)}"' for place, value in enumerate(values, 1))
    return f"<{tag} {attributes}/>"


def points_element(tag: str, points: Iterable[tuple[float, float]]) -> str:
    """Return an element that holds points."""
    inside = "".join(f'<point x="{digits(x)}" y="{digits(y)}"/>' for x, y in points)
    return f'<{tag} interpolationMethod="linear">{inside}</{tag}>'
