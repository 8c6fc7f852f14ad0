"""Edits of a variable: its name, its range, its policies."""

from __future__ import annotations

from msgspec.structs import replace

from fuzzy import motion
from fuzzy.edits.access import changed, find, mapped_rule, path_of, replaced, variables_of
from fuzzy.errors import InvalidSystemError
from fuzzy.system import FuzzySystem, Input, Is, NoFire, OutOfRange, Output, RuleBase
from fuzzy.validation import validate


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
