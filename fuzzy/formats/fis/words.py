"""The words of .fis and what they are in the document, for reading and for writing."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

from fuzzy.formats.assembly import open_trapezoid
from fuzzy.shapes import (
    Bell,
    Concave,
    Cosine,
    Gaussian,
    Gaussian2,
    PiShape,
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
    "min": "min",
    "prod": "product",
    "bounded_difference": "bounded_difference",
    "drastic_product": "drastic_product",
    "einstein_product": "einstein_product",
    "hamacher_product": "hamacher_product",
    "nilpotent_minimum": "nilpotent_minimum",
    "algebraic_product": "product",
}
"""MATLAB's two, then Octave's and fuzzylite's; the first word of each meaning is written."""

DISJUNCTIONS = {
    "max": "max",
    "probor": "algebraic_sum",
    "bounded_sum": "bounded_sum",
    "drastic_sum": "drastic_sum",
    "einstein_sum": "einstein_sum",
    "hamacher_sum": "hamacher_sum",
    "nilpotent_maximum": "nilpotent_maximum",
    "algebraic_sum": "algebraic_sum",
    "normalized_sum": "bounded_sum",
}

IMPLICATIONS = CONJUNCTIONS
AGGREGATIONS = {**DISJUNCTIONS, "sum": "sum"}

DEFUZZIFIERS = {
    "centroid": "centroid",
    "bisector": "bisector",
    "mom": "mom",
    "som": "som_abs",
    "lom": "lom_abs",
    "wtaver": "weighted_average",
    "wtsum": "weighted_sum",
}
"""MATLAB's smallest and largest of maxima are those of smallest and largest magnitude."""

FUZZYLITE_DEFUZZIFIERS = {**DEFUZZIFIERS, "som": "som", "lom": "lom"}


class Kind(NamedTuple):
    """A type of membership function: the number of its parameters, and what it is in the document."""

    n_parameters: int
    build: Callable[..., Shape]
    names: str


def _binary(start: float, direction: float) -> Shape:
    return Rectangle(start, float("inf")) if direction > start else Rectangle(-float("inf"), start)


SHAPES: dict[str, Kind] = {
    "trimf": Kind(3, Triangle, "a b c"),
    "trapmf": Kind(4, open_trapezoid, "a b c d"),
    "gaussmf": Kind(2, lambda sigma, mean: Gaussian(mean, sigma), "sigma mean"),
    "gauss2mf": Kind(4, lambda s1, c1, s2, c2: Gaussian2(c1, s1, c2, s2), "sigma1 mean1 sigma2 mean2"),
    "gbellmf": Kind(3, lambda a, b, c: Bell(c, a, b), "width slope center"),
    "sigmf": Kind(2, lambda slope, center: Sigmoid(center, slope), "slope center"),
    "dsigmf": Kind(4, lambda a1, c1, a2, c2: SigmoidDifference(c1, a1, c2, a2), "slope1 center1 slope2 center2"),
    "psigmf": Kind(4, lambda a1, c1, a2, c2: SigmoidProduct(c1, a1, c2, a2), "slope1 center1 slope2 center2"),
    "smf": Kind(2, SShape, "a b"),
    "zmf": Kind(2, ZShape, "a b"),
    "pimf": Kind(4, PiShape, "a b c d"),
    "linsmf": Kind(2, Ramp, "a b"),
    "linzmf": Kind(2, lambda a, b: Ramp(b, a), "a b"),
    "constant": Kind(1, Singleton, "value"),
    "rampmf": Kind(2, Ramp, "start end"),
    "rectmf": Kind(2, Rectangle, "a b"),
    "binarymf": Kind(2, _binary, "start direction"),
    "cosinemf": Kind(2, Cosine, "center width"),
    "spikemf": Kind(2, Spike, "center width"),
    "concavemf": Kind(2, Concave, "inflection end"),
}
"""All but ``linear`` and ``discretemf``, whose numbers of parameters depend; MATLAB's first, then fuzzylite's."""

OCTAVE_HEDGES: dict[str, tuple[Any, ...]] = {
    "05": ("somewhat",),
    "2": ("very",),
    "3": ("extremely",),
    "4": ("very", "very"),
}
"""Hedges by the digits behind a term's index; Octave's and sciFLT's."""

FUZZYLITE_HEDGES: dict[str, tuple[Any, ...]] = {
    "01": ("seldom",),
    "05": ("somewhat",),
    "2": ("very",),
    "3": ("intensify",),
    "4": ("very", "very"),
    "99": ("any",),
}
"""As fuzzylite writes them; its "extremely" is the document's intensify."""
