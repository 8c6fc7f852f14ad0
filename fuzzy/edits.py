"""What a designer does to a system: pure functions FuzzySystem -> FuzzySystem.

Each returns a valid system or raises :class:`InvalidSystemError`; the system that was given stays as it is.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, Literal

from msgspec.structs import replace

from fuzzy import partition, patterns, shapes
from fuzzy.errors import InvalidSystemError, expected
from fuzzy.patterns import Cells
from fuzzy.rules import propositions
from fuzzy.shapes import Gaussian, Shape
from fuzzy.system import (
    And,
    Expression,
    FuzzySystem,
    Input,
    Is,
    NoFire,
    Not,
    Or,
    OutOfRange,
    Output,
    Rule,
    RuleBase,
    RuleTable,
    Term,
    Variable,
)
from fuzzy.validation import validate

MoveMode = Literal["free", "partition"]
"""How a point moves: alone, or with its neighbours' points so that the degrees keep the sum 1."""


def set_name(system: FuzzySystem, name: str) -> FuzzySystem:
    """Name the system."""
    return validate(replace(system, name=name))


def set_notes(system: FuzzySystem, notes: str) -> FuzzySystem:
    """Replace the notes."""
    return validate(replace(system, notes=notes))


def set_inference(system: FuzzySystem, **changes: Any) -> FuzzySystem:
    """Change operators, defuzzifier or resolution; keywords are the fields of :class:`fuzzy.system.Inference`."""
    valid = system.inference.__struct_fields__
    for field in changes:
        if field not in valid:
            raise InvalidSystemError(f"unknown option {expected(field, valid)}", "inference")
    return validate(replace(system, inference=replace(system.inference, **changes)))


def set_no_fire(system: FuzzySystem, output: str, no_fire: NoFire) -> FuzzySystem:
    """Choose what an output is when no rule fires."""
    found = _variable(system, output)
    if not isinstance(found, Output):
        raise InvalidSystemError(f"'{output}' is an input: only outputs have a policy for when no rule fires")
    return _changed(system, found, no_fire=no_fire)


def set_out_of_range(system: FuzzySystem, variable: str, policy: OutOfRange) -> FuzzySystem:
    """Choose what happens to a value of an input outside its range."""
    found = _variable(system, variable)
    if not isinstance(found, Input):
        raise InvalidSystemError(f"'{variable}' is an output: only inputs have a policy for values out of range")
    return _changed(system, found, out_of_range=policy)


def set_range(
    system: FuzzySystem, variable: str, low: float, high: float, *, scales_terms: bool = False
) -> FuzzySystem:
    """Choose a variable's universe.

    Args:
        system: The system.
        variable: Name of an input or output.
        low: Lower end.
        high: Upper end.
        scales_terms: Whether the sets and an output's default value are stretched along, or keep their values.
    """
    found = _variable(system, variable)
    if not scales_terms:
        return _changed(system, found, low=low, high=high)
    factor = (high - low) / (found.high - found.low)

    def moved(value: float) -> float:
        return low + (value - found.low) * factor if math.isfinite(value) else value

    def stretched(shape: Shape) -> Shape:
        if isinstance(shape, Gaussian):
            return Gaussian(moved(shape.mean), shape.sigma * factor)
        return type(shape)(*map(moved, shapes.parameters(shape)))

    terms = tuple(replace(term, shape=stretched(term.shape)) for term in found.terms)
    if isinstance(found, Output) and found.no_fire.policy == "default":
        default = NoFire("default", min(max(moved(found.no_fire.value), low), high))
        return _changed(system, found, low=low, high=high, terms=terms, no_fire=default)
    return _changed(system, found, low=low, high=high, terms=terms)


def set_shape(system: FuzzySystem, variable: str, term: str, shape: Shape) -> FuzzySystem:
    """Give a term another fuzzy set."""
    found = _variable(system, variable)
    number = _term_number(found, term)
    terms = (*found.terms[:number], Term(term, shape), *found.terms[number + 1 :])
    return _changed(system, found, terms=terms)


