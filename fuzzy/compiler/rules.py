"""Rules -> RuleTables: the grid, the antecedents as programs, the consequents."""

from __future__ import annotations

import functools
from typing import assert_never

import numpy as np

from fuzzy.compiler.arrays import KEPT, frozen, integers, numbers, starts
from fuzzy.errors import InvalidSystemError
from fuzzy.kernels import codes, hedges, norms
from fuzzy.kernels.address import entries
from fuzzy.kernels.tables import Integers, Numbers, RuleTables
from fuzzy.rules import propositions
from fuzzy.system import And, Expression, FuzzySystem, Hedged, Input, Is, Not, Or, Output, Rule

T_NORM = {
    "min": norms.MIN,
    "product": norms.PRODUCT,
    "bounded_difference": norms.BOUNDED_DIFFERENCE,
    "drastic_product": norms.DRASTIC_PRODUCT,
    "einstein_product": norms.EINSTEIN_PRODUCT,
    "hamacher_product": norms.HAMACHER_PRODUCT,
    "nilpotent_minimum": norms.NILPOTENT_MINIMUM,
}
"""Codes of AND."""

S_NORM = {
    "max": norms.MAX,
    "algebraic_sum": norms.ALGEBRAIC_SUM,
    "bounded_sum": norms.BOUNDED_SUM,
    "drastic_sum": norms.DRASTIC_SUM,
    "einstein_sum": norms.EINSTEIN_SUM,
    "hamacher_sum": norms.HAMACHER_SUM,
    "nilpotent_maximum": norms.NILPOTENT_MAXIMUM,
}
"""Codes of OR."""

_HEDGE = {
    "very": hedges.VERY,
    "extremely": hedges.EXTREMELY,
    "somewhat": hedges.SOMEWHAT,
    "more_or_less": hedges.MORE_OR_LESS,
    "plus": hedges.PLUS,
    "intensify": hedges.INTENSIFY,
    "seldom": hedges.SELDOM,
    "any": hedges.ANY,
}

Names = dict[tuple[str, str], int]


def compile_rules(system: FuzzySystem) -> tuple[RuleTables, Integers]:
    """Return the rules' tables and their entries in a directory.

    Which term a cell names is all that painting it changes.

    Raises:
        InvalidSystemError: When a rule names a variable or a term that is not there.
    """
    table = system.rules.table
    known = _term_numbers(system.outputs)
    terms: list[int] = []
    filled: tuple[bool, ...] = ()
    if table is not None:
        cells = [cell for row in table.cells for cell in row]
        filled = tuple(cell is not None for cell in cells)
        try:
            terms = [known[table.output, cell] for cell in cells if cell is not None]
        except KeyError as error:
            raise InvalidSystemError(f"no output term '{' is '.join(error.args[0])}'", "rules.table") from None
    for number, rule in enumerate(system.rules.list):
        terms += _consequents(rule, known, f"rules.list[{number}]")
    axes = None if table is None else (table.rows, table.columns)
    inference = system.inference
    operators = (T_NORM[inference.conjunction], S_NORM[inference.disjunction])
    variables = (*system.inputs, *_chained(system))
    frame, listed = _compile_frame(axes, filled, system.rules.list, variables, operators)
    consequent_term = integers(terms)
    consequent_output = _output_of_term(system.outputs)[consequent_term]
    ends = (consequent_term, consequent_output, starts(np.bincount(consequent_output, minlength=len(system.outputs))))
    tables = RuleTables._make((*frame, *ends))
    return tables, np.concatenate([listed, entries(frozen(ends))])


