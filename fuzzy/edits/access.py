"""What every edit needs: to find a variable or a term, to put a changed one back, to go through rules."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from msgspec.structs import replace

from fuzzy.errors import InvalidSystemError, expected
from fuzzy.patterns import Cells
from fuzzy.system import And, Expression, FuzzySystem, Hedged, Input, Is, Not, Or, Rule, RuleTable, Variable
from fuzzy.validation import validate


def variables_of(system: FuzzySystem) -> tuple[Variable, ...]:
    """Return the inputs and then the outputs."""
    return (*system.inputs, *system.outputs)


def find(system: FuzzySystem, name: str) -> Variable:
    """Return the input or output of this name, or refuse a name that there is not."""
    for variable in variables_of(system):
        if variable.name == name:
            return variable
    raise InvalidSystemError(f"unknown variable {expected(name, (entry.name for entry in variables_of(system)))}")


def term_number(variable: Variable, term: str | int) -> int:
    """Return the number of a term that is given by its name or number, or refuse one that there is not."""
    names = [entry.name for entry in variable.terms]
    if isinstance(term, int):
        if not 0 <= term < len(names):
            message = f"'{variable.name}' has no term number {term}: valid are 0 to {len(names) - 1}"
            raise InvalidSystemError(message, f"{path_of(variable)}.terms")
        return term
    if term not in names:
        raise InvalidSystemError(
            f"unknown term of '{variable.name}': {expected(term, names)}", f"{path_of(variable)}.terms"
        )
    return names.index(term)


def path_of(variable: Variable) -> str:
    """Return the place of a variable in the document, for errors."""
    return f"{'inputs' if isinstance(variable, Input) else 'outputs'}.{variable.name}"


def changed(system: FuzzySystem, variable: Variable, **changes: Any) -> FuzzySystem:
    """Return the valid system in which fields of ``variable`` are changed."""
    return validate(replaced(system, variable, replace(variable, **changes)))


def replaced(system: FuzzySystem, variable: Variable, changed: Variable) -> FuzzySystem:
    """Put ``changed`` where ``variable`` stands; the result may be invalid."""
    inputs: Any = tuple(changed if entry.name == variable.name else entry for entry in system.inputs)
    outputs: Any = tuple(changed if entry.name == variable.name else entry for entry in system.outputs)
    return replace(system, inputs=inputs, outputs=outputs)


def mapped_rule(rule: Rule, change: Callable[[Is], Is]) -> Rule:
    """Return a rule with all its propositions changed."""
    consequents = tuple(change(consequent) for consequent in rule.consequents)
    return replace(rule, antecedent=mapped(rule.antecedent, change), consequents=consequents)


def mapped(expression: Expression, change: Callable[[Is], Is]) -> Expression:
    """Return an antecedent with all its propositions changed."""
    match expression:
        case Is():
            return change(expression)
        case Hedged(operand=operand, hedge=hedge):
            return Hedged(mapped(operand, change), hedge)
        case Not(operand=operand):
            return Not(mapped(operand, change))
        case And(operands=operands):
            return And(tuple(mapped(operand, change) for operand in operands))
        case Or(operands=operands):
            return Or(tuple(mapped(operand, change) for operand in operands))


def mapped_cells(table: RuleTable, change: Callable[[str | None], str | None]) -> Cells:
    """Return the cells of a table, each changed."""
    return tuple(tuple(change(cell) for cell in row) for row in table.cells)
