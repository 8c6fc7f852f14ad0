"""Fuzzy partitions: terms of which neighbours cross over, so that the degrees at every point have the sum 1.

In such a partition one term falls to 0 where the next one reaches 1, and rises where the previous one falls; moving
a point therefore moves the points of the neighbours that stand with it. (Ruspini, "A new approach to clustering",
Information and Control 15, 1969.)
"""

from __future__ import annotations

import math
from typing import NamedTuple

from msgspec.structs import replace

from fuzzy.conversion import outline
from fuzzy.errors import InvalidSystemError, expected
from fuzzy.shapes import Linear, Shape, Trapezoid, Triangle, kind, parameter_names
from fuzzy.system import Term, Variable


class _Side(NamedTuple):
    """A point of a term's core: ``is_left`` where it rises to 1, ``is_right`` where it begins to fall."""

    number: int
    is_left: bool
    is_right: bool


def core(shape: Shape) -> tuple[float, float]:
    """Return the ends of the interval on which a shape is 1; infinite on an open side."""
    match shape:
        case Triangle(b=b):
            return b, b
        case Trapezoid(b=b, c=c):
            return b, c
        case Linear(constant=constant):  # no set: where it is for inputs 0
            return constant, constant
        case _:
            found = outline(shape)
            return found.top_left, found.top_right


def places(variable: Variable) -> list[float]:
    """Return for each term the middle of that part of the range where its degree is 1, or the nearest end."""
    found = []
    for term in variable.terms:
        left, right = (min(max(end, variable.low), variable.high) for end in core(term.shape))
        found.append((left + right) / 2)
    return found


def order(terms: tuple[Term, ...]) -> list[int]:
    """Return the numbers of the terms from left to right."""
    return sorted(range(len(terms)), key=lambda number: core(terms[number].shape))


def move_point(terms: tuple[Term, ...], term: str, parameter: str, value: float, path: str) -> tuple[Term, ...]:
    """Move one point of a term, and with it the neighbours' points, so that the sum of the degrees stays 1.

    A foot moves the neighbour's core that stands on it; the outer foot of the first or last term moves alone. The
    sides that meet at a moved core are joined even if they were no partition before.

    Args:
        terms: The terms of one variable, triangles and trapezoids.
        term: Name of the term.
        parameter: Name of the shape's parameter: ``a``, ``b``, ``c`` or ``d``.
        value: Where the point goes.
        path: Place of the term, for errors.

    Raises:
        InvalidSystemError: If a shape has no such points, or if the point would pass a neighbour's core.
    """
    numbers = order(terms)
    ordered = [terms[number] for number in numbers]
    at = next(place for place, entry in enumerate(ordered) if entry.name == term)
    side = _side(ordered, at, parameter, path)
    if side is None:
        moved = ordered[at].shape
        ordered[at] = replace(ordered[at], shape=replace(moved, **{parameter: value}))
    else:
        _move_core(ordered, side, value, path)
    changed = dict(zip(numbers, ordered, strict=True))
    return tuple(changed[number] for number in range(len(terms)))


def _side(ordered: list[Term], at: int, parameter: str, path: str) -> _Side | None:
    """Return whose core a point is, or None for a foot on which no neighbour stands."""
    shape = _linear(ordered[at], path)
    names = parameter_names(shape)
    if parameter not in names:
        raise InvalidSystemError(f"unknown parameter {expected(parameter, names)}", path)
    if parameter == names[0]:
        return _whole_or(ordered, at - 1, path, is_left=False) if at > 0 else None
    if parameter == names[-1]:
        return _whole_or(ordered, at + 1, path, is_left=True) if at < len(ordered) - 1 else None
    return _whole_or(ordered, at, path, is_left=parameter == "b")


def _whole_or(ordered: list[Term], number: int, path: str, *, is_left: bool) -> _Side:
    """Return one side of a trapezoid's core, or both of a triangle's, which are one point."""
    is_peak = isinstance(_linear(ordered[number], path), Triangle)
    return _Side(number, is_left or is_peak, not is_left or is_peak)


def _move_core(ordered: list[Term], side: _Side, value: float, path: str) -> None:
    number = side.number
    left, right = core(ordered[number].shape)
    left, right = (value if side.is_left else left), (value if side.is_right else right)
    before = core(ordered[number - 1].shape)[1] if number > 0 else -math.inf
    after = core(ordered[number + 1].shape)[0] if number < len(ordered) - 1 else math.inf
    if not before < left <= right < after:
        name = ordered[number].name
        raise InvalidSystemError(
            f"{value:g} would move '{name}' past its neighbour: valid are {before:g} to {after:g}", path
        )
    _set(ordered, number, path, left=left, right=right)
    if side.is_left and number > 0:
        _set(ordered, number - 1, path, right_foot=left)
        _set(ordered, number, path, left_foot=before)
    if side.is_right and number < len(ordered) - 1:
        _set(ordered, number + 1, path, left_foot=right)
        _set(ordered, number, path, right_foot=after)


def _set(
    ordered: list[Term],
    number: int,
    path: str,
    *,
    left: float | None = None,
    right: float | None = None,
    left_foot: float | None = None,
    right_foot: float | None = None,
) -> None:
    """Replace some points of a term's shape."""
    shape = _linear(ordered[number], path)
    match shape:
        case Triangle():
            values = {"a": left_foot, "b": left, "c": right_foot}
        case Trapezoid():
            values = {"a": left_foot, "b": left, "c": right, "d": right_foot}
    changes = {name: value for name, value in values.items() if value is not None}
    ordered[number] = replace(ordered[number], shape=replace(shape, **changes))


def _linear(term: Term, path: str) -> Triangle | Trapezoid:
    if isinstance(term.shape, Triangle | Trapezoid):
        return term.shape
    message = f"a partition is made of triangles and trapezoids: '{term.name}' is a {kind(term.shape)}"
    raise InvalidSystemError(message, path)