@functools.lru_cache(maxsize=KEPT)
def _compile_frame(
    axes: tuple[str, str] | None,
    filled: tuple[bool, ...],
    listed: tuple[Rule, ...],
    variables: tuple[Input | Output, ...],
    operators: tuple[int, int],
) -> tuple[tuple[np.ndarray, ...], Integers]:
    """Return what does not depend on the rules' consequents: the first fields of ``RuleTables`` and their entries.

    Args:
        axes: Inputs of the table's rows and columns.
        filled: Whether each cell of the table holds a rule, row by row.
        listed: The listed rules.
        variables: All inputs, and all outputs if an antecedent names one.
        operators: Codes of AND and OR.
    """
    places = {variable.name: place for place, variable in enumerate(variables)}
    grid_input = (0, 0) if axes is None else (places[axes[0]], places[axes[1]])
    n_columns = len(variables[grid_input[1]].terms)
    numbered = np.where(filled, np.cumsum(filled) - 1, -1) if axes is not None else np.empty(0)
    counts = [1] * sum(filled) + [len(rule.consequents) for rule in listed]
    frame = (
        integers(operators),
        integers(numbered).reshape(-1, n_columns),
        integers(grid_input),
        *_compile_list(listed, variables),
        starts(counts),
    )
    return frame, entries(frozen(frame))


def _chained(system: FuzzySystem) -> tuple[Output, ...]:
    """Return the outputs if an antecedent names one: their terms are numbered behind those of the inputs."""
    names = {output.name for output in system.outputs}
    listed = (proposition for rule in system.rules.list for proposition in propositions(rule.antecedent))
    return system.outputs if any(proposition.variable in names for proposition in listed) else ()


def _compile_list(
    listed: tuple[Rule, ...], variables: tuple[Input | Output, ...]
) -> tuple[Integers, Integers, Numbers]:
    """Return the antecedents of the listed rules, where each begins, and their weights."""
    known = _term_numbers(variables)
    inputs = sum(len(variable.terms) for variable in variables if isinstance(variable, Input))
    programs = [
        _joined_by_all(_program(rule.antecedent, known, f"rules.list[{number}]"), inputs)
        for number, rule in enumerate(listed)
    ]
    return (
        integers([word for program in programs for word in program]),
        starts(len(program) for program in programs),
        numbers([rule.weight for rule in listed]),
    )


def _joined_by_all(program: list[int], inputs: int) -> list[int]:
    """Return the quicker form of an antecedent that joins nothing but input terms by AND, others as they are.

    Args:
        program: In postfix order.
        inputs: How many input terms there are: words from this number on are outputs' terms.
    """
    if all(word == codes.AND or 0 <= word < inputs for word in program):
        return [*(word for word in program if word >= 0), codes.ALL]
    return program


def _program(expression: Expression, known: Names, path: str) -> list[int]:
    """Return an antecedent in postfix order."""
    match expression:
        case Is(variable=variable, term=term):
            if (variable, term) not in known:
                raise InvalidSystemError(f"no term '{variable} is {term}'", path)
            return [known[variable, term]]
        case Not(operand=operand):
            return [*_program(operand, known, path), codes.NOT]
        case Hedged(operand=operand, hedge=hedge):
            return [*_program(operand, known, path), codes.HEDGE - _HEDGE[hedge]]
        case And(operands=operands) | Or(operands=operands):
            operator = codes.AND if isinstance(expression, And) else codes.OR
            words = _program(operands[0], known, path)
            for operand in operands[1:]:
                words += [*_program(operand, known, path), operator]
            return words
        case _:
            assert_never(expression)


def _consequents(rule: Rule, known: Names, path: str) -> list[int]:
    for consequent in rule.consequents:
        if (consequent.variable, consequent.term) not in known:
            raise InvalidSystemError(f"no output term '{consequent.variable} is {consequent.term}'", path)
    return [known[consequent.variable, consequent.term] for consequent in rule.consequents]


@functools.lru_cache(maxsize=KEPT)
def _term_numbers(variables: tuple[Input | Output, ...]) -> Names:
    keys = [(variable.name, term.name) for variable in variables for term in variable.terms]
    return {key: number for number, key in enumerate(keys)}


@functools.lru_cache(maxsize=KEPT)
def _output_of_term(outputs: tuple[Output, ...]) -> Integers:
    return integers([number for number, variable in enumerate(outputs) for _ in variable.terms])
