"""Patterns that fill a rule table, on tables of any size.

Rows, columns and the output's terms are counted from the middle one: a table of n rows has row i at i - (n - 1) / 2.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from fuzzy.errors import InvalidSystemError

Cells = tuple[tuple[str | None, ...], ...]

PILTAN = (
    (-3, -3, -3, -2, -1, -1, 0),
    (-3, -2, -2, -2, -1, 0, 1),
    (-3, -2, -1, -1, 0, 1, 2),
    (-3, -2, -1, 0, 1, 2, 3),
    (-2, -1, 0, 1, 1, 2, 3),
    (-1, 0, 1, 2, 2, 2, 3),
    (0, 1, 1, 2, 3, 3, 3),
)
"""The table of ``rulebases/piltan.yaml``: the output's terms, counted from the middle one."""


def diagonal(rows: int, columns: int, terms: Sequence[str]) -> Cells:
    """Return clip(i + j): the sum of row and column, counted from the middle, at most the outermost term.

    Where the sum lies between two terms, the outer one is taken, so that the table stays antisymmetric.
    """
    middle = (len(terms) - 1) / 2

    def cell(row: int, column: int) -> str:
        total = row - (rows - 1) / 2 + column - (columns - 1) / 2
        away = math.ceil(abs(total) + middle) - middle
        number = middle + math.copysign(min(away, middle), total)
        return terms[round(number)]

    return tuple(tuple(cell(row, column) for column in range(columns)) for row in range(rows))


def piltan(rows: int, columns: int, terms: Sequence[str]) -> Cells:
    """Return the table of ``rulebases/piltan.yaml``.

    Raises:
        InvalidSystemError: If the table is not 7 by 7 with 7 output terms.
    """
    if (rows, columns, len(terms)) != (7, 7, 7):
        message = f"piltan is a table of 7 by 7 cells with 7 terms: found {rows} by {columns} with {len(terms)}"
        raise InvalidSystemError(message, "rules.table")
    return tuple(tuple(terms[number + 3] for number in row) for row in PILTAN)


def linear(
    rows: Sequence[float],
    columns: Sequence[float],
    places: Sequence[float],
    terms: Sequence[str],
    proportional: float,
    derivative: float,
) -> Cells:
    """Return the table of a linear law: in each cell the term that stands nearest to Kp row + Kd column.

    Halfway between two terms the one further from 0 is taken, so that the table stays antisymmetric.

    Args:
        rows: Where the terms of the rows' input stand.
        columns: Likewise for the columns.
        places: Where the output's terms stand.
        terms: Their names.
        proportional: Kp, output over row input.
        derivative: Kd, output over column input.
    """
    if not (math.isfinite(proportional) and math.isfinite(derivative)):
        raise InvalidSystemError(f"gains {proportional:g} and {derivative:g}: valid are finite numbers", "rules.table")
    slack = 1e-9 * (max(places) - min(places))

    def cell(wanted: float) -> str:
        nearest = min(abs(place - wanted) for place in places)
        candidates = [number for number, place in enumerate(places) if abs(place - wanted) <= nearest + slack]
        return terms[max(candidates, key=lambda number: abs(places[number]))]

    return tuple(tuple(cell(proportional * row + derivative * column) for column in columns) for row in rows)


def mirrored(cells: Cells, terms: Sequence[str]) -> Cells:
    """Return the table made antisymmetric: its first half stays, the second half becomes the first one's mirror.

    The mirror of cell (i, j) is (n - 1 - i, m - 1 - j) with the term that lies as far on the other side of the
    middle; a middle cell becomes the middle term, where there is one.
    """
    rows, columns = len(cells), len(cells[0])
    opposite: dict[str | None, str | None] = dict(zip(terms, reversed(terms), strict=True))
    flat = [cell for row in cells for cell in row]
    half = len(flat) // 2
    middle = flat[half : len(flat) - half]
    if middle and middle[0] is not None and len(terms) % 2:
        middle = [terms[len(terms) // 2]]
    second = [opposite.get(cell) for cell in reversed(flat[:half])]
    flat = [*flat[:half], *middle, *second]
    return tuple(tuple(flat[row * columns : (row + 1) * columns]) for row in range(rows))


def empty(rows: int, columns: int) -> Cells:
    """Return a table without rules."""
    return ((None,) * columns,) * rows
