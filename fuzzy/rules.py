"""The rules of a system as one list, and what an antecedent consists of."""

from __future__ import annotations

from fuzzy.system import And, Expression, FuzzySystem, Hedged, Is, Not, Or, Rule

MAX_DEPTH = 16
"""Greatest nesting of NOT, hedges, AND and OR in an antecedent."""

MAX_PROPOSITIONS = 64
"""Greatest number of propositions in an antecedent, and of consequents in a rule."""


def all_rules(system: FuzzySystem) -> tuple[Rule, ...]:
    """Return every rule of a system in the order in which rules are numbered, from 0.

    First the table, row by row without the empty cells, then the list.
    """
    table = system.rules.table
    if table is None:
        return system.rules.list
    rows = _terms_of(system, table.rows)
    columns = _terms_of(system, table.columns)
    expanded = tuple(
        Rule(And((Is(table.rows, row), Is(table.columns, column))), (Is(table.output, cell),))
        for row, cells in zip(rows, table.cells, strict=True)
        for column, cell in zip(columns, cells, strict=True)
        if cell is not None
    )
    return expanded + system.rules.list


def table_rule_indices(system: FuzzySystem) -> tuple[tuple[int, ...], ...]:
    """Return the number of each table cell's rule, rows by columns, -1 for an empty cell; () without a table."""
    if system.rules.table is None:
        return ()
    number = -1
    indices: list[tuple[int, ...]] = []
    for cells in system.rules.table.cells:
        row: list[int] = []
        for cell in cells:
            number += cell is not None
            row.append(-1 if cell is None else number)
        indices.append(tuple(row))
    return tuple(indices)


def propositions(expression: Expression) -> list[Is]:
    """Return the propositions of an antecedent from left to right."""
    match expression:
        case Is():
            return [expression]
        case Not(operand=operand) | Hedged(operand=operand):
            return propositions(operand)
        case And(operands=operands) | Or(operands=operands):
            return [proposition for operand in operands for proposition in propositions(operand)]


def depth(expression: Expression) -> int:
    """Return how many NOT, hedges, AND and OR stand above the deepest proposition."""
    match expression:
        case Is():
            return 0
        case Not(operand=operand) | Hedged(operand=operand):
            return 1 + depth(operand)
        case And(operands=operands) | Or(operands=operands):
            return 1 + max((depth(operand) for operand in operands), default=0)


def _terms_of(system: FuzzySystem, variable: str) -> list[str]:
    return next([term.name for term in entry.terms] for entry in system.inputs if entry.name == variable)
