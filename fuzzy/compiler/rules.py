"""Rules -> RuleTables: the grid, the antecedents as programs, the consequents."""

from __future__ import annotations

import functools
from typing import NamedTuple, assert_never

import numpy as np

from fuzzy.compiler.arrays import KEPT, frozen, integers, numbers, starts
from fuzzy.errors import InvalidSystemError
from fuzzy.identity import ByIdentity, remembered
from fuzzy.kernels import codes, hedges, norms
from fuzzy.kernels.address import entries
from fuzzy.kernels.tables import Integers, RuleTables
from fuzzy.limits import MAX_RULES
from fuzzy.system import And, Expression, FuzzySystem, Hedged, Input, Is, Not, Or, Output, Rule, RuleTable

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

_NO_RULE = -1


class _Antecedent(NamedTuple):
    """A listed rule without what it concludes."""

    program: tuple[int, ...]  # in postfix order
    weight: float
    n_consequents: int


class _Listed(NamedTuple):
    """A listed rule."""

    antecedent: _Antecedent
    terms: tuple[int, ...]  # the consequents


class _Numbering(NamedTuple):
    """The numbers of all inputs and terms of a system."""

    places: dict[str, int]  # of the inputs
    n_inputs: int  # how many terms they have
    antecedent: Names  # the inputs' terms, and behind them the outputs'
    consequent: dict[str, dict[str | None, int]]  # the terms of each output, and what stands for none of them
    output_of_term: Integers
    n_outputs: int
    listed: ByIdentity[_Listed]  # rules that have been compiled with these numbers


class _Table(NamedTuple):
    """A rule table without what its cells name."""

    axes: tuple[int, int]  # inputs of the rows and of the columns
    shape: tuple[int, int]
    filled: tuple[bool, ...]  # whether each cell holds a rule, row by row; empty if all do
    n_cells: int  # that are filled


class _Frame(NamedTuple):
    """What does not depend on the terms that rules conclude: the other fields of ``RuleTables``."""

    before: tuple[np.ndarray, ...]
    behind: tuple[np.ndarray, ...]
    entries: Integers  # of all fields; that of consequent_term lacks the address


CONSEQUENTS = RuleTables._fields.index("consequent_term")
"""Which of the rules' entries in a directory is without an address."""


def compile_rules(system: FuzzySystem) -> tuple[RuleTables, Integers]:
    """Return the rules' tables and their entries in a directory, as if ``consequent_term`` stood at address 0.

    Raises:
        InvalidSystemError: When a rule names a variable or a term that is not there.
    """
    numbering = _number(system.inputs, system.outputs)
    grid, terms = _compile_table(system.rules.table, numbering)
    listed = _compile_list(system.rules.list, numbering)
    for rule in listed:
        terms += rule.terms
    concluded = integers(terms)
    frame = _compile_frame(
        grid,
        tuple([rule.antecedent for rule in listed]),
        numbering.output_of_term[concluded].tobytes() if numbering.n_outputs > 1 else b"",
        numbering.n_outputs,
        (T_NORM[system.inference.conjunction], S_NORM[system.inference.disjunction]),
    )
    concluded.setflags(write=False)
    return RuleTables._make((*frame.before, concluded, *frame.behind)), frame.entries


@remembered(KEPT)
def _number(inputs: tuple[Input, ...], outputs: tuple[Output, ...]) -> _Numbering:
    consequent: dict[str, dict[str | None, int]] = {output.name: {None: _NO_RULE} for output in outputs}
    for number, (output, term) in enumerate(_term_keys(outputs)):
        consequent[output][term] = number
    return _Numbering(
        {variable.name: place for place, variable in enumerate(inputs)},
        sum(len(variable.terms) for variable in inputs),
        {key: number for number, key in enumerate(_term_keys((*inputs, *outputs)))},
        consequent,
        integers([number for number, variable in enumerate(outputs) for _ in variable.terms]),
        len(outputs),
        ByIdentity(MAX_RULES),
    )


def _term_keys(variables: tuple[Input | Output, ...]) -> list[tuple[str, str]]:
    return [(variable.name, term.name) for variable in variables for term in variable.terms]


def _compile_table(table: RuleTable | None, numbering: _Numbering) -> tuple[_Table | None, list[int]]:
    """Return a table and the output terms that its rules conclude, row by row."""
    if table is None:
        return None, []
    known = numbering.consequent.get(table.output, {})
    try:
        terms = [known[cell] for row in table.cells for cell in row]
    except KeyError as error:
        raise InvalidSystemError(f"no output term '{table.output} is {error.args[0]}'", "rules.table") from None
    filled: tuple[bool, ...] = ()
    if _NO_RULE in terms:
        filled = tuple([term != _NO_RULE for term in terms])
        terms = [term for term in terms if term != _NO_RULE]
    axes = numbering.places[table.rows], numbering.places[table.columns]
    return _Table(axes, (len(table.cells), len(table.cells[0])), filled, len(terms)), terms


@functools.lru_cache(maxsize=KEPT)
def _compile_frame(
    grid: _Table | None,
    listed: tuple[_Antecedent, ...],
    outputs: bytes,
    n_outputs: int,
    operators: tuple[int, int],
) -> _Frame:
    """Return what does not depend on the terms that rules conclude.

    Args:
        grid: The table.
        listed: The listed rules.
        outputs: The output of each consequent, as an array's bytes; empty if there is only one output.
        n_outputs: How many there are.
        operators: Codes of AND and OR.
    """
    cells = np.empty((0, 1), dtype=np.int64)
    axes, n_cells = (0, 0), 0
    if grid is not None:
        axes, n_cells = grid.axes, grid.n_cells
        filled = np.array(grid.filled) if grid.filled else np.ones(grid.shape[0] * grid.shape[1], dtype=bool)
        cells = integers(np.where(filled, np.cumsum(filled) - 1, -1)).reshape(grid.shape)
    counts = [1] * n_cells + [rule.n_consequents for rule in listed]
    output_of = np.frombuffer(outputs, dtype=np.int64).copy() if outputs else np.zeros(sum(counts), dtype=np.int64)
    before = (
        integers(operators),
        cells,
        integers(axes),
        integers([word for rule in listed for word in rule.program]),
        starts(len(rule.program) for rule in listed),
        numbers([rule.weight for rule in listed]),
        starts(counts),
    )
    behind = (output_of, starts(np.bincount(output_of, minlength=n_outputs)))
    listed_entries = entries(frozen((*before, output_of, *behind)))
    listed_entries[CONSEQUENTS, 0] = 0
    return _Frame(before, behind, listed_entries)


def _compile_list(listed: tuple[Rule, ...], numbering: _Numbering) -> list[_Listed]:
    if not listed:
        return []
    known = numbering.listed.get_each(listed)
    return [
        found or _compile_rule(rule, numbering, f"rules.list[{number}]")
        for number, (rule, found) in enumerate(zip(listed, known, strict=True))
    ]


def _compile_rule(rule: Rule, numbering: _Numbering, path: str) -> _Listed:
    known = numbering.consequent
    for consequent in rule.consequents:
        if consequent.term not in known.get(consequent.variable, {}):
            raise InvalidSystemError(f"no output term '{consequent.variable} is {consequent.term}'", path)
    program = _joined_by_all(_program(rule.antecedent, numbering.antecedent, path), numbering.n_inputs)
    terms = tuple(known[consequent.variable][consequent.term] for consequent in rule.consequents)
    compiled = _Listed(_Antecedent(tuple(program), rule.weight, len(terms)), terms)
    numbering.listed.put(compiled, rule)
    return compiled


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
