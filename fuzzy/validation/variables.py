"""What a variable and its terms must be."""

from __future__ import annotations

import math

from fuzzy import sets, shapes
from fuzzy.errors import InvalidSystemError
from fuzzy.limits import MAX_NAME, MAX_OUTPUT_TERMS, MAX_TERMS, MAX_VALUE, MIN_RELATIVE_WIDTH, MIN_WIDTH
from fuzzy.shapes import Linear, Points
from fuzzy.system import Defuzzifier, Output, Variable
from fuzzy.validation.shapes import validate_shape
from fuzzy.validation.texts import check_count, check_name, check_unique


def check_variable(variable: Variable, path: str) -> None:
    """Refuse a variable whose range or whose terms' sets are not valid."""
    check_name(variable.name, path, "a variable's name")
    low, high = variable.low, variable.high
    if not (low < high and max(abs(low), abs(high)) <= MAX_VALUE):
        message = f"[{low:g}, {high:g}]: valid is low < high, both finite and at most {MAX_VALUE:g}"
        raise InvalidSystemError(message, f"{path}.range")
    if high - low < max(MIN_WIDTH, MIN_RELATIVE_WIDTH * max(abs(low), abs(high))):
        raise InvalidSystemError(f"[{low!r}, {high!r}] is too narrow to compute with", f"{path}.range")
    if len(variable.unit) > MAX_NAME or not variable.unit.isprintable():
        raise InvalidSystemError(f"expected at most {MAX_NAME} printable characters", f"{path}.unit")
    most = MAX_OUTPUT_TERMS if isinstance(variable, Output) else MAX_TERMS
    check_count(variable.terms, "terms", f"{path}.terms", most)
    check_unique([(term.name, f"{path}.terms.{term.name}") for term in variable.terms])
    for term in variable.terms:
        place = f"{path}.terms.{term.name}"
        check_name(term.name, place, "a term's name")
        validate_shape(term.shape, place)
        if isinstance(term.shape, Linear) and not isinstance(variable, Output):
            raise InvalidSystemError("a linear function is no set: only an output of a Sugeno system has such", place)
        if any(math.isfinite(value) and abs(value) > MAX_VALUE for value in shapes.parameters(term.shape)):
            raise InvalidSystemError(f"a parameter is beyond {MAX_VALUE:g}", place)
        if not 0 < term.height <= 1:
            raise InvalidSystemError(f"height {term.height:g}: valid is greater than 0 and at most 1", place)
        if isinstance(term.shape, Points) and not any(degree > 0 for _, degree in term.shape.points):
            raise InvalidSystemError("all points have the degree 0: no rule with this term could fire", place)


def check_output(output: Output, path: str, defuzzifier: Defuzzifier, n_inputs: int) -> None:
    """Refuse an output that is no valid variable, or whose terms the defuzzifier cannot use."""
    check_variable(output, path)
    for term in output.terms:
        place = f"{path}.terms.{term.name}"
        if isinstance(term.shape, Linear) and len(term.shape.coefficients) != n_inputs:
            message = f"{len(term.shape.coefficients)} coefficients: valid are {n_inputs}, one for each input"
            raise InvalidSystemError(message, place)
    match defuzzifier:
        case "weighted_average" | "weighted_sum":
            _check_values(output, path, defuzzifier)
        case "height":
            _check_peaks(output, path)
        case _:
            _check_areas(output, path, defuzzifier)
    policy, value = output.no_fire.policy, output.no_fire.value
    if policy == "default" and not abs(value) <= MAX_VALUE:
        message = f"default {value:g}: valid is a finite number of at most {MAX_VALUE:g}, also outside the range"
        raise InvalidSystemError(message, f"{path}.no_fire")
    if policy != "default" and value != 0:
        raise InvalidSystemError(
            f"value {value:g} belongs to the policy 'default', not to '{policy}'", f"{path}.no_fire"
        )


def _check_values(output: Output, path: str, defuzzifier: str) -> None:
    """Refuse terms that do not say by themselves, or by how far they are activated, what the output is."""
    for term in output.terms:
        if isinstance(term.shape, Linear) or sets.is_singleton(term):
            continue
        if not sets.is_monotone(term, output.low, output.high):
            message = (
                f"{shapes.kind(term.shape)} has no single value for {defuzzifier}: valid are singleton and linear "
                "(Sugeno), and sets that rise or fall all over the range (Tsukamoto)"
            )
            raise InvalidSystemError(message, f"{path}.terms.{term.name}")


def _check_peaks(output: Output, path: str) -> None:
    for term in output.terms:
        if isinstance(term.shape, Linear):
            message = "a linear function is no set: valid defuzzifiers are weighted_average and weighted_sum"
            raise InvalidSystemError(message, f"{path}.terms.{term.name}")
        left, right = sets.support(term, output.low, output.high)
        if left > right:
            message = f"the set is 0 in [{output.low:g}, {output.high:g}], so it has no peak there"
            raise InvalidSystemError(message, f"{path}.terms.{term.name}")


def _check_areas(output: Output, path: str, defuzzifier: str) -> None:
    """Refuse sets outside the range, and outputs of which no set has an area, but for one that has singletons only.

    One point among wider sets is legal: it counts where a sample hits it, and nowhere else.
    """
    if all(map(sets.is_singleton, output.terms)):
        if defuzzifier not in {"centroid", "center_of_sums"}:
            valid = "centroid, center_of_sums, height, weighted_average, weighted_sum"
            message = f"singletons have no area for {defuzzifier}: valid are {valid}"
            raise InvalidSystemError(message, f"{path}.terms")
        for term in output.terms:
            place = sets.break_points(term)[0]
            if not output.low <= place <= output.high:
                message = f"{place:g} is outside the range [{output.low:g}, {output.high:g}]"
                raise InvalidSystemError(message, f"{path}.terms.{term.name}")
        return
    least = MIN_RELATIVE_WIDTH * (output.high - output.low)
    has_area = any(
        right - left >= least for left, right in (sets.support(term, output.low, output.high) for term in output.terms)
    )
    for term in output.terms:
        if isinstance(term.shape, Linear):
            message = "a linear function is no set: valid defuzzifiers are weighted_average and weighted_sum"
            raise InvalidSystemError(message, f"{path}.terms.{term.name}")
        left, right = sets.support(term, output.low, output.high)
        is_point = left == right and has_area
        if right - left < least and not is_point:
            message = f"the set has no area in [{output.low:g}, {output.high:g}], so it has no {defuzzifier} there"
            raise InvalidSystemError(message, f"{path}.terms.{term.name}")
