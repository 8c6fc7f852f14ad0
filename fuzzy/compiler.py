"""FuzzySystem -> Tables: every name becomes an index, and all that an inference can know beforehand is computed.

The inputs' tables depend on the inputs alone, the outputs' on the outputs and the operators; they are kept, so that
painting a cell compiles the rules and nothing else.
"""

from __future__ import annotations

import functools
import itertools
import math
from collections.abc import Iterable, Sequence
from typing import Any, NamedTuple, assert_never

import numpy as np

from fuzzy import geometry, shapes
from fuzzy.errors import InvalidSystemError
from fuzzy.kernels import membership, norms
from fuzzy.kernels import tables as codes
from fuzzy.kernels.address import entries
from fuzzy.kernels.tables import InputTables, Integers, Numbers, OutputTables, RuleTables, Tables
from fuzzy.system import (
    Aggregation,
    And,
    Expression,
    FuzzySystem,
    Inference,
    Input,
    Is,
    Not,
    Or,
    Output,
    Rule,
    Sampling,
)

_KEPT = 64
"""Variables, operators and lists of rules whose tables are kept."""

_T_NORM = {
    "min": norms.MIN,
    "product": norms.PRODUCT,
    "bounded_difference": norms.BOUNDED_DIFFERENCE,
    "drastic_product": norms.DRASTIC_PRODUCT,
    "einstein_product": norms.EINSTEIN_PRODUCT,
    "hamacher_product": norms.HAMACHER_PRODUCT,
    "nilpotent_minimum": norms.NILPOTENT_MINIMUM,
}
_S_NORM = {
    "max": norms.MAX,
    "algebraic_sum": norms.ALGEBRAIC_SUM,
    "bounded_sum": norms.BOUNDED_SUM,
    "drastic_sum": norms.DRASTIC_SUM,
    "einstein_sum": norms.EINSTEIN_SUM,
    "hamacher_sum": norms.HAMACHER_SUM,
    "nilpotent_maximum": norms.NILPOTENT_MAXIMUM,
}
_AGGREGATION = {"max": norms.MAX, "sum": norms.SUM}
_NO_FIRE = {"default": codes.DEFAULT, "hold": codes.HOLD, "midpoint": codes.DEFAULT, "nan": codes.DEFAULT}
_SAMPLING = {"midpoints": codes.MIDPOINTS, "endpoints": codes.ENDPOINTS}

Names = dict[tuple[str, str], int]


def compile_tables(system: FuzzySystem) -> Tables:
    """Compile a valid system.

    Args:
        system: A system that has passed :func:`fuzzy.validation.validate`.

    Returns:
        Read-only tables.

    Raises:
        InvalidSystemError: When a rule names a variable or a term that is not there.
    """
    inputs, input_entries = _compile_inputs(system.inputs)
    outputs, output_entries = _compile_outputs(system.outputs, system.inference)
    rule_tables, rule_entries = _compile_rules(system)
    listed = np.concatenate([input_entries, rule_entries, output_entries])
    listed.flags.writeable = False
    return Tables(inputs, rule_tables, outputs, listed)


def no_fire_value(output: Output) -> float:
    """Return what an output is when no rule fires, and what it starts with under the hold policy."""
    match output.no_fire.policy:
        case "default":
            return output.no_fire.value
        case "hold" | "midpoint":
            return 0.5 * (output.low + output.high)
        case "nan":
            return math.nan
        case _:
            assert_never(output.no_fire.policy)


