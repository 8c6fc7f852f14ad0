"""What a designer should know about a system: gaps, contradictions, rules and terms without effect."""

from __future__ import annotations

import itertools
import os
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from msgspec.structs import replace

from fuzzy import formats, sets
from fuzzy.consistency import consistency
from fuzzy.errors import InvalidSystemError
from fuzzy.finding import Finding
from fuzzy.formats.yaml import nearest
from fuzzy.language import format_expression
from fuzzy.partition import order
from fuzzy.rules import all_rules, propositions
from fuzzy.system import And, Expression, FuzzySystem, Hedged, Is, Not, Or, Output, Rule, RuleTable, Variable
from fuzzy.validation import validate

_INTENDED = 0.75
"""Share of a table from which a property counts as intended and the rest as slips."""


def check(system: FuzzySystem) -> list[Finding]:
    """Return what is wrong, doubtful or worth knowing in a system, in the order of the document.

    An invalid system gives one error; both shipped rule bases give nothing.
    """
    try:
        system = validate(system)
    except InvalidSystemError as error:
        return [Finding("error", error.message, error.path)]
    found = [finding for variable in system.inputs for finding in _cover(variable)]
    found += _unused_terms(system)
    found += _defaults(system)
    found += _curved_sets(system)
    found += consistency(system)
    if system.rules.table is not None:
        found += _missing_cells(system, system.rules.table)
        found += _slips(system, system.rules.table)
    return found + list(_rules(system))


def locate(findings: Iterable[Finding], path: str | os.PathLike[str]) -> list[Finding]:
    """Return the findings with the line and column of their place in the file from which the system was read."""
    return located(findings, formats.positions(path))


def located(findings: Iterable[Finding], places: Mapping[str, tuple[int, int]]) -> list[Finding]:
    """Return the findings with the line and column of their place, given those of all paths of a file."""
    found: list[Finding] = []
    for finding in findings:
        line, column = nearest(places, finding.path)
        found.append(replace(finding, line=line, column=column))
    return found


def gaps(variable: Variable) -> list[tuple[float, float]]:
    """Return the intervals and single points (low = high) of a variable's range at which every degree is 0."""
    ends = {variable.low, variable.high}
    for term in variable.terms:
        ends.update(sets.support(term, variable.low, variable.high))
        ends.update(value for value in sets.break_points(term) if variable.low <= value <= variable.high)
    # Between two neighbouring ends every set is 0 throughout or nowhere.
    knots = sorted(end for end in ends if variable.low <= end <= variable.high)
    pieces = [(knots[0], knots[0])]
    for left, right in itertools.pairwise(knots):
        pieces += [(left, right), (right, right)]
    found: list[tuple[float, float]] = []
    continues = False
    for left, right in pieces:
        middle = left + (right - left) / 2
        is_gap = not any(sets.is_positive(term, middle) for term in variable.terms)
        if is_gap and continues:
            found[-1] = (found[-1][0], right)
        elif is_gap:
            found.append((left, right))
        continues = is_gap
    return found


def _cover(variable: Variable) -> Iterator[Finding]:
    path = f"inputs.{variable.name}"
    for low, high in gaps(variable):
        where = f"at {low:g}" if low == high else f"from {low:g} to {high:g}"
        yield Finding("warning", f"no term of '{variable.name}' is above 0 {where}", f"{path}.terms")
    for term in variable.terms:
        left, right = sets.support(term, variable.low, variable.high)
        if left > right or (left == right and not sets.is_positive(term, left)):
            message = f"'{term.name}' is 0 in all of [{variable.low:g}, {variable.high:g}]: its rules never fire"
            yield Finding("warning", message, f"{path}.terms.{term.name}")


def _unused_terms(system: FuzzySystem) -> Iterator[Finding]:
    used: set[Is] = set()
    for rule in all_rules(system):
        used.update(propositions(rule.antecedent), rule.consequents)
    for variable in (*system.inputs, *system.outputs):
        is_output = isinstance(variable, Output)
        path = f"{'outputs' if is_output else 'inputs'}.{variable.name}"
        unused = [term.name for term in variable.terms if Is(variable.name, term.name) not in used]
        if len(unused) == len(variable.terms):
            message = f"no rule concludes '{variable.name}'" if is_output else f"no rule tests '{variable.name}'"
            yield Finding("warning", message, path)
            continue
        for name in unused:
            message = f"no rule {'concludes' if is_output else 'tests'} '{variable.name} is {name}'"
            yield Finding("hint" if is_output else "warning", message, f"{path}.terms.{name}")


