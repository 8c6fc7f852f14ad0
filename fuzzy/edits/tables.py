"""Edits of the rule table: single cells, and patterns that fill it."""

from __future__ import annotations

from msgspec.structs import replace

from fuzzy import patterns
from fuzzy.edits.access import find, term_number
from fuzzy.errors import InvalidSystemError
from fuzzy.patterns import Cells
from fuzzy.system import FuzzySystem, RuleTable
from fuzzy.validation import validate


def set_cell(system: FuzzySystem, row: str | int, column: str | int, consequent: str | None) -> FuzzySystem:
    """Paint one cell of the rule table.

    Args:
        system: A system with a rule table.
        row: Term of the table's row input, or its number from 0.
        column: Term of the column input, or its number from 0.
        consequent: Term of the output; None for no rule.
    """
    table = rule_table(system)
    i = term_number(find(system, table.rows), row)
    j = term_number(find(system, table.columns), column)
    cells = table.cells[i]
    return set_cells(system, (*table.cells[:i], (*cells[:j], consequent, *cells[j + 1 :]), *table.cells[i + 1 :]))


def set_cells(system: FuzzySystem, cells: Cells) -> FuzzySystem:
    """Replace all cells of the rule table."""
    return validate(replace(system, rules=replace(system.rules, table=replace(rule_table(system), cells=cells))))


def fill_diagonal(system: FuzzySystem) -> FuzzySystem:
    """Fill the rule table with clip(i + j), as :func:`fuzzy.patterns.diagonal` says."""
    return set_cells(system, patterns.diagonal(*_dimensions(system)))


def fill_piltan(system: FuzzySystem) -> FuzzySystem:
    """Fill the rule table, which must be 7 by 7 for 7 terms, with that of ``rulebases/piltan.yaml``."""
    return set_cells(system, patterns.piltan(*_dimensions(system)))


def mirror_antisymmetrically(system: FuzzySystem) -> FuzzySystem:
    """Replace the second half of the rule table by the mirror of the first, as :func:`fuzzy.patterns.mirrored` says."""
    return set_cells(system, patterns.mirrored(rule_table(system).cells, _dimensions(system)[2]))


def clear_table(system: FuzzySystem) -> FuzzySystem:
    """Empty all cells of the rule table."""
    rows, columns, _ = _dimensions(system)
    return set_cells(system, patterns.empty(rows, columns))


def rule_table(system: FuzzySystem) -> RuleTable:
    """Return the rule table of a system that has one."""
    if system.rules.table is None:
        raise InvalidSystemError("the system has no rule table: its rules are a list", "rules.table")
    return system.rules.table


def _dimensions(system: FuzzySystem) -> tuple[int, int, list[str]]:
    """Return the numbers of rows and columns of the rule table, and the terms that its cells may hold."""
    table = rule_table(system)
    rows, columns = find(system, table.rows), find(system, table.columns)
    return len(rows.terms), len(columns.terms), [term.name for term in find(system, table.output).terms]
