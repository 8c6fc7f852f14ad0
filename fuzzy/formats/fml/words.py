"""The words of FML and what they are in the document, for reading and for writing."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

from fuzzy.shapes import (
    Gaussian,
    Gaussian2,
    PiShape,
    Ramp,
    Rectangle,
    Shape,
    Singleton,
    SShape,
    Trapezoid,
    Triangle,
    ZShape,
)

CONJUNCTIONS = {
    "MIN": "min",
    "PROD": "product",
    "BDIF": "bounded_difference",
    "DRP": "drastic_product",
    "EPROD": "einstein_product",
    "HPROD": "hamacher_product",
    "NILMIN": "nilpotent_minimum",
    "BSUM": "bounded_difference",
    "DRS": "drastic_product",
}
"""The standard's text has BDIF and DRP where its schema has, by mistake, BSUM and DRS; both are read."""

SCHEMA_CONJUNCTIONS = {"BSUM": "bounded_difference", "DRS": "drastic_product"}
"""What is written, so that the file is valid by the standard's schema."""

DISJUNCTIONS = {
    "MAX": "max",
    "PROBOR": "algebraic_sum",
    "BSUM": "bounded_sum",
    "DRS": "drastic_sum",
    "ESUM": "einstein_sum",
    "HSUM": "hamacher_sum",
    "NILMAX": "nilpotent_maximum",
}

DEFUZZIFIERS = {"COG": "centroid", "COA": "bisector", "MOM": "mom", "LM": "som", "RM": "lom"}

HEDGES = {
    "any": "any",
    "extremely": "extremely",
    "intensify": "intensify",
    "more_or_less": "more_or_less",
    "plus": "plus",
    "seldom": "seldom",
    "somewhat": "somewhat",
    "very": "very",
}
REFUSED_HEDGES = ("above", "below", "norm", "slightly")

VARIABLES = ("fuzzyVariable", "tskVariable", "tsukamotoVariable")
REFUSED_VARIABLES = ("aggregatedFuzzyVariable", "anYaDataCloud")
REFUSED_SHAPES = ("circularDefinition", "customShape", "customMonotonicShape")


class RuleTags(NamedTuple):
    """The elements of a rule."""

    rule: str
    consequent: str
    then: str
    otherwise: str
    clause: str


_OVER_SETS = RuleTags("rule", "consequent", "then", "else", "clause")

RULE_BASES = {
    "mamdaniRuleBase": _OVER_SETS,
    "tsukamotoRuleBase": _OVER_SETS,
    "tskRuleBase": RuleTags("tskRule", "tskConsequent", "tskThen", "tskElse", "tskClause"),
}
REFUSED_RULE_BASES = ("anYaRuleBase",)


class Kind(NamedTuple):
    """A shape: the number of its parameters, and what it is in the document."""

    n_parameters: int
    build: Callable[..., Shape]


SHAPES = {
    "triangularShape": Kind(3, Triangle),
    "trapezoidShape": Kind(4, Trapezoid),
    "gaussianShape": Kind(2, Gaussian),
    "leftGaussianShape": Kind(2, lambda mean, sigma: Gaussian2(-math.inf, sigma, mean, sigma)),
    "rightGaussianShape": Kind(2, lambda mean, sigma: Gaussian2(mean, sigma, math.inf, sigma)),
    "leftLinearShape": Kind(2, lambda a, b: Ramp(b, a)),
    "rightLinearShape": Kind(2, Ramp),
    "piShape": Kind(2, lambda a, b: PiShape(a, b, b, b + abs(b - a))),
    "rectangularShape": Kind(2, Rectangle),
    "singletonShape": Kind(1, Singleton),
    "sShape": Kind(2, SShape),
    "zShape": Kind(2, ZShape),
}
"""All but ``pointSetShape``."""

MONOTONE_SHAPES = (
    *("leftGaussianShape", "rightGaussianShape", "leftLinearShape", "rightLinearShape", "sShape", "zShape"),
    "pointSetMonotonicShape",
)
"""Shapes of a Tsukamoto system's terms."""
