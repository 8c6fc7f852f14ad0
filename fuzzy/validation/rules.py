"""What a rule and a rule table must be."""

from __future__ import annotations

from collections.abc import Mapping

from fuzzy import rules
from fuzzy.errors import InvalidSystemError, expected
from fuzzy.system import And, Expression, Hedged, Is, Not, Or, Rule, RuleTable
from fuzzy.validation.texts import check_count

TermNames = Mapping[str, list[str]]
"""The names of each variable's terms."""


def check_table(table: RuleTable, inputs: TermNames, outputs: TermNames) -> int:
    """Refuse a table that does not fit its variables; return how many rules it holds."""
    for axis, name, valid in (
        ("rows", table.rows, inputs),
        ("columns", table.columns, inputs),
        ("output", table.output, outputs),
    ):
        if name not in valid:
            raise InvalidSystemError(f"unknown variable {expected(name, valid)}", f"rules.table.{axis}")
    if table.rows == table.columns:
        raise InvalidSystemError(f"rows and columns are the same input '{table.rows}'", "rules.table.columns")
    rows, columns, terms = inputs[table.rows], inputs[table.columns], outputs[table.output]
    known = {None, *terms}
    if len(table.cells) != len(rows):
        message = f"{len(table.cells)} rows: '{table.rows}' has {len(rows)} terms"
        raise InvalidSystemError(message, "rules.table.cells")
    for row, cells in zip(rows, table.cells, strict=True):
        if len(cells) != len(columns):
            message = f"{len(cells)} cells: '{table.columns}' has {len(columns)} terms: {', '.join(columns)}"
            raise InvalidSystemError(message, f"rules.table.cells.{row}")
        if not known.issuperset(cells):
            index, cell = next((index, cell) for index, cell in enumerate(cells) if cell not in known)
            message = f"unknown term of '{table.output}': {expected(cell, terms)}"
            raise InvalidSystemError(message, f"rules.table.cells.{row}[{index}]")
    return sum(len(cells) - cells.count(None) for cells in table.cells)


def check_rule(rule: Rule, inputs: TermNames, outputs: TermNames, path: str) -> None:
    """Refuse a rule that names what is not there, or whose weight or form is not valid."""
    if not 0 <= rule.weight <= 1:
        raise InvalidSystemError(f"weight {rule.weight:g}: valid is 0 to 1", path)
    _check_expression(rule.antecedent, path, 0)
    found = rules.propositions(rule.antecedent)
    if len(found) > rules.MAX_PROPOSITIONS:
        message = f"{len(found)} propositions in the antecedent: at most {rules.MAX_PROPOSITIONS}"
        raise InvalidSystemError(message, path)
    check_count(rule.consequents, "consequents", path, rules.MAX_PROPOSITIONS)
    for proposition in found:
        is_output = proposition.variable in outputs
        _check_proposition(proposition, outputs if is_output else inputs, "output" if is_output else "input", path)
    for consequent in rule.consequents:
        _check_proposition(consequent, outputs, "output", path)
    if len(set(rule.consequents)) != len(rule.consequents):
        raise InvalidSystemError("the same consequent stands twice in the rule", path)


def _check_expression(expression: Expression, path: str, depth: int) -> None:
    if depth > rules.MAX_DEPTH:
        raise InvalidSystemError(f"the antecedent is nested more than {rules.MAX_DEPTH} deep", path)
    match expression:
        case Is():
            pass
        case Not(operand=operand) | Hedged(operand=operand):
            _check_expression(operand, path, depth + 1)
        case And(operands=operands) | Or(operands=operands):
            if len(operands) < 2:
                raise InvalidSystemError(f"AND and OR join at least two expressions, found {len(operands)}", path)
            for operand in operands:
                _check_expression(operand, path, depth + 1)


def _check_proposition(proposition: Is, variables: TermNames, kind: str, path: str) -> None:
    terms = variables.get(proposition.variable)
    if terms is None:
        raise InvalidSystemError(f"unknown {kind} {expected(proposition.variable, variables)}", path)
    if proposition.term not in terms:
        message = f"unknown term of '{proposition.variable}': {expected(proposition.term, terms)}"
        raise InvalidSystemError(message, path)