def set_shape_kind(system: FuzzySystem, variable: str, term: str, kind: str) -> FuzzySystem:
    """Give a term's set another shape that stands where the old one stood, as :func:`fuzzy.shapes.converted` says.

    Args:
        system: The system.
        variable: Name of an input or output.
        term: Name of its term.
        kind: The schema's word for the shape, such as ``gaussian``.
    """
    found = _variable(system, variable)
    shape = found.terms[_term_number(found, term)].shape
    return set_shape(system, variable, term, shapes.converted(shape, kind))


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
    found = _variable(system, variable)
    path = f"{_path(found)}.terms.{term}"
    shape = found.terms[_term_number(found, term)].shape
    if mode == "partition":
        return _changed(system, found, terms=partition.move_point(found.terms, term, parameter, value, path))
    if parameter not in shapes.parameter_names(shape):
        raise InvalidSystemError(f"unknown parameter {expected(parameter, shapes.parameter_names(shape))}", path)
    return set_shape(system, variable, term, replace(shape, **{parameter: value}))


def rename_variable(system: FuzzySystem, variable: str, name: str) -> FuzzySystem:
    """Rename an input or output; the rules follow."""
    found = _variable(system, variable)
    if name in {entry.name for entry in _variables(system)} - {variable}:
        raise InvalidSystemError(f"the name '{name}' is used already", _path(found))

    def renamed(proposition: Is) -> Is:
        return Is(name, proposition.term) if proposition.variable == variable else proposition

    table = system.rules.table
    if table is not None:
        axes = {"rows": table.rows, "columns": table.columns, "output": table.output}
        table = replace(table, **{axis: name for axis, entry in axes.items() if entry == variable})
    rules = tuple(_mapped_rule(rule, renamed) for rule in system.rules.list)
    return validate(_replaced(replace(system, rules=RuleBase(table, rules)), found, replace(found, name=name)))


def rename_term(system: FuzzySystem, variable: str, term: str, name: str) -> FuzzySystem:
    """Rename a term; the rules follow."""
    found = _variable(system, variable)
    number = _term_number(found, term)
    if name in {entry.name for entry in found.terms} - {term}:
        raise InvalidSystemError(f"'{variable}' has a term '{name}' already", f"{_path(found)}.terms.{term}")

    def renamed(proposition: Is) -> Is:
        return Is(variable, name) if proposition == Is(variable, term) else proposition

    table = system.rules.table
    if table is not None and table.output == variable:
        table = replace(table, cells=_mapped_cells(table, lambda cell: name if cell == term else cell))
    rules = tuple(_mapped_rule(rule, renamed) for rule in system.rules.list)
    terms = (*found.terms[:number], replace(found.terms[number], name=name), *found.terms[number + 1 :])
    return _changed(replace(system, rules=RuleBase(table, rules)), found, terms=terms)


def add_term(system: FuzzySystem, variable: str, name: str, shape: Shape, number: int | None = None) -> FuzzySystem:
    """Add a term before the term ``number``, or as the last; the rule table gets an empty row or column for it."""
    found = _variable(system, variable)
    place = len(found.terms) if number is None else number
    if not 0 <= place <= len(found.terms):
        raise InvalidSystemError(f"place {place}: valid are 0 to {len(found.terms)}", f"{_path(found)}.terms")
    table = system.rules.table
    if table is not None and table.rows == variable:
        empty = (None,) * len(_variable(system, table.columns).terms)
        table = replace(table, cells=(*table.cells[:place], empty, *table.cells[place:]))
    elif table is not None and table.columns == variable:
        table = replace(table, cells=tuple((*row[:place], None, *row[place:]) for row in table.cells))
    terms = (*found.terms[:place], Term(name, shape), *found.terms[place:])
    return _changed(replace(system, rules=replace(system.rules, table=table)), found, terms=terms)


