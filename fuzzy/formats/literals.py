"""Antecedents that are one chain of propositions, which is all that .fis and FML can say."""

from __future__ import annotations

from typing import NamedTuple

from fuzzy.system import And, Expression, Hedge, Hedged, Is, Not, Or, Rule


class Literal(NamedTuple):
    """A proposition with hedges, the first to act first, and then perhaps NOT."""

    proposition: Is
    hedges: tuple[Hedge, ...] = ()
    is_negated: bool = False


class Chain(NamedTuple):
    """Literals joined by AND, or by OR."""

    literals: tuple[Literal, ...]
    is_or: bool = False


def chain(antecedent: Expression) -> Chain | None:
    """Return an antecedent as a chain; None where it is nested deeper."""
    match antecedent:
        case And(operands=operands) | Or(operands=operands):
            found = [literal(operand) for operand in operands]
            literals = tuple(entry for entry in found if entry is not None)
            return Chain(literals, isinstance(antecedent, Or)) if len(literals) == len(found) else None
        case _:
            single = literal(antecedent)
            return Chain((single,)) if single is not None else None


def literal(expression: Expression) -> Literal | None:
    """Return an expression as a literal; None where it joins others or hedges a NOT."""
    is_negated = False
    while isinstance(expression, Not):
        is_negated = not is_negated
        expression = expression.operand
    hedges: list[Hedge] = []
    while isinstance(expression, Hedged):
        hedges.append(expression.hedge)
        expression = expression.operand
    if not isinstance(expression, Is):
        return None
    return Literal(expression, tuple(reversed(hedges)), is_negated)


def one_conclusion_each(rule: Rule) -> list[Rule]:
    """Return a rule as several of which none concludes twice on one output; they act as the one did."""
    groups: list[list[Is]] = []
    for consequent in rule.consequents:
        for group in groups:
            if all(entry.variable != consequent.variable for entry in group):
                group.append(consequent)
                break
        else:
            groups.append([consequent])
    return [Rule(rule.antecedent, tuple(group), rule.weight) for group in groups]