@functools.lru_cache(maxsize=_KEPT)
def _compile_inputs(inputs: tuple[Input, ...]) -> tuple[InputTables, Integers]:
    compiled = [_compile_input(variable) for variable in inputs]
    first = _starts(len(variable.terms) for variable in inputs)
    pieces = [
        (int(first[i]) + term, shape, parameter)
        for i, variable in enumerate(compiled)
        for cell in variable.cells
        for term, shape, parameter in cell
    ]
    tables = InputTables(
        range=_numbers([(variable.low, variable.high) for variable in inputs], 2),
        term_start=first,
        knot_start=_starts(len(variable.knots) for variable in compiled),
        knot=_numbers([knot for variable in compiled for knot in variable.knots]),
        cell_start=_starts(len(variable.cells) for variable in compiled)[:-1].copy(),
        piece_start=_starts(len(cell) for variable in compiled for cell in variable.cells),
        piece_term=_integers([term for term, _, _ in pieces]),
        piece_shape=_integers([shape for _, shape, _ in pieces]),
        piece=_numbers([parameter for _, _, parameter in pieces], 4),
    )
    return tables, entries(_frozen(tables))


class _Input(NamedTuple):
    knots: list[float]
    cells: list[list[tuple[int, int, tuple[float, ...]]]]  # term, membership code, parameters of each piece


@functools.lru_cache(maxsize=_KEPT)
def _compile_input(variable: Input) -> _Input:
    sets = [shapes.segments(term.shape) for term in variable.terms]
    points = geometry.knots(sets, variable.low, variable.high)
    cells: list[list[tuple[int, int, tuple[float, ...]]]] = [[] for _ in range(2 * len(points) + 1)]
    for number, (term, segments) in enumerate(zip(variable.terms, sets, strict=True)):
        if segments:
            for cell, line in geometry.cells(segments, points):
                cells[cell].append((number, membership.LINE, (*line, 0.0)))
        else:
            for cell in cells:
                cell.append((number, *shapes.encode(term.shape)))
    return _Input(points, cells)


class _Output(NamedTuple):
    """What the defuzzification of one output needs to know; numbers of terms count from the output's."""

    knots: list[float]
    sides: list[list[tuple[int, float, float]]]  # for each interval: term and degrees at both ends
    neighbours: list[int]
    cuts: list[list[geometry.Polynomial]]
    overlap_cuts: list[list[geometry.Polynomial]]
    is_linear: bool
    only_neighbours_overlap: bool


@functools.lru_cache(maxsize=_KEPT)
def _compile_outputs(outputs: tuple[Output, ...], inference: Inference) -> tuple[OutputTables, Integers]:
    compiled = [_compile_output(variable) for variable in outputs]
    first = _starts(len(variable.terms) for variable in outputs)
    encoded = [shapes.encode(term.shape) for variable in outputs for term in variable.terms]
    cuts = [cut for variable in compiled for cut in variable.cuts]
    cuts += [cut for variable in compiled for cut in variable.overlap_cuts]
    neighbours = [
        int(first[i]) + neighbour if neighbour >= 0 else -1
        for i, variable in enumerate(compiled)
        for neighbour in variable.neighbours
    ]
    # Intervals are numbered by their left knot: the one behind an output's last knot is empty.
    sides = [
        [(int(first[i]) + term, left, right) for term, left, right in interval]
        for i, variable in enumerate(compiled)
        for interval in [*variable.sides, []]
    ]
    resolution = inference.resolution
    sampling = (resolution.points, _SAMPLING[resolution.rule]) if isinstance(resolution, Sampling) else (0, 0)
    tables = OutputTables(
        range=_numbers([(variable.low, variable.high) for variable in outputs], 2),
        term_start=first,
        shape=_integers([code for code, _ in encoded]),
        parameter=_numbers([parameter for _, parameter in encoded], 4),
        implication=_integers([_T_NORM[inference.implication]]),
        aggregation=_integers([_AGGREGATION[_summed(inference)]]),
        sampling=_integers(sampling),
        method=_integers([_method(inference, variable) for variable in compiled]),
        no_fire=_integers([_NO_FIRE[variable.no_fire.policy] for variable in outputs]),
        no_fire_value=_numbers([no_fire_value(variable) for variable in outputs]),
        neighbour=_integers(neighbours),
        cut_start=_starts(len(cut) for cut in cuts),
        cut=_numbers([row for cut in cuts for row in cut], 8),
        knot_start=_starts(len(variable.knots) for variable in compiled),
        knot=_numbers([knot for variable in compiled for knot in variable.knots]),
        side_start=_starts(len(interval) for interval in sides),
        side_term=_integers([term for interval in sides for term, _, _ in interval]),
        side=_numbers([(left, right) for interval in sides for _, left, right in interval], 2),
    )
    return tables, entries(_frozen(tables))


