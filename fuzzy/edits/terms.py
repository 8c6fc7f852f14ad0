"""Edits of the terms of a variable; the rules follow."""

from __future__ import annotations

import math
from typing import Any, Literal, get_args

from msgspec.structs import replace

from fuzzy import conversion, partition, shapes
from fuzzy.edits.access import changed, find, mapped_cells, mapped_rule, path_of, term_number
from fuzzy.errors import InvalidSystemError, expected
from fuzzy.rules import all_rules, propositions
from fuzzy.shapes import Linear, Shape, Triangle
from fuzzy.system import FuzzySystem, Is, Output, RuleBase, Term
from fuzzy.validation.shapes import validate_shape

MoveMode = Literal["free", "partition"]
"""How a point moves: alone, or with its neighbours' points so that the degrees keep the sum 1."""


Side = Literal["left", "right"]
SIDES: tuple[Side, ...] = get_args(Side)


def set_shape(system: FuzzySystem, variable: str, term: str, shape: Shape) -> FuzzySystem:
    """Give a term another fuzzy set."""
    return _with_term(system, variable, term, shape=shape)


def set_shape_kind(system: FuzzySystem, variable: str, term: str, kind: str) -> FuzzySystem:
    """Give a term's set another shape that stands where the old one stood, as :func:`fuzzy.conversion.converted` says.

    An output's term may become a function of the inputs (``linear``), at first a constant, and a set again.

    Args:
        system: The system.
        variable: Name of an input or output.
        term: Name of its term.
        kind: The schema's word for the shape, such as ``gaussian``.
    """
    found = find(system, variable)
    shape = found.terms[term_number(found, term)].shape
    if isinstance(found, Output) and kind == shapes.kind(Linear):
        place = sum(min(max(end, found.low), found.high) for end in partition.core(shape)) / 2
        return set_shape(system, variable, term, Linear((0.0,) * len(system.inputs), place))
    if isinstance(shape, Linear):
        width = (found.high - found.low) / 6
        shape = Triangle(shape.constant - width, shape.constant, shape.constant + width)
    return set_shape(system, variable, term, conversion.converted(shape, kind))


def set_height(system: FuzzySystem, variable: str, term: str, height: float) -> FuzzySystem:
    """Choose the greatest degree of a term's set, from 0 to 1."""
    return _with_term(system, variable, term, height=height)


def set_complement(system: FuzzySystem, variable: str, term: str, *, is_complement: bool) -> FuzzySystem:
    """Choose whether a term's set is the complement of its shape."""
    return _with_term(system, variable, term, complement=is_complement)


def _with_term(system: FuzzySystem, variable: str, term: str, **changes: Any) -> FuzzySystem:
    found = find(system, variable)
    number = term_number(found, term)
    changed_term = replace(found.terms[number], **changes)
    return changed(system, found, terms=(*found.terms[:number], changed_term, *found.terms[number + 1 :]))


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


def sides_that_open(shape: Shape) -> tuple[Side, ...]:
    """Return the sides of a shape that are open, or could be: 1 up to infinity."""
    return tuple(side for side in SIDES if _toggled(shape, side, 1.0) is not None)


def toggle_open_side(system: FuzzySystem, variable: str, term: str, side: Side) -> FuzzySystem:
    """Let a side of a term's set be 1 up to infinity, or let it fall again as far away as the other side does.

    Raises:
        InvalidSystemError: If the shape has no side that can be open.
    """
    found = find(system, variable)
    shape = found.terms[term_number(found, term)].shape
    toggled = _toggled(shape, side, (found.high - found.low) / 4)
    if toggled is None:
        path = f"{path_of(found)}.terms.{term}"
        raise InvalidSystemError(f"a {shapes.kind(shape)} cannot be open to the {side} here", path)
    return set_shape(system, variable, term, toggled)


def _toggled(shape: Shape, side: Side, width: float) -> Shape | None:
    """Return the shape with its outermost place on a side at infinity, or back from there; None if that cannot be.

    Args:
        shape: A valid shape.
        side: Which side.
        width: How far a side that is closed goes where the shape itself does not tell.
    """
    names, places = shapes.location_names(shape), shapes.locations(shape)
    infinity = -math.inf if side == "left" else math.inf
    if infinity in places:
        finite = [place for place in places if math.isfinite(place)]
        own = max(finite) - min(finite)
        end = min(finite) - (own or width) if side == "left" else max(finite) + (own or width)
        return shapes.with_parameter(shape, names[places.index(infinity)], end)
    for name in names if side == "left" else reversed(names):
        opened = shapes.with_parameter(shape, name, infinity)
        try:
            validate_shape(opened)
        except InvalidSystemError:
            continue
        return opened
    return None


def rules_with(system: FuzzySystem, variable: str, term: str) -> int:
    """Return how many rules go with a term if it is removed."""
    gone = Is(variable, term)
    return sum(gone in propositions(rule.antecedent) or {*rule.consequents} == {gone} for rule in all_rules(system))


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
