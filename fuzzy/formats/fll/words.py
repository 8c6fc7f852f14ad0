"""fuzzylite's words and what they are in the document, for reading and for writing; its .fcl uses the terms' too."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

from fuzzy.errors import FormatError, expected, shown
from fuzzy.formats.assembly import open_trapezoid
from fuzzy.formats.source import Source
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
    Triangle,
    ZShape,
)

CONJUNCTIONS = {
    "Minimum": "min",
    "AlgebraicProduct": "product",
    "BoundedDifference": "bounded_difference",
    "DrasticProduct": "drastic_product",
    "EinsteinProduct": "einstein_product",
    "HamacherProduct": "hamacher_product",
    "NilpotentMinimum": "nilpotent_minimum",
}

DISJUNCTIONS = {
    "Maximum": "max",
    "AlgebraicSum": "algebraic_sum",
    "BoundedSum": "bounded_sum",
    "DrasticSum": "drastic_sum",
    "EinsteinSum": "einstein_sum",
    "HamacherSum": "hamacher_sum",
    "NilpotentMaximum": "nilpotent_maximum",
    "NormalizedSum": "bounded_sum",
}
"""fuzzylite's normalized sum, (a + b) / max(1, a + b), is the bounded sum."""

AGGREGATIONS = {**DISJUNCTIONS, "UnboundedSum": "sum"}

DEFUZZIFIERS = {
    "Centroid": "centroid",
    "Bisector": "bisector",
    "MeanOfMaximum": "mom",
    "SmallestOfMaximum": "som",
    "LargestOfMaximum": "lom",
    "WeightedAverage": "weighted_average",
    "WeightedSum": "weighted_sum",
}

HEDGES = {"very": "very", "somewhat": "somewhat", "extremely": "intensify", "seldom": "seldom", "any": "any"}
"""fuzzylite's "extremely" is 2x² up to 1/2 and 1 - 2(1 - x)² above: the document's intensify."""


class Kind(NamedTuple):
    """A kind of term: the number of its parameters, and what it is in the document."""

    n_parameters: int
    build: Callable[..., Shape]


def _binary(start: float, direction: float) -> Shape:
    return Rectangle(start, math.inf) if direction > start else Rectangle(-math.inf, start)


SHAPES: dict[str, Kind] = {
    "Triangle": Kind(3, Triangle),
    "Trapezoid": Kind(4, open_trapezoid),
    "Rectangle": Kind(2, Rectangle),
    "Ramp": Kind(2, Ramp),
    "Gaussian": Kind(2, Gaussian),
    "GaussianProduct": Kind(4, Gaussian2),
    "Bell": Kind(3, Bell),
    "Sigmoid": Kind(2, Sigmoid),
    "SigmoidDifference": Kind(4, lambda l, rising, falling, r: SigmoidDifference(l, rising, r, falling)),  # noqa: E741
    "SigmoidProduct": Kind(4, lambda l, rising, falling, r: SigmoidProduct(l, rising, r, falling)),  # noqa: E741
    "SShape": Kind(2, SShape),
    "ZShape": Kind(2, ZShape),
    "PiShape": Kind(4, PiShape),
    "Binary": Kind(2, _binary),
    "Cosine": Kind(2, Cosine),
    "Spike": Kind(2, Spike),
    "Concave": Kind(2, Concave),
    "Constant": Kind(1, Singleton),
}
"""All but ``Discrete`` and ``Linear``, whose numbers of parameters depend."""

REFUSED = ("Function", "Arc", "SemiEllipse")
"""Terms that the document has no shape for."""


def shape(source: Source, word: str, values: Sequence[float], offset: int, n_inputs: int) -> tuple[Shape, float]:
    """Return the shape and height of a term.

    Args:
        source: The file.
        word: fuzzylite's class of the term.
        values: Its parameters, with the height behind them where there is one.
        offset: Where the class stands.
        n_inputs: Number of inputs, which a linear function has a coefficient for.

    Raises:
        FormatError: For an unknown class or a wrong number of parameters.
    """
    if word == "Discrete":
        height = values[-1] if len(values) % 2 else 1.0
        points = values[: len(values) // 2 * 2]
        if not points:
            raise source.error("Discrete has pairs of x and degree, found none", offset)
        return Points(tuple(zip(points[::2], points[1::2], strict=True))), height
    if word == "Linear":
        if len(values) != n_inputs + 1:
            message = f"Linear has {n_inputs + 1} parameters here (one for each input, and a constant)"
            raise source.error(f"{message}, found {len(values)}", offset)
        return Linear(tuple(values[:-1]), values[-1]), 1.0
    if word in REFUSED:
        raise source.error(f"the term '{word}' has no shape in the workbench", offset)
    if word not in SHAPES:
        raise source.error(f"unknown term {expected(shown(word), (*SHAPES, 'Discrete', 'Linear'))}", offset)
    kind = SHAPES[word]
    if not kind.n_parameters <= len(values) <= kind.n_parameters + (word != "Constant"):
        raise _count_error(source, word, kind, len(values), offset)
    return kind.build(*values[: kind.n_parameters]), values[kind.n_parameters] if len(
        values
    ) > kind.n_parameters else 1.0


def _count_error(source: Source, word: str, kind: Kind, found: int, offset: int) -> FormatError:
    return source.error(f"{word} has {kind.n_parameters} parameters and may have a height, found {found}", offset)
