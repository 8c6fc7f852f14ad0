"""Terms in number: as many as wanted at equal distances, or one more between two others; the rules follow."""

from __future__ import annotations

import math
from collections.abc import Sequence

from msgspec.structs import replace

from fuzzy import partition
from fuzzy.conversion import converted
from fuzzy.edits.access import changed, find, mapped_rule, path_of, term_number
from fuzzy.edits.terms import add_term
from fuzzy.errors import InvalidSystemError
from fuzzy.limits import MAX_NAME, MAX_TERMS
from fuzzy.shapes import Shape, Trapezoid, Triangle
from fuzzy.system import FuzzySystem, Input, Is, RuleBase, RuleTable, Term, Variable

SCHEMES: dict[int, tuple[str, ...]] = {
    2: ("N", "P"),
    3: ("N", "Z", "P"),
    4: ("NB", "NS", "PS", "PB"),
    5: ("NB", "NS", "Z", "PS", "PB"),
    6: ("NB", "NM", "NS", "PS", "PM", "PB"),
    7: ("NB", "NM", "NS", "Z", "PS", "PM", "PB"),
    9: ("NV", "NB", "NM", "NS", "Z", "PS", "PM", "PB", "PV"),
}
"""Usual names: negative and positive, small, medium, big, very big, zero."""


def space_terms(system: FuzzySystem, variable: str, count: int, kind: str = "triangle") -> FuzzySystem:
    """Give a variable ``count`` terms at equal distances from one end of its range to the other.

    The triangles form a partition; those at the ends stay 1 outside the range of an input and fall beyond that of an
    output, so that it can reach its ends. Names stay where the number stays; otherwise each new term takes the name
    of the nearest old one. New rows and columns of the rule table repeat the nearest old ones, cells and rules of the
    list name the new term nearest to the old one: an antisymmetric table stays antisymmetric.

    Args:
        system: The system.
        variable: Name of an input or output.
        count: Number of terms.
        kind: The schema's word for their shape; other than triangles are converted from these.

    Raises:
        InvalidSystemError: If that is no number of terms, or no shape that can stand there.
    """
    found = find(system, variable)
    if not 1 <= count <= MAX_TERMS:
        raise InvalidSystemError(f"{count} terms: valid are 1 to {MAX_TERMS}", f"{path_of(found)}.terms")
    order = partition.order(found.terms)
    sources = [order[_nearest(number, count, len(order))] for number in range(count)]
    names = [found.terms[number].name for number in order]
    renamed = names if count == len(names) else _names(names, [found.terms[number].name for number in sources])
    follower = {name: renamed[_nearest(place, len(names), count)] for place, name in enumerate(names)}

    def followed(proposition: Is) -> Is:
        return Is(variable, follower[proposition.term]) if proposition.variable == variable else proposition

    table = system.rules.table
    if table is not None:
        table = _followed_table(table, variable, sources, follower)
    listed = (mapped_rule(rule, followed) for rule in system.rules.list)
    rules = RuleBase(table, tuple(replace(r, consequents=tuple(dict.fromkeys(r.consequents))) for r in listed))
    shapes = (converted(shape, kind) for shape in even_shapes(found, count))
    return changed(replace(system, rules=rules), found, terms=tuple(map(Term, renamed, shapes)))


