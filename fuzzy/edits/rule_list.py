"""Edits of the rules that stand in the list."""

from __future__ import annotations

from msgspec.structs import replace

from fuzzy.errors import InvalidSystemError
from fuzzy.system import FuzzySystem, Rule
from fuzzy.validation import validate


def add_rule(system: FuzzySystem, rule: Rule, number: int | None = None) -> FuzzySystem:
    """Add a rule before the one with this number in the list, counted from 0, or as the last."""
    listed = system.rules.list
    place = len(listed) if number is None else number
    if not 0 <= place <= len(listed):
        raise InvalidSystemError(f"place {place}: valid are 0 to {len(listed)}", "rules.list")
    return _listed(system, (*listed[:place], rule, *listed[place:]))


def set_rule(system: FuzzySystem, number: int, rule: Rule) -> FuzzySystem:
    """Replace one rule of the list."""
    listed = _checked(system, number)
    return _listed(system, (*listed[:number], rule, *listed[number + 1 :]))


def set_weight(system: FuzzySystem, number: int, weight: float) -> FuzzySystem:
    """Give one rule of the list another weight, from 0 to 1."""
    return set_rule(system, number, replace(_checked(system, number)[number], weight=weight))


def remove_rule(system: FuzzySystem, number: int) -> FuzzySystem:
    """Remove one rule of the list."""
    listed = _checked(system, number)
    return _listed(system, (*listed[:number], *listed[number + 1 :]))


def _checked(system: FuzzySystem, number: int) -> tuple[Rule, ...]:
    listed = system.rules.list
    if not 0 <= number < len(listed):
        raise InvalidSystemError(f"no rule {number + 1}: the list has {len(listed)}", "rules.list")
    return listed


def _listed(system: FuzzySystem, listed: tuple[Rule, ...]) -> FuzzySystem:
    return validate(replace(system, rules=replace(system.rules, list=listed)))
