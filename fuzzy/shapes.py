"""Membership functions: one closed union of shapes and their parameters.

A shape is data; :mod:`fuzzy.validation` says which parameters are valid, :mod:`fuzzy.sets` what a term makes of it,
:mod:`fuzzy.kernels.membership` computes its degrees.

References:
    IEC 61131-7:2000; IEEE 1855-2016; MATLAB's Fuzzy Logic Toolbox for bell, sigmoid, s, z, pi and gaussian2;
    fuzzylite 6 for cosine, spike and concave.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import msgspec

from fuzzy.errors import InvalidSystemError, expected

MAX_POINTS = 1000
"""Greatest number of points of a set that is given by points."""


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


class Rectangle(msgspec.Struct, frozen=True, tag="rectangle"):
    """1 on [a, b], both ends included; one of them may be infinite."""

    a: float
    b: float


class Ramp(msgspec.Struct, frozen=True, tag="ramp"):
    """0 up to ``start``, 1 from ``end`` on, a line between; it falls where ``end`` is to the left of ``start``."""

    start: float
    end: float


class Singleton(msgspec.Struct, frozen=True, tag="singleton"):
    """1 at ``value`` alone; as an output's term also the constant of a Sugeno system of order 0."""

    value: float


class Points(msgspec.Struct, frozen=True, tag="points"):
    """Lines through the points (x, degree), constant outside; two points at one x are a jump, with the larger degree.

    The source paper's numerical definition.
    """

    points: tuple[tuple[float, float], ...]


class Gaussian(msgspec.Struct, frozen=True, tag="gaussian"):
    """exp(-(x - mean)² / (2 sigma²))."""

    mean: float
    sigma: float


class Gaussian2(msgspec.Struct, frozen=True, tag="gaussian2"):
    """Gaussian flanks, left of ``left_mean`` and right of ``right_mean``, and 1 between; their product if they cross.

    An infinite mean, -inf on the left or inf on the right, is an open shoulder.
    """

    left_mean: float
    left_sigma: float
    right_mean: float
    right_sigma: float


class Bell(msgspec.Struct, frozen=True, tag="bell"):
    """1 / (1 + |(x - center) / width|^(2 slope))."""

    center: float
    width: float
    slope: float


class Sigmoid(msgspec.Struct, frozen=True, tag="sigmoid"):
    """1 / (1 + exp(-slope (x - center))); falling where the slope is negative."""

    center: float
    slope: float


class SigmoidDifference(msgspec.Struct, frozen=True, tag="sigmoid_difference"):
    """|left - right| of two sigmoids."""

    left_center: float
    left_slope: float
    right_center: float
    right_slope: float


class SigmoidProduct(msgspec.Struct, frozen=True, tag="sigmoid_product"):
    """left · right of two sigmoids."""

    left_center: float
    left_slope: float
    right_center: float
    right_slope: float


class SShape(msgspec.Struct, frozen=True, tag="s_shape"):
    """Two parabolas that rise from 0 at ``a`` through 1/2 in the middle to 1 at ``b``."""

    a: float
    b: float


class ZShape(msgspec.Struct, frozen=True, tag="z_shape"):
    """Two parabolas that fall from 1 at ``a`` through 1/2 in the middle to 0 at ``b``."""

    a: float
    b: float


class PiShape(msgspec.Struct, frozen=True, tag="pi_shape"):
    """The product of an s shape from ``a`` to ``b`` and a z shape from ``c`` to ``d``."""

    a: float
    b: float
    c: float
    d: float


class Cosine(msgspec.Struct, frozen=True, tag="cosine"):
    """(1 + cos(2π (x - center) / width)) / 2 within half a width of the center."""

    center: float
    width: float


class Spike(msgspec.Struct, frozen=True, tag="spike"):
    """exp(-10 |x - center| / width)."""

    center: float
    width: float


class Concave(msgspec.Struct, frozen=True, tag="concave"):
    """A hyperbola, 1/2 at ``inflection`` and 1 from ``end`` on; it falls where ``end`` is to the left."""

    inflection: float
    end: float


class Linear(msgspec.Struct, frozen=True, tag="linear"):
    """No set but a function of the inputs, Σ coefficient · input + constant: an output's term in a Sugeno system."""

    coefficients: tuple[float, ...]
    constant: float