def insert_term(system: FuzzySystem, variable: str, name: str, after: str, *, joins: bool = True) -> FuzzySystem:
    """Add a triangle halfway between a term and its right neighbour; to the left of the rightmost term.

    Args:
        system: The system.
        variable: Name of an input or output.
        name: Name of the new term.
        after: Name of the term beside which it comes.
        joins: Whether the feet of neighbours that are triangles or trapezoids move, so that the sum stays 1.
    """
    found = find(system, variable)
    number = term_number(found, after)
    order = partition.order(found.terms)
    at = order.index(number)
    if len(order) == 1:
        middle, width = partition.core(found.terms[number].shape)[1], (found.high - found.low) / 2
        peak = min(max(middle, found.low), found.high) + width / 2
        left, right = peak - width / 2, peak + width / 2
        place = number + 1
    else:
        if at == len(order) - 1:
            at -= 1
        first, second = found.terms[order[at]], found.terms[order[at + 1]]
        left, right = partition.core(first.shape)[1], partition.core(second.shape)[0]
        left, right = max(left, found.low - found.high), min(right, 2 * found.high - found.low)
        if not left < right:
            message = f"'{first.name}' and '{second.name}' leave no room between their tops"
            raise InvalidSystemError(message, f"{path_of(found)}.terms")
        peak = (left + right) / 2
        place = order[at] + 1 if order[at] + 1 == order[at + 1] else max(order[at], order[at + 1])
    grown = add_term(system, variable, name, Triangle(left, peak, right), place)
    terms = find(grown, variable).terms
    if not joins or not all(isinstance(term.shape, Triangle | Trapezoid) for term in terms):
        return grown
    path = f"{path_of(found)}.terms.{name}"
    return changed(grown, find(grown, variable), terms=partition.move_point(terms, name, "b", peak, path))


def fresh_name(variable: Variable, wanted: str) -> str:
    """Return ``wanted`` with the first number behind it that makes it a name that no term of the variable has."""
    return _fresh(wanted, {term.name for term in variable.terms})


def even_shapes(variable: Variable, count: int) -> list[Shape]:
    """Return triangles at equal distances over a variable's range, a partition; see :func:`space_terms`."""
    low, high = variable.low, variable.high
    if count == 1:
        return [Triangle(low, (low + high) / 2, high)]
    width = (high - low) / (count - 1)
    peaks = [low + (high - low) * number / (count - 1) for number in range(count)]
    feet = (-math.inf, math.inf) if isinstance(variable, Input) else (low - width, high + width)
    lefts, rights = (feet[0], *peaks[:-1]), (*peaks[1:], feet[1])
    return [Triangle(*three) for three in zip(lefts, peaks, rights, strict=True)]


def _nearest(number: int, count: int, others: int) -> int:
    """Return which of ``others`` places stands nearest to place ``number`` of ``count`` in the same interval.

    Halfway between two the outer one is taken, so that what is antisymmetric stays so.
    """
    middle = (others - 1) / 2
    share = 0.5 if count == 1 else number / (count - 1)
    away = share * (others - 1) - middle
    # Of the distances k + (0 or 1/2) from the middle that places have, the nearest.
    offset = 0.5 * (1 - others % 2)
    distance = math.floor(abs(away) - offset + 0.5 + 1e-9) + offset
    return round(middle + math.copysign(min(distance, middle), away))


def _names(old: list[str], nearest: list[str]) -> list[str]:
    """Return names for the new terms: those usual for their number if the old ones were, or those of the nearest."""
    if tuple(old) == SCHEMES.get(len(old)) and len(nearest) in SCHEMES:
        return list(SCHEMES[len(nearest)])
    names: list[str] = []
    for name in nearest:
        names.append(_fresh(name, {*names, *(other for other in nearest if other != name)}))
    return names


def _fresh(wanted: str, taken: set[str]) -> str:
    number, name = 1, wanted
    while name in taken:
        number += 1
        end = f" {number}"
        name = wanted[: MAX_NAME - len(end)].rstrip() + end
    return name


def _followed_table(table: RuleTable, variable: str, sources: Sequence[int], follower: dict[str, str]) -> RuleTable:
    cells = table.cells
    if variable == table.rows:
        cells = tuple(cells[number] for number in sources)
    elif variable == table.columns:
        cells = tuple(tuple(row[number] for number in sources) for row in cells)
    elif variable == table.output:
        cells = tuple(tuple(cell and follower[cell] for cell in row) for row in cells)
    return replace(table, cells=cells)