@functools.lru_cache(maxsize=_KEPT)
def _compile_output(output: Output) -> _Output:
    low, high = output.low, output.high
    middle = 0.5 * (low + high)
    sets = [shapes.segments(term.shape) for term in output.terms]
    points = geometry.knots(sets, low, high)
    sides: list[list[tuple[int, float, float]]] = [[] for _ in points[1:]]
    for term, segments in enumerate(sets):
        for interval, segment in geometry.sides(segments, points):
            left, right = points[interval], points[interval + 1]
            sides[interval].append((term, geometry.degree(segment, left), geometry.degree(segment, right)))
    inside = [geometry.clipped_to(segments, low, high) for segments in sets]
    neighbours = [-1] * len(sets)
    overlap_cuts: list[list[geometry.Polynomial]] = [[] for _ in sets]
    is_linear = all(sets)
    overlaps_neighbours = is_linear and all(len(interval) <= 2 for interval in sides)
    if overlaps_neighbours:
        # Each set overlaps one to its right at most: otherwise there is no order of neighbours.
        pairs = {(interval[0][0], interval[1][0]) for interval in sides if len(interval) == 2}
        for first, second in pairs:
            left, right = sorted((first, second), key=lambda term: (inside[term][0].left, inside[term][-1].right))
            if neighbours[left] >= 0:
                overlaps_neighbours = False
                break
            neighbours[left] = right
            common = geometry.intersection(sets[left], sets[right], low, high)
            overlap_cuts[left] = geometry.cut_polynomials(common, middle)
    cuts = [geometry.cut_polynomials(segments, middle) for segments in inside]
    return _Output(points, sides, neighbours, cuts, overlap_cuts, is_linear, overlaps_neighbours)


def _summed(inference: Inference) -> Aggregation:
    """Return how the sets are aggregated: the center of sums is the centroid of their sum, whatever is chosen."""
    return "sum" if inference.defuzzifier == "center_of_sums" else inference.aggregation


def _method(inference: Inference, output: _Output) -> int:
    if isinstance(inference.resolution, Sampling):
        return codes.SAMPLED
    if not output.is_linear:
        return codes.QUADRATURE
    if _summed(inference) == "sum":
        return codes.SEPARATE
    if inference.implication == "min" and output.only_neighbours_overlap:
        return codes.CLIPPED
    return codes.ENVELOPE


def _compile_rules(system: FuzzySystem) -> tuple[RuleTables, Integers]:
    """Return the rules' tables and their entries. Which term a cell names is all that painting it changes."""
    table = system.rules.table
    numbers = _term_numbers(system.outputs)
    terms: list[int] = []
    filled: tuple[bool, ...] = ()
    if table is not None:
        cells = [cell for row in table.cells for cell in row]
        filled = tuple(cell is not None for cell in cells)
        try:
            terms = [numbers[table.output, cell] for cell in cells if cell is not None]
        except KeyError as error:
            raise InvalidSystemError(f"no output term '{' is '.join(error.args[0])}'", "rules.table") from None
    for number, rule in enumerate(system.rules.list):
        terms += _consequents(rule, numbers, f"rules.list[{number}]")
    axes = None if table is None else (table.rows, table.columns)
    inference = system.inference
    operators = (_T_NORM[inference.conjunction], _S_NORM[inference.disjunction])
    frame, listed = _compile_frame(axes, filled, system.rules.list, system.inputs, operators)
    consequent_term = _integers(terms)
    consequent_output = _output_of_term(system.outputs)[consequent_term]
    ends = (consequent_term, consequent_output, _starts(np.bincount(consequent_output, minlength=len(system.outputs))))
    tables = RuleTables._make((*frame, *ends))
    return tables, np.concatenate([listed, entries(_frozen(ends))])


