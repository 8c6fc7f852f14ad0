"""Edits of the terms of a variable; the rules follow."""

from __future__ import annotations

from typing import Literal

from msgspec.structs import replace

from fuzzy import conversion, partition, shapes
from fuzzy.edits.access import changed, find, mapped_cells, mapped_rule, path_of, term_number
from fuzzy.errors import InvalidSystemError, expected
from fuzzy.rules import propositions
from fuzzy.shapes import Shape
from fuzzy.system import FuzzySystem, Is, RuleBase, Term

MoveMode = Literal["free", "partition"]
"""How a point moves: alone, or with its neighbours' points so that the degrees keep the sum 1."""


def set_shape(system: FuzzySystem, variable: str, term: str, shape: Shape) -> FuzzySystem:
    """Give a term another fuzzy set."""
    found = find(system, variable)
    number = term_number(found, term)
    terms = (*found.terms[:number], replace(found.terms[number], shape=shape), *found.terms[number + 1 :])
    return changed(system, found, terms=terms)


def set_shape_kind(system: FuzzySystem, variable: str, term: str, kind: str) -> FuzzySystem:
    """Give a term's set another shape that stands where the old one stood, as :func:`fuzzy.conversion.converted` says.

    Args:
        system: The system.
        variable: Name of an input or output.
        term: Name of its term.
        kind: The schema's word for the shape, such as ``gaussian``.
    """
    found = find(system, variable)
    shape = found.terms[term_number(found, term)].shape
    return set_shape(system, variable, term, conversion.converted(shape, kind))


def move_point(
    system: FuzzySystem, variable: str, term: str, parameter: str, value: float, mode: MoveMode = "free"
) -> FuzzySystem:
    """Move one parameter of a term's shape.

    Args:
        system: The system.
        variable: Name of an input or output.
        term: Name of its term.
        parameter: Name of the shape's parameter, such as ``b`` or ``sigma``.
        value: The new value.
        mode: ``free`` moves the parameter alone; ``partition`` as :func:`fuzzy.partition.move_point` says.

    Raises:
        InvalidSystemError: If the shape would no longer be in order, or would pass its neighbour in a partition.
    """
    found = find(system, variable)
    path = f"{path_of(found)}.terms.{term}"
    shape = found.terms[term_number(found, term)].shape
    if mode == "partition":
        return changed(system, found, terms=partition.move_point(found.terms, term, parameter, value, path))
    if parameter not in shapes.parameter_names(shape):
        raise InvalidSystemError(f"unknown parameter {expected(parameter, shapes.parameter_names(shape))}", path)
    return set_shape(system, variable, term, shapes.with_parameter(shape, parameter, value))


def rename_term(system: FuzzySystem, variable: str, term: str, name: str) -> FuzzySystem:
    """Rename a term; the rules follow."""
    found = find(system, variable)
    number = term_number(found, term)
    if name in {entry.name for entry in found.terms} - {term}:
        raise InvalidSystemError(f"'{variable}' has a term '{name}' already", f"{path_of(found)}.terms.{term}")

    def renamed(proposition: Is) -> Is:
        return Is(variable, name) if proposition == Is(variable, term) else proposition

    table = system.rules.table
    if table is not None and table.output == variable:
        table = replace(table, cells=mapped_cells(table, lambda cell: name if cell == term else cell))
    rules = tuple(mapped_rule(rule, renamed) for rule in system.rules.list)
    terms = (*found.terms[:number], replace(found.terms[number], name=name), *found.terms[number + 1 :])
    return changed(replace(system, rules=RuleBase(table, rules)), found, terms=terms)


def add_term(system: FuzzySystem, variable: str, name: str, shape: Shape, number: int | None = None) -> FuzzySystem:
    """Add a term before the term ``number``, or as the last; the rule table gets an empty row or column for it."""
    found = find(system, variable)
    place = len(found.terms) if number is None else number
    if not 0 <= place <= len(found.terms):
        raise InvalidSystemError(f"place {place}: valid are 0 to {len(found.terms)}", f"{path_of(found)}.terms")
    table = system.rules.table
    if table is not None and table.rows == variable:
        empty = (None,) * len(find(system, table.columns).terms)
        table = replace(table, cells=(*table.cells[:place], empty, *table.cells[place:]))
    elif table is not None and table.columns == variable:
        table = replace(table, cells=tuple((*row[:place], None, *row[place:]) for row in table.cells))
    terms = (*found.terms[:place], Term(name, shape), *found.terms[place:])
    return changed(replace(system, rules=replace(system.rules, table=table)), found, terms=terms)


def move_term(system: FuzzySystem, variable: str, term: str, place: int) -> FuzzySystem:
    """Put a term at another place in the order of its variable; its row or column of the rule table goes with it."""
    found = find(system, variable)
    number = term_number(found, term)
    if not 0 <= place < len(found.terms):
        message = f"place {place}: valid are 0 to {len(found.terms) - 1}"
        raise InvalidSystemError(message, f"{path_of(found)}.terms")
    order = [n for n in range(len(found.terms)) if n != number]
    order.insert(place, number)
    table = system.rules.table
    if table is not None and table.rows == variable:
        table = replace(table, cells=tuple(table.cells[n] for n in order))
    elif table is not None and table.columns == variable:
        table = replace(table, cells=tuple(tuple(row[n] for n in order) for row in table.cells))
    terms = tuple(found.terms[n] for n in order)
    return changed(replace(system, rules=replace(system.rules, table=table)), found, terms=terms)


def remove_term(system: FuzzySystem, variable: str, term: str) -> FuzzySystem:
    """Remove a term and what needs it.

    Its row or column of the rule table goes, cells that conclude it become empty, rules of the list lose a
    consequent that concludes it, and those that test for it or have no consequent left are dropped.
    """
    found = find(system, variable)
    number = term_number(found, term)
    gone = Is(variable, term)
    table = system.rules.table
    if table is not None and table.rows == variable:
        table = replace(table, cells=(*table.cells[:number], *table.cells[number + 1 :]))
    elif table is not None and table.columns == variable:
        table = replace(table, cells=tuple((*row[:number], *row[number + 1 :]) for row in table.cells))
    elif table is not None and table.output == variable:
        table = replace(table, cells=mapped_cells(table, lambda cell: None if cell == term else cell))
    kept = (
        replace(rule, consequents=tuple(consequent for consequent in rule.consequents if consequent != gone))
        for rule in system.rules.list
        if gone not in propositions(rule.antecedent)
    )
    rules = RuleBase(table, tuple(rule for rule in kept if rule.consequents))
    terms = (*found.terms[:number], *found.terms[number + 1 :])
    return changed(replace(system, rules=rules), found, terms=terms)