def _defaults(system: FuzzySystem) -> Iterator[Finding]:
    for output in system.outputs:
        policy, value = output.no_fire.policy, output.no_fire.value
        if policy == "default" and not output.low <= value <= output.high:
            message = f"default {value:g} is outside the range [{output.low:g}, {output.high:g}]"
            yield Finding("warning", message, f"outputs.{output.name}.no_fire")


def _curved_sets(system: FuzzySystem) -> Iterator[Finding]:
    if system.inference.resolution != "exact":
        return
    for output in system.outputs:
        curved = [f"'{term.name}'" for term in output.terms if not sets.is_linear(term)]
        if curved:
            message = f"{', '.join(curved)} of '{output.name}' have no closed form: integrated by quadrature to 1e-9"
            yield Finding("hint", message, f"outputs.{output.name}.terms")


def _missing_cells(system: FuzzySystem, table: RuleTable) -> Iterator[Finding]:
    rows, columns = _axis(system, table.rows), _axis(system, table.columns)
    for i, (row, cells) in enumerate(zip(rows, table.cells, strict=True)):
        empty = [
            j
            for j, cell in enumerate(cells)
            if cell is None and not _is_ruled(system.rules.list, table, row, columns[j])
        ]
        if empty:
            names = ", ".join(columns[j] for j in empty)
            message = f"no rule for '{table.rows} is {row}' with '{table.columns}': {names}"
            yield Finding("warning", message, f"rules.table.cells.{row}", tuple((i, j) for j in empty))


def _is_ruled(listed: tuple[Rule, ...], table: RuleTable, row: str, column: str) -> bool:
    """Whether a rule of the list speaks about a cell, whatever the other inputs are."""
    here = {Is(table.rows, row), Is(table.columns, column)}
    axes = {table.rows, table.columns}
    return any(
        _holds(rule.antecedent, here)
        and axes.issuperset(proposition.variable for proposition in propositions(rule.antecedent))
        and any(consequent.variable == table.output for consequent in rule.consequents)
        for rule in listed
    )


def _holds(expression: Expression, true: set[Is]) -> bool:
    match expression:
        case Is():
            return expression in true
        case Not(operand=operand):
            return not _holds(operand, true)
        case Hedged(operand=operand, hedge=hedge):  # every other hedge keeps 0 and 1
            return hedge == "any" or _holds(operand, true)
        case And(operands=operands):
            return all(_holds(operand, true) for operand in operands)
        case Or(operands=operands):
            return any(_holds(operand, true) for operand in operands)


def _slips(system: FuzzySystem, table: RuleTable) -> Iterator[Finding]:
    """Find cells that break a property which the table otherwise has, by the order of the sets, not of the names."""
    variables: dict[str, Variable] = {entry.name: entry for entry in (*system.inputs, *system.outputs)}
    output = variables[table.output].terms
    rank = {output[number].name: place for place, number in enumerate(order(output))}
    rows, columns = order(variables[table.rows].terms), order(variables[table.columns].terms)
    ranks = {(i, j): rank[cell] for i in rows for j in columns if (cell := table.cells[i][j]) is not None}
    across = [((i, left), (i, right)) for i in rows for left, right in itertools.pairwise(columns)]
    down = [((upper, j), (lower, j)) for j in columns for upper, lower in itertools.pairwise(rows)]
    yield from _breaks(system, table, ranks, across, table.columns)
    yield from _breaks(system, table, ranks, down, table.rows)
    ranges = (variables[name] for name in (table.rows, table.columns, table.output))
    if all(variable.low == -variable.high for variable in ranges):
        mirrors = dict(zip(itertools.product(rows, columns), itertools.product(rows[::-1], columns[::-1]), strict=True))
        yield from _asymmetries(system, table, ranks, mirrors, len(output) - 1)