@functools.lru_cache(maxsize=_KEPT)
def _compile_frame(
    axes: tuple[str, str] | None,
    filled: tuple[bool, ...],
    listed: tuple[Rule, ...],
    inputs: tuple[Input, ...],
    operators: tuple[int, int],
) -> tuple[tuple[np.ndarray, ...], Integers]:
    """Return what does not depend on the rules' consequents: the first fields of ``RuleTables`` and their entries.

    Args:
        axes: Inputs of the table's rows and columns.
        filled: Whether each cell of the table holds a rule, row by row.
        listed: The listed rules.
        inputs: All inputs.
        operators: Codes of AND and OR.
    """
    places = {variable.name: place for place, variable in enumerate(inputs)}
    grid_input = (0, 0) if axes is None else (places[axes[0]], places[axes[1]])
    n_columns = len(inputs[grid_input[1]].terms)
    numbered = np.where(filled, np.cumsum(filled) - 1, -1) if axes is not None else np.empty(0)
    counts = [1] * sum(filled) + [len(rule.consequents) for rule in listed]
    frame = (
        _integers(operators),
        _integers(numbered).reshape(-1, n_columns),
        _integers(grid_input),
        *_compile_list(listed, inputs),
        _starts(counts),
    )
    return frame, entries(_frozen(frame))


def _compile_list(listed: tuple[Rule, ...], inputs: tuple[Input, ...]) -> tuple[Integers, Integers, Numbers]:
    """Return the antecedents of the listed rules, where each begins, and their weights."""
    numbers = _term_numbers(inputs)
    programs = [_program(rule.antecedent, numbers, f"rules.list[{number}]") for number, rule in enumerate(listed)]
    return (
        _integers([word for program in programs for word in program]),
        _starts(len(program) for program in programs),
        _numbers([rule.weight for rule in listed]),
    )


def _program(expression: Expression, numbers: Names, path: str) -> list[int]:
    """Return an antecedent in postfix order."""
    match expression:
        case Is(variable=variable, term=term):
            if (variable, term) not in numbers:
                raise InvalidSystemError(f"no input term '{variable} is {term}'", path)
            return [numbers[variable, term]]
        case Not(operand=operand):
            return [*_program(operand, numbers, path), codes.NOT]
        case And(operands=operands) | Or(operands=operands):
            operator = codes.AND if isinstance(expression, And) else codes.OR
            words = _program(operands[0], numbers, path)
            for operand in operands[1:]:
                words += [*_program(operand, numbers, path), operator]
            return words
        case _:
            assert_never(expression)


def _consequents(rule: Rule, numbers: Names, path: str) -> list[int]:
    for consequent in rule.consequents:
        if (consequent.variable, consequent.term) not in numbers:
            raise InvalidSystemError(f"no output term '{consequent.variable} is {consequent.term}'", path)
    return [numbers[consequent.variable, consequent.term] for consequent in rule.consequents]


@functools.lru_cache(maxsize=_KEPT)
def _term_numbers(variables: tuple[Input, ...] | tuple[Output, ...]) -> Names:
    keys = [(variable.name, term.name) for variable in variables for term in variable.terms]
    return {key: number for number, key in enumerate(keys)}


@functools.lru_cache(maxsize=_KEPT)
def _output_of_term(outputs: tuple[Output, ...]) -> Integers:
    return _integers([number for number, variable in enumerate(outputs) for _ in variable.terms])


def _integers(values: Any) -> Integers:
    return np.array(values, dtype=np.int64)


def _numbers(values: Sequence[Any], columns: int = 0) -> Numbers:
    array = np.array(values, dtype=np.float64)
    return array.reshape(-1, columns) if columns else array


def _starts(lengths: Iterable[int]) -> Integers:
    return _integers([0, *itertools.accumulate(lengths)])


def _frozen(arrays: tuple[np.ndarray, ...]) -> tuple[np.ndarray, ...]:
    for array in arrays:
        array.flags.writeable = False
    return arrays
