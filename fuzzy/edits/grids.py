"""Two-dimensional views of the rules: the rule table, or what the list says about two inputs and a slice of the rest.

A rule of the list stands in a grid where its antecedent is one AND of exactly ``rows is …``, ``columns is …`` and the
grid's slice. All other rules are not in it.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable
from typing import NamedTuple

from msgspec.structs import replace

from fuzzy.edits.access import find
from fuzzy.errors import InvalidSystemError
from fuzzy.patterns import Cells
from fuzzy.rules import propositions, table_rule_indices
from fuzzy.system import And, FuzzySystem, Input, Is, Output, Rule, RuleBase, RuleTable, Variable
from fuzzy.validation import validate


class Grid(NamedTuple):
    """Which rules are looked at.

    Attributes:
        rows: The input along the rows.
        columns: The input along the columns.
        output: The output that the cells conclude.
        slice: What the rules say about other inputs, at most one proposition for each; without one for an input, the
            rules that do not name it.
    """

    rows: str
    columns: str
    output: str
    slice: tuple[Is, ...] = ()


def default_grid(system: FuzzySystem) -> Grid | None:
    """Return the rule table's own grid, or for a list that of its first rule that fits; None for one input."""
    if system.rules.table is not None:
        return Grid(system.rules.table.rows, system.rules.table.columns, system.rules.table.output)
    if len(system.inputs) < 2:
        return None
    inputs = [variable.name for variable in system.inputs]
    for rule in system.rules.list:
        said = _conjunction(rule)
        if said is not None and len(said) >= 2:
            rows, columns, *others = sorted(said, key=inputs.index)
            return Grid(rows, columns, rule.consequents[0].variable, tuple(said[name] for name in others))
    return Grid(inputs[0], inputs[1], system.outputs[0].name)


def fitting_grid(system: FuzzySystem, grid: Grid | None) -> Grid | None:
    """Return the grid without what the system does not have; the default one where rows, columns or output are gone."""
    inputs = {variable.name: {term.name for term in variable.terms} for variable in system.inputs}
    outputs = [variable.name for variable in system.outputs]
    if grid is None or not {grid.rows, grid.columns} <= inputs.keys() or grid.output not in outputs:
        return default_grid(system)
    if grid.rows == grid.columns:
        return default_grid(system)
    others = inputs.keys() - {grid.rows, grid.columns}
    kept = tuple(said for said in grid.slice if said.variable in others and said.term in inputs[said.variable])
    return grid._replace(slice=kept)


def is_table(system: FuzzySystem, grid: Grid) -> bool:
    """Return whether a grid shows the rule table, as it is or turned."""
    table = system.rules.table
    return (
        table is not None
        and not grid.slice
        and grid.output == table.output
        and {grid.rows, grid.columns} == {table.rows, table.columns}
    )


def grid_cells(system: FuzzySystem, grid: Grid) -> Cells:
    """Return what the rules conclude: a row for each term of ``rows``, a column for each of ``columns``; None: no rule.

    Where several rules of the list stand in one cell, the first is shown.
    """
    if is_table(system, grid):
        table = system.rules.table
        assert table is not None
        return table.cells if table.rows == grid.rows else _turned(table.cells)
    rows, columns = _axes(system, grid)
    found = {place: _concluded(system.rules.list[n], grid) for place, n in _first_rules(system, grid).items()}
    return tuple(tuple(found.get((row, column)) for column in columns) for row in rows)


def grid_rule_numbers(system: FuzzySystem, grid: Grid) -> tuple[tuple[int, ...], ...]:
    """Return the number of each cell's rule among ``fuzzy.rules.all_rules``; -1 for none."""
    numbers = table_rule_indices(system)
    if is_table(system, grid):
        table = system.rules.table
        assert table is not None
        return numbers if table.rows == grid.rows else tuple(zip(*numbers, strict=True))
    offset = sum(number >= 0 for row in numbers for number in row)
    rows, columns = _axes(system, grid)
    found = {place: offset + n for place, n in _first_rules(system, grid).items()}
    return tuple(tuple(found.get((row, column), -1) for column in columns) for row in rows)


def set_grid_cells(system: FuzzySystem, grid: Grid, cells: Cells) -> FuzzySystem:
    """Let the cells of a grid conclude these terms.

    In a list, a new term replaces the conclusion of the cell's first rule, which keeps its weight, or adds a rule;
    None removes the conclusion of all rules that stand in the cell, and rules that conclude nothing else with it.
    """
    if is_table(system, grid):
        table = system.rules.table
        assert table is not None
        own = cells if table.rows == grid.rows else _turned(cells)
        return validate(replace(system, rules=replace(system.rules, table=replace(table, cells=own))))
    rows, columns = _axes(system, grid)
    if len(cells) != len(rows) or any(len(row) != len(columns) for row in cells):
        raise InvalidSystemError(f"expected {len(rows)} rows of {len(columns)} cells", "rules")
    present = grid_cells(system, grid)
    wanted = {
        (row, column): cells[i][j]
        for (i, row), (j, column) in itertools.product(enumerate(rows), enumerate(columns))
        if cells[i][j] != present[i][j]
    }
    listed = _with_conclusions(system, grid, wanted)
    return validate(replace(system, rules=replace(system.rules, list=tuple(listed))))


