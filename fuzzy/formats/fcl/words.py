"""The words of .fcl and what they are in the document, for reading and for writing."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from fuzzy.formats.assembly import open_trapezoid
from fuzzy.shapes import Bell, Cosine, Gaussian, Gaussian2, Shape, Sigmoid, SigmoidDifference, Triangle

CONJUNCTIONS = {
    "MIN": "min",
    "PROD": "product",
    "BDIF": "bounded_difference",
    "DPROD": "drastic_product",
    "EPROD": "einstein_product",
    "HPROD": "hamacher_product",
    "NMIN": "nilpotent_minimum",
    "DMIN": "drastic_product",
    "NIPMIN": "nilpotent_minimum",
    "HAMACHER": "hamacher_product",
}
"""The standard's, then fuzzylite's, then jFuzzyLogic's."""

DISJUNCTIONS = {
    "MAX": "max",
    "ASUM": "algebraic_sum",
    "BSUM": "bounded_sum",
    "DSUM": "drastic_sum",
    "ESUM": "einstein_sum",
    "HSUM": "hamacher_sum",
    "NMAX": "nilpotent_maximum",
    "DMAX": "drastic_sum",
    "NIPMAX": "nilpotent_maximum",
    "EINSTEIN": "einstein_sum",
    "PROBOR": "algebraic_sum",
}

ACTIVATIONS = CONJUNCTIONS
ACCUMULATIONS = {**DISJUNCTIONS, "SUM": "sum", "NSUM": "sum", "USUM": "sum"}
"""NSUM divides by the largest degree, which moves no centroid; two engines limit the sum to 1, see the reader."""

METHODS = {
    "COG": "centroid",
    "COGS": "weighted_average",
    "COA": "bisector",
    "LM": "som",
    "RM": "lom",
    "MM": "mom",
    "COGSS": "weighted_sum",
}

DUALS = {
    "min": "max",
    "product": "algebraic_sum",
    "bounded_difference": "bounded_sum",
    "drastic_product": "drastic_sum",
    "einstein_product": "einstein_sum",
    "hamacher_product": "hamacher_sum",
    "nilpotent_minimum": "nilpotent_maximum",
}
"""The OR that belongs to each AND where a file names one of them only."""


class Kind(NamedTuple):
    """A jFuzzyLogic membership function: the number of its parameters, and what it is in the document."""

    n_parameters: int
    build: Callable[..., Shape]


SHAPES = {
    "TRIAN": Kind(3, Triangle),
    "TRAPE": Kind(4, open_trapezoid),
    "GAUSS": Kind(2, Gaussian),
    "GAUSS2": Kind(4, Gaussian2),
    "GBELL": Kind(3, lambda width, slope, center: Bell(center, width, slope)),
    "SIGM": Kind(2, lambda slope, center: Sigmoid(center, slope)),
    "DSIGM": Kind(4, lambda a1, c1, a2, c2: SigmoidDifference(c1, a1, c2, a2)),
    "COSINE": Kind(2, lambda half, center: Cosine(center, 2 * half)),
}
"""jFuzzyLogic's; fuzzylite's stand in :mod:`fuzzy.formats.fll.words`."""
