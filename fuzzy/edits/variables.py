"""Edits of variables: their number, a variable's name, its range, its policies."""

from __future__ import annotations

from collections.abc import Callable

from msgspec.structs import replace

from fuzzy import conversion, motion
from fuzzy.edits.access import changed, find, mapped_rule, path_of, replaced, variables_of
from fuzzy.edits.spacing import SCHEMES, even_shapes
from fuzzy.errors import InvalidSystemError
from fuzzy.rules import propositions
from fuzzy.shapes import Linear
from fuzzy.system import (
    WEIGHTED_VALUES,
    FuzzySystem,
    Input,
    Is,
    NoFire,
    OutOfRange,
    Output,
    RuleBase,
    Term,
    Variable,
)
from fuzzy.validation import validate


def add_input(system: FuzzySystem, name: str) -> FuzzySystem:
    """Add an input from -1 to 1 with three terms; no rule asks for it yet."""
    _check_new(system, name)
    bare = Input(name, -1.0, 1.0, ())
    added = replace(bare, terms=_three_terms(bare))
    outputs = (_with_coefficients(output, lambda c: (*c, 0.0)) for output in system.outputs)
    return validate(replace(system, inputs=(*system.inputs, added), outputs=tuple(outputs)))


def add_output(system: FuzzySystem, name: str) -> FuzzySystem:
    """Add an output from -1 to 1 with three terms; no rule concludes about it yet."""
    _check_new(system, name)
    bare = Output(name, -1.0, 1.0, ())
    terms = _three_terms(bare)
    if system.inference.defuzzifier in WEIGHTED_VALUES:  # of these the terms are values
        terms = tuple(replace(term, shape=conversion.converted(term.shape, "singleton")) for term in terms)
    return validate(replace(system, outputs=(*system.outputs, replace(bare, terms=terms))))


def remove_variable(system: FuzzySystem, variable: str) -> FuzzySystem:
    """Remove an input or output; the rules that name it go with it.

    A rule that concludes about other outputs, too, keeps those. A table goes with each of its variables.

    Raises:
        InvalidSystemError: There is no such variable, or it is the only input or output.
    """
    found = find(system, variable)
    siblings = system.inputs if isinstance(found, Input) else system.outputs
    if len(siblings) == 1:
        kind = "input" if isinstance(found, Input) else "output"
        raise InvalidSystemError(f"'{variable}' is the only {kind}: a system needs one", path_of(found))
    table = system.rules.table
    if table is not None and variable in (table.rows, table.columns, table.output):
        table = None
    kept = []
    for rule in system.rules.list:
        consequents = tuple(one for one in rule.consequents if one.variable != variable)
        if consequents and variable not in {one.variable for one in propositions(rule.antecedent)}:
            kept.append(replace(rule, consequents=consequents))
    rules = RuleBase(table, tuple(kept))
    if isinstance(found, Output):
        outputs = tuple(output for output in system.outputs if output is not found)
        return validate(replace(system, outputs=outputs, rules=rules))
    number = system.inputs.index(found)
    inputs = (*system.inputs[:number], *system.inputs[number + 1 :])
    outputs = tuple(_with_coefficients(one, lambda c: (*c[:number], *c[number + 1 :])) for one in system.outputs)
    return validate(replace(system, inputs=inputs, outputs=outputs, rules=rules))


def _check_new(system: FuzzySystem, name: str) -> None:
    if name in {entry.name for entry in variables_of(system)}:
        raise InvalidSystemError(f"the name '{name}' is used already")


def _three_terms(variable: Variable) -> tuple[Term, ...]:
    return tuple(map(Term, SCHEMES[3], even_shapes(variable, 3)))


def _with_coefficients(output: Output, change: Callable[[tuple[float, ...]], tuple[float, ...]]) -> Output:
    """Return an output whose linear terms have other coefficients: one for each input."""
    terms = tuple(
        replace(term, shape=replace(term.shape, coefficients=change(term.shape.coefficients)))
        if isinstance(term.shape, Linear)
        else term
        for term in output.terms
    )
    return replace(output, terms=terms)


def rename_variable(system: FuzzySystem, variable: str, name: str) -> FuzzySystem:
    """Rename an input or output; the rules follow."""
    found = find(system, variable)
    if name in {entry.name for entry in variables_of(system)} - {variable}:
        raise InvalidSystemError(f"the name '{name}' is used already", path_of(found))

    def renamed(proposition: Is) -> Is:
        return Is(name, proposition.term) if proposition.variable == variable else proposition

    table = system.rules.table
    if table is not None:
        axes = {"rows": table.rows, "columns": table.columns, "output": table.output}
        table = replace(table, **{axis: name for axis, entry in axes.items() if entry == variable})
    rules = tuple(mapped_rule(rule, renamed) for rule in system.rules.list)
    return validate(replaced(replace(system, rules=RuleBase(table, rules)), found, replace(found, name=name)))


def set_range(
    system: FuzzySystem, variable: str, low: float, high: float, *, scales_terms: bool = False
) -> FuzzySystem:
    """Choose a variable's universe.

    Args:
        system: The system.
        variable: Name of an input or output.
        low: Lower end.
        high: Upper end.
        scales_terms: Whether the sets and an output's default value are stretched along, or keep their values.
    """
    found = find(system, variable)
    if not scales_terms:
        return changed(system, found, low=low, high=high)
    factor = (high - low) / (found.high - found.low)

    def moved(value: float) -> float:
        return low + (value - found.low) * factor

    terms = tuple(replace(term, shape=motion.moved(term.shape, moved, factor)) for term in found.terms)
    if isinstance(found, Output) and found.no_fire.policy == "default":
        value = moved(found.no_fire.value)
        is_inside = found.low <= found.no_fire.value <= found.high  # and stays so, whatever the rounding
        default = NoFire("default", min(max(value, low), high) if is_inside else value)
        return changed(system, found, low=low, high=high, terms=terms, no_fire=default)
    return changed(system, found, low=low, high=high, terms=terms)


def set_unit(system: FuzzySystem, variable: str, unit: str) -> FuzzySystem:
    """Say in which unit a variable is; an empty text is none."""
    return changed(system, find(system, variable), unit=unit)


def set_no_fire(system: FuzzySystem, output: str, no_fire: NoFire) -> FuzzySystem:
    """Choose what an output is when no rule fires."""
    found = find(system, output)
    if not isinstance(found, Output):
        raise InvalidSystemError(f"'{output}' is an input: only outputs have a policy for when no rule fires")
    return changed(system, found, no_fire=no_fire)


def set_out_of_range(system: FuzzySystem, variable: str, policy: OutOfRange) -> FuzzySystem:
    """Choose what happens to a value of an input outside its range."""
    found = find(system, variable)
    if not isinstance(found, Input):
        raise InvalidSystemError(f"'{variable}' is an output: only inputs have a policy for values out of range")
    return changed(system, found, out_of_range=policy)
