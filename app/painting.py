"""What painting a cell means, wherever it is pressed: in the grid of the Design panel or on the board of the scene."""

from __future__ import annotations

from functools import partial

from app.state import AppState, Edit
from fuzzy import edits
from fuzzy.edits import Grid
from fuzzy.system import FuzzySystem, Output, Variable

MOST_CELLS = 400
"""Cells that a page can hold as buttons; a greater table is shown as text only."""


def shown_grid(state: AppState) -> Grid | None:
    """Return the grid that is shown as a table; None where there is none, or one that is too large."""
    shown = state.design.grid
    if shown is None:
        return None
    rows, columns, _ = grid_variables(state.document, shown)
    return shown if len(rows.terms) * len(columns.terms) <= MOST_CELLS else None


def grid_variables(system: FuzzySystem, shown: Grid) -> tuple[Variable, Variable, Output]:
    """Return the variables along the rows and the columns of a grid, and its output."""
    inputs = {variable.name: variable for variable in system.inputs}
    outputs = {variable.name: variable for variable in system.outputs}
    return inputs[shown.rows], inputs[shown.columns], outputs[shown.output]


def painted(state: AppState, number: int) -> Edit | None:
    """Return the edit that gives a cell the brush's term; None for a cell that is no longer there.

    Args:
        state: Present state.
        number: Of the cell, row by row.
    """
    shown = shown_grid(state)
    if shown is None:
        return None
    rows, columns, _ = grid_variables(state.document, shown)
    i, j = divmod(number, len(columns.terms))
    if not 0 <= i < len(rows.terms):
        return None  # pressed while the table was being replaced by a smaller one
    row, column, brush = rows.terms[i].name, columns.terms[j].name, state.brush
    label = f"({row}, {column}) → {brush or 'no rule'}"
    return Edit(label, partial(edits.set_cell, row=row, column=column, consequent=brush, grid=shown))
