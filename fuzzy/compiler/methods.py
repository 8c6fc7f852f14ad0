"""Which method defuzzifies an output: the fastest that is exact for its sets and the operators."""

from __future__ import annotations

from typing import NamedTuple, assert_never

from fuzzy.compiler.rules import S_NORM, T_NORM
from fuzzy.kernels import codes, norms
from fuzzy.system import WEIGHTED_VALUES, Aggregation, Inference, Sampling

IMPLICATION = T_NORM | {
    "bounded_sum": norms.IMPLY_BOUNDED_SUM,
    "algebraic_sum": norms.IMPLY_ALGEBRAIC_SUM,
    "kleene_dienes": norms.IMPLY_KLEENE_DIENES,
}
AGGREGATION = S_NORM | {"sum": norms.SUM, "min": norms.LEAST}
MAXIMUM = {
    "mom": codes.MEAN,
    "som": codes.SMALLEST,
    "lom": codes.LARGEST,
    "som_abs": codes.SMALLEST_MAGNITUDE,
    "lom_abs": codes.LARGEST_MAGNITUDE,
}
"""Codes of the defuzzifiers that ask where the set is largest."""

SETLESS = WEIGHTED_VALUES | {"height"}
"""Defuzzifiers that need no set."""

STRAIGHT_IMPLICATIONS = frozenset(IMPLICATION) - {"einstein_product", "hamacher_product"}
STRAIGHT_AGGREGATIONS = frozenset({"max", "sum", "bounded_sum", "min"})
"""Operators of which straight lines consist of straight pieces again."""


class Traits(NamedTuple):
    """What the choice of a method depends on.

    Attributes:
        is_linear: All sets are piecewise linear.
        is_pointwise: All sets are singletons.
        only_neighbours_overlap: Nowhere do three sets overlap, and none overlaps two others on its right.
    """

    is_linear: bool
    is_pointwise: bool
    only_neighbours_overlap: bool


def aggregation(inference: Inference) -> Aggregation:
    """Return how the sets are aggregated: the center of sums is the centroid of their sum, whatever is chosen."""
    return "sum" if inference.defuzzifier == "center_of_sums" else inference.aggregation


def grouping(inference: Inference) -> int:
    """Return what the members of an output's set are, so that their aggregate is that of all the rules' own sets."""
    joined = aggregation(inference)
    grows = inference.implication != "kleene_dienes"  # with the firing strength
    if joined == ("max" if grows else "min"):
        return codes.LARGEST_STRENGTH
    is_weighted = inference.defuzzifier in SETLESS
    if joined == "sum" and inference.implication == "product" and not is_weighted:
        return codes.SUM_OF_STRENGTHS
    return codes.EVERY_CONSEQUENT


def method(inference: Inference, traits: Traits) -> int:
    """Return the code of the method for an output."""
    defuzzifier = inference.defuzzifier
    if defuzzifier in SETLESS or traits.is_pointwise:
        return codes.WEIGHTED_SUM if defuzzifier == "weighted_sum" else codes.WEIGHTED_AVERAGE
    is_straight = (
        traits.is_linear
        and inference.implication in STRAIGHT_IMPLICATIONS
        and aggregation(inference) in STRAIGHT_AGGREGATIONS
    )
    resolution = inference.resolution
    is_polygon = isinstance(resolution, Sampling) and resolution.rule == "polygon"
    match defuzzifier:
        case "centroid" | "center_of_sums":
            if isinstance(resolution, Sampling):
                return codes.POLYGON_CENTROID if is_polygon else codes.SAMPLED
            return _centroid(inference, traits) if is_straight else codes.QUADRATURE
        case "bisector":
            if isinstance(resolution, Sampling):
                return codes.POLYGON_BISECTOR if is_polygon else codes.SAMPLED_BISECTOR
            return codes.LINEAR_BISECTOR if is_straight else codes.CURVED_BISECTOR
        case "mom" | "som" | "lom" | "som_abs" | "lom_abs":
            if isinstance(resolution, Sampling):
                return codes.POLYGON_MAXIMA if is_polygon else codes.SAMPLED_MAXIMA
            return codes.LINEAR_MAXIMA if is_straight else codes.CURVED_MAXIMA
        case "height" | "weighted_average" | "weighted_sum":
            raise AssertionError(defuzzifier)
        case _:
            assert_never(defuzzifier)


def _centroid(inference: Inference, traits: Traits) -> int:
    joined = aggregation(inference)
    if inference.implication in {"min", "product"}:
        if joined == "sum":
            return codes.SEPARATE
        if joined == "max":
            is_clipped = inference.implication == "min" and traits.only_neighbours_overlap
            return codes.CLIPPED if is_clipped else codes.ENVELOPE
    return codes.LINEAR_CENTROID