_Cell = tuple[int, int]


def _breaks(
    system: FuzzySystem, table: RuleTable, ranks: dict[_Cell, int], steps: list[tuple[_Cell, _Cell]], along: str
) -> Iterator[Finding]:
    """Find steps against the direction in which the output goes along one input."""
    change = {step: ranks[step[1]] - ranks[step[0]] for step in steps if step[0] in ranks and step[1] in ranks}
    rising = sum(value > 0 for value in change.values())
    falling = sum(value < 0 for value in change.values())
    if not rising or not falling or max(rising, falling) < _INTENDED * (rising + falling):
        return
    words = ("falls", "rises") if rising > falling else ("rises", "falls")
    for step, value in change.items():
        if value and (value > 0) != (rising > falling):
            first, second = (_cell_name(system, table, cell) for cell in step)
            message = f"'{table.output}' {words[0]} from {first} to {second}, but {words[1]} with '{along}' elsewhere"
            yield Finding("hint", message, _cell_path(system, table, step[1]), step)


def _asymmetries(
    system: FuzzySystem, table: RuleTable, ranks: dict[_Cell, int], mirrors: dict[_Cell, _Cell], total: int
) -> Iterator[Finding]:
    """Find pairs of opposite cells whose terms are not opposite, in a table where most are."""
    pairs = [(cell, mirror) for cell, mirror in mirrors.items() if cell <= mirror]
    broken = [(cell, mirror) for cell, mirror in pairs if ranks.get(cell, -1) != total - ranks.get(mirror, total + 1)]
    if len(broken) > (1 - _INTENDED) * len(pairs):
        return
    for cell, mirror in broken:
        first, second = _cell_name(system, table, cell), _cell_name(system, table, mirror)
        message = f"{first} and {second} are not opposite: the table is antisymmetric elsewhere"
        if cell == mirror:
            message = f"{first} is not the middle term: the table is antisymmetric elsewhere"
        yield Finding("hint", message, _cell_path(system, table, mirror), tuple({cell: None, mirror: None}))


def _rules(system: FuzzySystem) -> Iterator[Finding]:
    if not all_rules(system):
        yield Finding("warning", "there are no rules: every output stays at its value for when no rule fires", "rules")
    offset = len(all_rules(system)) - len(system.rules.list)
    known: dict[tuple[Any, str], tuple[int, str]] = {}
    for number, rule in enumerate(all_rules(system)):
        path = f"rules.list[{number - offset}]" if number >= offset else "rules.table"
        if rule.weight == 0:
            yield Finding("hint", "the weight is 0: this rule never fires", path)
        key = _meaning(rule.antecedent)
        for consequent in rule.consequents:
            other, term = known.setdefault((key, consequent.variable), (number, consequent.term))
            if other == number:
                continue
            verb = "repeats" if term == consequent.term else "contradicts"
            where = "a cell of the table" if other < offset else f"rules.list[{other - offset}]"
            said = f"if {format_expression(rule.antecedent)} then {consequent.variable} is {term}"
            yield Finding("warning", f"{verb} {where}: {said}", path)


def _meaning(expression: Expression) -> Any:
    """Return a key that is equal for antecedents that differ only in the order of AND's and OR's operands."""
    match expression:
        case Is():
            return expression
        case Not(operand=operand):
            return ("not", _meaning(operand))
        case Hedged(operand=operand, hedge=hedge):
            return (hedge, _meaning(operand))
        case And(operands=operands) | Or(operands=operands):
            return (type(expression), frozenset(_meaning(operand) for operand in operands))


def _axis(system: FuzzySystem, name: str) -> list[str]:
    return next([term.name for term in entry.terms] for entry in system.inputs if entry.name == name)


def _cell_name(system: FuzzySystem, table: RuleTable, cell: _Cell) -> str:
    row, column = _axis(system, table.rows)[cell[0]], _axis(system, table.columns)[cell[1]]
    return f"({row}, {column}) {table.cells[cell[0]][cell[1]] or '~'}"


def _cell_path(system: FuzzySystem, table: RuleTable, cell: _Cell) -> str:
    return f"rules.table.cells.{_axis(system, table.rows)[cell[0]]}[{cell[1]}]"