def remove_term(system: FuzzySystem, variable: str, term: str) -> FuzzySystem:
    """Remove a term and what needs it.

    Its row or column of the rule table goes, cells that conclude it become empty, rules of the list lose a
    consequent that concludes it, and those that test for it or have no consequent left are dropped.
    """
    found = _variable(system, variable)
    number = _term_number(found, term)
    gone = Is(variable, term)
    table = system.rules.table
    if table is not None and table.rows == variable:
        table = replace(table, cells=(*table.cells[:number], *table.cells[number + 1 :]))
    elif table is not None and table.columns == variable:
        table = replace(table, cells=tuple((*row[:number], *row[number + 1 :]) for row in table.cells))
    elif table is not None and table.output == variable:
        table = replace(table, cells=_mapped_cells(table, lambda cell: None if cell == term else cell))
    kept = (
        replace(rule, consequents=tuple(consequent for consequent in rule.consequents if consequent != gone))
        for rule in system.rules.list
        if gone not in propositions(rule.antecedent)
    )
    rules = RuleBase(table, tuple(rule for rule in kept if rule.consequents))
    terms = (*found.terms[:number], *found.terms[number + 1 :])
    return _changed(replace(system, rules=rules), found, terms=terms)


def set_cell(system: FuzzySystem, row: str | int, column: str | int, consequent: str | None) -> FuzzySystem:
    """Paint one cell of the rule table.

    Args:
        system: A system with a rule table.
        row: Term of the table's row input, or its number from 0.
        column: Term of the column input, or its number from 0.
        consequent: Term of the output; None for no rule.
    """
    table = rule_table(system)
    i = _term_number(_variable(system, table.rows), row)
    j = _term_number(_variable(system, table.columns), column)
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
    rows, columns = _variable(system, table.rows), _variable(system, table.columns)
    return len(rows.terms), len(columns.terms), [term.name for term in _variable(system, table.output).terms]


def _variables(system: FuzzySystem) -> tuple[Variable, ...]:
    return (*system.inputs, *system.outputs)


def _variable(system: FuzzySystem, name: str) -> Variable:
    for variable in _variables(system):
        if variable.name == name:
            return variable
    raise InvalidSystemError(f"unknown variable {expected(name, (entry.name for entry in _variables(system)))}")


def _term_number(variable: Variable, term: str | int) -> int:
    names = [entry.name for entry in variable.terms]
    if isinstance(term, int):
        if not 0 <= term < len(names):
            message = f"'{variable.name}' has no term number {term}: valid are 0 to {len(names) - 1}"
            raise InvalidSystemError(message, f"{_path(variable)}.terms")
        return term
    if term not in names:
        raise InvalidSystemError(
            f"unknown term of '{variable.name}': {expected(term, names)}", f"{_path(variable)}.terms"
        )
    return names.index(term)


def _path(variable: Variable) -> str:
    return f"{'inputs' if isinstance(variable, Input) else 'outputs'}.{variable.name}"


def _changed(system: FuzzySystem, variable: Variable, **changes: Any) -> FuzzySystem:
    return validate(_replaced(system, variable, replace(variable, **changes)))


def _replaced(system: FuzzySystem, variable: Variable, changed: Variable) -> FuzzySystem:
    """Put ``changed`` where ``variable`` stands; the result may be invalid."""
    inputs: Any = tuple(changed if entry.name == variable.name else entry for entry in system.inputs)
    outputs: Any = tuple(changed if entry.name == variable.name else entry for entry in system.outputs)
    return replace(system, inputs=inputs, outputs=outputs)


def _mapped_rule(rule: Rule, change: Callable[[Is], Is]) -> Rule:
    consequents = tuple(change(consequent) for consequent in rule.consequents)
    return replace(rule, antecedent=_mapped(rule.antecedent, change), consequents=consequents)


def _mapped(expression: Expression, change: Callable[[Is], Is]) -> Expression:
    match expression:
        case Is():
            return change(expression)
        case Not(operand=operand):
            return Not(_mapped(operand, change))
        case And(operands=operands):
            return And(tuple(_mapped(operand, change) for operand in operands))
        case Or(operands=operands):
            return Or(tuple(_mapped(operand, change) for operand in operands))


def _mapped_cells(table: RuleTable, change: Callable[[str | None], str | None]) -> Cells:
    return tuple(tuple(change(cell) for cell in row) for row in table.cells)
