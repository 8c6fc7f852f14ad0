"""Outputs of TSK and Tsukamoto systems as FML."""

from __future__ import annotations

import math
from collections.abc import Iterator
from xml.sax.saxutils import quoteattr

import numpy as np

from fuzzy import geometry, sets
from fuzzy.errors import InvalidSystemError
from fuzzy.formats.fml import words
from fuzzy.formats.fml.elements import default_value, points_element, quoted_name, shape_element
from fuzzy.formats.saying import Adapter, digits, weighted_aggregation
from fuzzy.shapes import Gaussian, Gaussian2, Linear, Ramp, Shape, SShape, ZShape, kind
from fuzzy.system import FuzzySystem, Output, Term

_SAMPLES = 65


def outputs(system: FuzzySystem, adapter: Adapter) -> Iterator[str]:
    """Write the outputs of a valid system with weighted outputs.

    Raises:
        InvalidSystemError: For what the format cannot say.
    """
    inference = system.inference
    if inference.defuzzifier != "weighted_average":
        adapter.word(words.DEFUZZIFIERS, inference.defuzzifier, "inference.defuzzifier", None)
    if weighted_aggregation(inference) == "max":
        adapter.cannot("'max' of a weighted average", "inference.aggregation", "'sum'")
    for output in system.outputs:
        path = f"outputs.{output.name}"
        tag, term_tag = ("tskVariable", "tskTerm") if _is_tsk(output) else ("tsukamotoVariable", "tsukamotoTerm")
        more = f"scale={quoteattr(' '.join(output.unit.split()))}"
        if tag == "tsukamotoVariable":
            more += f' domainleft="{digits(output.low)}" domainright="{digits(output.high)}"'
        default = digits(default_value(output, adapter))
        name = quoted_name(output.name, path, adapter)
        yield f'    <{tag} name={name} {more} type="output" combination="WA" defaultValue="{default}">'
        for term in output.terms:
            place = f"{path}.terms.{term.name}"
            name = quoted_name(term.name, place, adapter)
            if tag == "tskVariable":
                attributes, inside = _function(term, place)
            else:
                attributes, inside = _monotone(term, output, place, adapter)
            yield f"      <{term_tag} name={name} {attributes}>"
            yield f"        {inside}"
            yield f"      </{term_tag}>"
        yield f"    </{tag}>"


def rule_bases(system: FuzzySystem) -> dict[str, frozenset[str]]:
    """Return the rule bases that are needed, and the outputs on which their rules conclude."""
    of_functions = frozenset(output.name for output in system.outputs if _is_tsk(output))
    others = frozenset(output.name for output in system.outputs) - of_functions
    found = {"tskRuleBase": of_functions, "tsukamotoRuleBase": others}
    return {base: names for base, names in found.items() if names}


def _is_tsk(output: Output) -> bool:
    return any(isinstance(term.shape, Linear) or sets.is_singleton(term) for term in output.terms)


def _function(term: Term, path: str) -> tuple[str, str]:
    """Return the attributes and the values of a term: the constant comes first."""
    if isinstance(term.shape, Linear):
        order, values = 1, (term.shape.constant, *term.shape.coefficients)
    elif sets.is_singleton(term):
        order, values = 0, sets.break_points(term)
    else:
        raise InvalidSystemError("FML cannot say sets beside constants and functions of one output", path)
    return f'order="{order}"', "".join(f"<tskValue>{digits(value)}</tskValue>" for value in values)


def _monotone(term: Term, output: Output, path: str, adapter: Adapter) -> tuple[str, str]:
    """Return the attributes and the shape of a term that rises or falls all over the range."""
    shape = _said(term.shape, output) if term.height == 1 else None
    if shape is not None:
        element = shape_element(shape, output)
        assert element is not None, "the standard has these shapes"
        return f'complement="{str(term.complement).lower()}"', element
    if sets.is_linear(term):
        points = _corners(term, output)
    else:
        places = np.linspace(output.low, output.high, _SAMPLES)
        points = list(zip(places.tolist(), sets.degrees(term, places).tolist(), strict=True))
        adapter.cannot(f"the shape '{kind(term.shape)}' of a monotone term", path, f"{_SAMPLES} points")
    return 'complement="false"', points_element("pointSetMonotonicShape", points)


def _said(shape: Shape, output: Output) -> Shape | None:
    """Return the shape that is the same within the range and that the standard has for a monotone term, if any."""
    match shape:
        case Ramp() | SShape() | ZShape():
            return shape
        case Gaussian2(left_mean=left, right_mean=right) if output.high <= right or left <= output.low:
            if output.high <= right:
                return Gaussian2(left, shape.left_sigma, math.inf, 1.0)
            return Gaussian2(-math.inf, 1.0, right, shape.right_sigma)
        case Gaussian(mean=mean, sigma=sigma) if mean <= output.low:
            return Gaussian2(-math.inf, 1.0, mean, sigma)
        case Gaussian(mean=mean, sigma=sigma) if output.high <= mean:
            return Gaussian2(mean, sigma, math.inf, 1.0)
        case _:
            return None


def _corners(term: Term, output: Output) -> list[tuple[float, float]]:
    """Return the points through which a piecewise-linear set goes within the range, two where it jumps."""
    found: list[tuple[float, float]] = []
    end = output.low, 0.0  # outside its segments a set is 0
    for left, right, first, last in geometry.clipped_to(sets.segments(term), output.low, output.high):
        if left > end[0]:
            found += [end, (left, 0.0)]
        found += [(left, first), (right, last)]
        end = right, 0.0
    if end[0] < output.high:
        found += [end, (output.high, 0.0)]
    return list(dict.fromkeys(found))