def give_table(system: FuzzySystem, grid: Grid) -> FuzzySystem:
    """Give a system without a rule table one of the grid's rows, columns and output.

    It takes the rules of the list that a cell can say: without a slice, with the weight 1, the first for each cell.

    Raises:
        InvalidSystemError: If there is a table already, or if the order of the rules matters.
    """
    if system.rules.table is not None:
        raise InvalidSystemError("there is a rule table already", "rules.table")
    outputs = {output.name for output in system.outputs}
    if any(said.variable in outputs for rule in system.rules.list for said in propositions(rule.antecedent)):
        raise InvalidSystemError("a rule tests an output, so that the order of the rules matters", "rules.list")
    own = grid._replace(slice=())
    rows, columns = _axes(system, own)
    taken = {
        place: number for place, number in _first_rules(system, own).items() if system.rules.list[number].weight == 1
    }
    cells = tuple(
        tuple(
            _concluded(system.rules.list[taken[row, column]], own) if (row, column) in taken else None
            for column in columns
        )
        for row in rows
    )
    numbers = set(taken.values())
    left = (_without(rule, own.output) if n in numbers else rule for n, rule in enumerate(system.rules.list))
    table = RuleTable(own.rows, own.columns, own.output, cells)
    return validate(replace(system, rules=RuleBase(table, tuple(rule for rule in left if rule.consequents))))


def _with_conclusions(system: FuzzySystem, grid: Grid, wanted: dict[tuple[str, str], str | None]) -> Iterable[Rule]:
    first = _first_rules(system, grid)
    for number, rule in enumerate(system.rules.list):
        place = _place(rule, grid)
        if place is None or place not in wanted:
            yield rule
        elif wanted[place] is None:
            left = _without(rule, grid.output)
            if left.consequents:
                yield left
        elif first[place] == number:
            conclusion = Is(grid.output, wanted[place] or "")
            same = (conclusion if said.variable == grid.output else said for said in rule.consequents)
            yield replace(rule, consequents=tuple(dict.fromkeys(same)))
        else:
            yield rule
    for (row, column), term in wanted.items():
        if term is not None and (row, column) not in first:
            antecedent = And((Is(grid.rows, row), Is(grid.columns, column), *grid.slice))
            yield Rule(antecedent, (Is(grid.output, term),))


def _first_rules(system: FuzzySystem, grid: Grid) -> dict[tuple[str, str], int]:
    """Return the number in the list of the first rule of each cell that has one."""
    found: dict[tuple[str, str], int] = {}
    for number, rule in enumerate(system.rules.list):
        place = _place(rule, grid)
        if place is not None:
            found.setdefault(place, number)
    return found


def _place(rule: Rule, grid: Grid) -> tuple[str, str] | None:
    """Return the terms of the row and the column in which a rule stands; None for one that is not in the grid."""
    said = _conjunction(rule)
    if said is None or said.keys() != {grid.rows, grid.columns, *(one.variable for one in grid.slice)}:
        return None
    if any(said[one.variable] != one for one in grid.slice) or _concluded(rule, grid) is None:
        return None
    return said[grid.rows].term, said[grid.columns].term


def _conjunction(rule: Rule) -> dict[str, Is] | None:
    """Return what a rule says about each input if it is one AND of propositions about different inputs."""
    if not isinstance(rule.antecedent, And):
        return None
    said = {one.variable: one for one in rule.antecedent.operands if isinstance(one, Is)}
    return said if len(said) == len(rule.antecedent.operands) else None


def _concluded(rule: Rule, grid: Grid) -> str | None:
    return next((said.term for said in rule.consequents if said.variable == grid.output), None)


def _without(rule: Rule, output: str) -> Rule:
    return replace(rule, consequents=tuple(said for said in rule.consequents if said.variable != output))


def _axes(system: FuzzySystem, grid: Grid) -> tuple[list[str], list[str]]:
    rows, columns, output = (find(system, name) for name in grid[:3])
    if not isinstance(rows, Input) or not isinstance(columns, Input) or not isinstance(output, Output):
        raise InvalidSystemError("a grid has two inputs along its sides and an output in its cells", "rules")
    return _names(rows), _names(columns)


def _names(variable: Variable) -> list[str]:
    return [term.name for term in variable.terms]


def _turned(cells: Cells) -> Cells:
    return tuple(zip(*cells, strict=True))
