"""Edits of the rule table, or of another grid over the rules: single cells, and patterns that fill it."""

from __future__ import annotations

from msgspec.structs import replace

from fuzzy import patterns
from fuzzy.edits.access import find, term_number
from fuzzy.edits.grids import Grid, default_grid, grid_cells, set_grid_cells
from fuzzy.errors import InvalidSystemError
from fuzzy.partition import places
from fuzzy.patterns import Cells
from fuzzy.rules import all_rules
from fuzzy.system import FuzzySystem, RuleBase, RuleTable, Variable


def set_cell(
    system: FuzzySystem, row: str | int, column: str | int, consequent: str | None, grid: Grid | None = None
) -> FuzzySystem:
    """Paint one cell.

    Args:
        system: A system with a rule table, or any with a grid.
        row: Term of the row input, or its number from 0.
        column: Term of the column input, or its number from 0.
        consequent: Term of the output; None for no rule.
        grid: Where the cell is; by default the rule table.
    """
    where = grid or _table_grid(system)
    i = term_number(find(system, where.rows), row)
    j = term_number(find(system, where.columns), column)
    cells = grid_cells(system, where)
    painted = (*cells[i][:j], consequent, *cells[i][j + 1 :])
    return set_grid_cells(system, where, (*cells[:i], painted, *cells[i + 1 :]))


def set_cells(system: FuzzySystem, cells: Cells) -> FuzzySystem:
    """Replace all cells of the rule table."""
    return set_grid_cells(system, _table_grid(system), cells)


def fill_diagonal(system: FuzzySystem, grid: Grid | None = None) -> FuzzySystem:
    """Fill the rule table or a grid with clip(i + j), as :func:`fuzzy.patterns.diagonal` says."""
    where, rows, columns, output = _filled(system, grid)
    return set_grid_cells(system, where, patterns.diagonal(len(rows.terms), len(columns.terms), _names(output)))


def fill_piltan(system: FuzzySystem, grid: Grid | None = None) -> FuzzySystem:
    """Fill the rule table or a grid, which must be 7 by 7 for 7 terms, with that of ``rulebases/piltan.yaml``."""
    where, rows, columns, output = _filled(system, grid)
    return set_grid_cells(system, where, patterns.piltan(len(rows.terms), len(columns.terms), _names(output)))


def fill_linear(system: FuzzySystem, proportional: float, derivative: float, grid: Grid | None = None) -> FuzzySystem:
    """Fill the rule table or a grid as the PD law T = Kp e + Kd ė would, as :func:`fuzzy.patterns.linear` says.

    Args:
        system: The system.
        proportional: Kp, in the output's unit per the row input's unit.
        derivative: Kd, in the output's unit per the column input's unit.
        grid: What is filled; by default the rule table.
    """
    where, rows, columns, output = _filled(system, grid)
    terms = _names(output)
    cells = patterns.linear(places(rows), places(columns), places(output), terms, proportional, derivative)
    return set_grid_cells(system, where, cells)


def full_gains(system: FuzzySystem, grid: Grid | None = None) -> tuple[float, float]:
    """Return Kp and Kd at which half the width of either input's range gives half that of the output's."""
    _, rows, columns, output = _filled(system, grid)
    width = output.high - output.low
    return width / (rows.high - rows.low), width / (columns.high - columns.low)


def mirror_antisymmetrically(system: FuzzySystem, grid: Grid | None = None) -> FuzzySystem:
    """Replace the second half of the cells by the mirror of the first, as :func:`fuzzy.patterns.mirrored` says."""
    where, _, _, output = _filled(system, grid)
    return set_grid_cells(system, where, patterns.mirrored(grid_cells(system, where), _names(output)))


def clear_table(system: FuzzySystem, grid: Grid | None = None) -> FuzzySystem:
    """Empty all cells of the rule table or of a grid."""
    where, rows, columns, _ = _filled(system, grid)
    return set_grid_cells(system, where, patterns.empty(len(rows.terms), len(columns.terms)))


def dissolve_table(system: FuzzySystem) -> FuzzySystem:
    """Write the rules of the table as the first ones of the list; their numbers and all outputs stay."""
    rule_table(system)
    return replace(system, rules=RuleBase(None, all_rules(system)))


def rule_table(system: FuzzySystem) -> RuleTable:
    """Return the rule table of a system that has one."""
    if system.rules.table is None:
        raise InvalidSystemError("the system has no rule table: its rules are a list", "rules.table")
    return system.rules.table


def _table_grid(system: FuzzySystem) -> Grid:
    rule_table(system)
    grid = default_grid(system)
    assert grid is not None
    return grid


def _filled(system: FuzzySystem, grid: Grid | None) -> tuple[Grid, Variable, Variable, Variable]:
    """Return the grid that is filled, and the variables of its rows, its columns and its cells."""
    where = grid or _table_grid(system)
    return where, find(system, where.rows), find(system, where.columns), find(system, where.output)


def _names(variable: Variable) -> list[str]:
    return [term.name for term in variable.terms]