Shape = (
    Triangle
    | Trapezoid
    | Rectangle
    | Ramp
    | Singleton
    | Points
    | Gaussian
    | Gaussian2
    | Bell
    | Sigmoid
    | SigmoidDifference
    | SigmoidProduct
    | SShape
    | ZShape
    | PiShape
    | Cosine
    | Spike
    | Concave
    | Linear
)

SHAPES: tuple[type[Shape], ...] = (
    Triangle,
    Trapezoid,
    Gaussian,
    Gaussian2,
    Bell,
    Sigmoid,
    SigmoidDifference,
    SigmoidProduct,
    SShape,
    ZShape,
    PiShape,
    Ramp,
    Rectangle,
    Singleton,
    Points,
    Cosine,
    Spike,
    Concave,
)
"""All kinds of fuzzy sets, in the order in which they are offered."""

KINDS: tuple[type[Shape], ...] = (*SHAPES, Linear)
"""All kinds that a term may have."""

PIECEWISE_LINEAR = (Triangle, Trapezoid, Rectangle, Ramp, Singleton, Points)
"""Shapes whose defuzzification has a closed form."""


def kind(shape: Shape | type[Shape]) -> str:
    """Return the schema's word for a shape, such as ``triangle``."""
    config = shape.__struct_config__
    return str(config.tag)


def parameter_names(shape: Shape | type[Shape]) -> tuple[str, ...]:
    """Return the names of a shape's parameters, in their order in files.

    For shapes of any number of parameters these are the names of the given shape's own: x1, y1, x2 ... of points, c1,
    c2 ... and constant of a linear function; of the type alone, one name that stands for all.
    """
    match shape:
        case Points(points=points):
            return tuple(f"{axis}{i}" for i in range(1, len(points) + 1) for axis in "xy")
        case Linear(coefficients=coefficients):
            return (*(f"c{i}" for i in range(1, len(coefficients) + 1)), "constant")
        case _:
            return shape.__struct_fields__


def parameters(shape: Shape) -> tuple[float, ...]:
    """Return a shape's parameters, in the order of ``parameter_names``."""
    match shape:
        case Points(points=points):
            return tuple(float(value) for point in points for value in point)
        case Linear(coefficients=coefficients, constant=constant):
            return (*map(float, coefficients), float(constant))
        case _:
            return tuple(float(getattr(shape, name)) for name in shape.__struct_fields__)


def build(word: str, values: Sequence[float]) -> Shape:
    """Return the shape of a kind with these parameters, in the order of ``parameter_names``; not yet validated.

    Raises:
        InvalidSystemError: No such kind, or another number of parameters.
    """
    kinds = {kind(entry): entry for entry in KINDS}
    if word not in kinds:
        raise InvalidSystemError(f"unknown shape {expected(word, kinds)}")
    if word == kind(Points):
        if not values or len(values) % 2:
            raise InvalidSystemError(f"points are pairs of x and degree, found {len(values)} numbers")
        return Points(tuple(zip(values[::2], values[1::2], strict=True)))
    if word == kind(Linear):
        if not values:
            raise InvalidSystemError("a linear function needs a coefficient for each input and a constant, found none")
        return Linear(tuple(values[:-1]), values[-1])
    names = kinds[word].__struct_fields__
    if len(values) != len(names):
        raise InvalidSystemError(f"a {word} has {len(names)} parameters ({', '.join(names)}), found {len(values)}")
    fixed: Any = kinds[word]
    return fixed(*values)


def locations(shape: Shape) -> tuple[float, ...]:
    """Return those parameters of a shape that are places on its universe."""
    places = location_names(shape)
    return tuple(value for name, value in zip(parameter_names(shape), parameters(shape), strict=True) if name in places)


def location_names(shape: Shape) -> tuple[str, ...]:
    """Return the names of those parameters of a shape that are places on its universe."""
    match shape:
        case Points():
            return parameter_names(shape)[::2]
        case Linear():
            return ()
        case _:
            return tuple(name for name in shape.__struct_fields__ if not name.endswith(("sigma", "width", "slope")))


def with_parameter(shape: Shape, name: str, value: float) -> Shape:
    """Return a shape with one other parameter, by its name in ``parameter_names``; not yet validated.

    Raises:
        InvalidSystemError: No parameter of that name.
    """
    names = parameter_names(shape)
    if name not in names:
        raise InvalidSystemError(f"unknown parameter {expected(name, names)}")
    values = list(parameters(shape))
    values[names.index(name)] = value
    return build(kind(shape), values)
