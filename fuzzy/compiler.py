"""FuzzySystem -> Tables: every name becomes an index, and all that an inference can know beforehand is computed.

The parts of the tables depend on one variable or on the rules alone and are kept, so that painting a cell compiles
the rules and nothing else.
"""

from __future__ import annotations

import functools
import itertools
import math
from typing import NamedTuple, assert_never

import numpy as np
from numpy.typing import NDArray

from fuzzy import rules, shapes
from fuzzy.errors import InvalidSystemError
from fuzzy.kernels import exact, norms
from fuzzy.kernels import tables as codes
from fuzzy.kernels.tables import Tables
from fuzzy.system import And, Expression, FuzzySystem, Inference, Input, Is, Not, Or, Output, Rule, Sampling

_CACHED_VARIABLES = 256

_T_NORM = {"min": norms.MIN, "product": norms.PRODUCT}
_S_NORM = {"max": norms.MAX, "algebraic_sum": norms.ALGEBRAIC_SUM}
_AGGREGATION = {"max": norms.MAX, "sum": norms.SUM}
_NO_FIRE = {"default": codes.DEFAULT, "hold": codes.HOLD, "midpoint": codes.DEFAULT, "nan": codes.DEFAULT}
_SAMPLING = {"midpoints": codes.MIDPOINTS, "endpoints": codes.ENDPOINTS}


class _Geometry(NamedTuple):
    """What the defuzzification of one output needs to know of its sets; numbers of terms count from the output's."""

    shape: NDArray[np.int64]  # (n,)
    parameter: NDArray[np.float64]  # (n, 4)
    neighbour: NDArray[np.int64]  # (n,) next term to the right, -1 for none
    cuts: tuple[NDArray[np.float64], ...]  # n sets, then n overlaps, each (n_knots, 8)
    break_point: NDArray[np.float64]  # (n_breaks,)
    edge: NDArray[np.float64]  # (n, n_breaks - 1, 2)
    only_neighbours_overlap: bool
    piecewise_linear: bool


def compile_tables(system: FuzzySystem) -> Tables:
    """Compile a valid system.

    Args:
        system: A system that has passed :func:`fuzzy.validation.validate`.

    Returns:
        Read-only tables.

    Raises:
        InvalidSystemError: When a rule names a variable or a term that is not there.
    """
    inputs = [_encode_terms(variable) for variable in system.inputs]
    geometries = [_geometry(variable) for variable in system.outputs]
    output_terms = _term_numbers(system.outputs)
    input_terms = _term_numbers(system.inputs)
    grid, grid_origin = _grid(system, input_terms)
    listed = [_program(rule.antecedent, input_terms, f"rules.list[{n}]") for n, rule in enumerate(system.rules.list)]
    consequents = [_consequents(rule, output_terms, n) for n, rule in enumerate(rules.all_rules(system))]
    cuts = [cut for g in geometries for cut in g.cuts[: len(g.shape)]]
    cuts += [cut for g in geometries for cut in g.cuts[len(g.shape) :]]
    edges = [edge for g in geometries for edge in g.edge]
    tables = Tables(
        options=_options(system.inference),
        input_range=np.array([(v.low, v.high) for v in system.inputs], dtype=np.float64),
        input_rejects=np.array([v.out_of_range == "reject" for v in system.inputs], dtype=np.int64),
        input_start=_starts(len(v.terms) for v in system.inputs),
        input_shape=np.concatenate([shape for shape, _ in inputs]),
        input_parameter=np.concatenate([parameter for _, parameter in inputs]),
        grid=grid,
        grid_origin=grid_origin,
        program=np.array([word for program in listed for word in program], dtype=np.int64),
        program_start=_starts(len(program) for program in listed),
        weight=np.array([rule.weight for rule in system.rules.list], dtype=np.float64),
        consequent_start=_starts(len(terms) for terms in consequents),
        consequent_term=np.array([term for terms in consequents for term in terms], dtype=np.int64),
        output_range=np.array([(v.low, v.high) for v in system.outputs], dtype=np.float64),
        output_start=_starts(len(v.terms) for v in system.outputs),
        output_shape=np.concatenate([g.shape for g in geometries]),
        output_parameter=np.concatenate([g.parameter for g in geometries]),
        method=np.array([_method(system.inference, g) for g in geometries], dtype=np.int64),
        no_fire=np.array([_NO_FIRE[v.no_fire.policy] for v in system.outputs], dtype=np.int64),
        no_fire_value=np.array([no_fire_value(v) for v in system.outputs], dtype=np.float64),
        neighbour=_neighbours(geometries),
        cut_start=_starts(len(cut) for cut in cuts),
        cut=np.concatenate(cuts),
        break_start=_starts(len(g.break_point) for g in geometries),
        break_point=np.concatenate([g.break_point for g in geometries]),
        edge_start=_starts(len(edge) for edge in edges)[:-1].copy(),
        edge=np.concatenate(edges),
    )
    for array in tables:
        array.flags.writeable = False
    return tables


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


def _starts(lengths) -> NDArray[np.int64]:
    return np.cumsum([0, *lengths], dtype=np.int64)


def _options(inference: Inference) -> NDArray[np.int64]:
    options = np.zeros(6, dtype=np.int64)
    options[codes.CONJUNCTION] = _T_NORM[inference.conjunction]
    options[codes.DISJUNCTION] = _S_NORM[inference.disjunction]
    options[codes.IMPLICATION] = _T_NORM[inference.implication]
    options[codes.AGGREGATION] = _AGGREGATION[inference.aggregation]
    if isinstance(inference.resolution, Sampling):
        options[codes.SAMPLES] = inference.resolution.points
        options[codes.SAMPLING] = _SAMPLING[inference.resolution.rule]
    return options


def _method(inference: Inference, geometry: _Geometry) -> int:
    if isinstance(inference.resolution, Sampling):
        return codes.SAMPLED
    if inference.aggregation == "sum":
        return codes.SEPARATE
    if not geometry.piecewise_linear:
        return codes.QUADRATURE
    if inference.implication == "min" and geometry.only_neighbours_overlap:
        return codes.CLIPPED
    return codes.ENVELOPE


def _term_numbers(variables: tuple[Input, ...] | tuple[Output, ...]) -> dict[tuple[str, str], int]:
    keys = [(variable.name, term.name) for variable in variables for term in variable.terms]
    return {key: number for number, key in enumerate(keys)}


def _grid(system: FuzzySystem, input_terms: dict[tuple[str, str], int]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    table = system.rules.table
    if table is None:
        return np.empty((0, 0), dtype=np.int64), np.zeros(2, dtype=np.int64)
    by_name = {variable.name: variable for variable in system.inputs}
    origin = [input_terms[name, by_name[name].terms[0].name] for name in (table.rows, table.columns)]
    return np.array(rules.table_rule_indices(system), dtype=np.int64), np.array(origin, dtype=np.int64)


def _program(expression: Expression, terms: dict[tuple[str, str], int], path: str) -> list[int]:
    """Return an antecedent in postfix order."""
    match expression:
        case Is(variable=variable, term=term):
            if (variable, term) not in terms:
                raise InvalidSystemError(f"no input term '{variable} is {term}'", path)
            return [terms[variable, term]]
        case Not(operand=operand):
            return [*_program(operand, terms, path), codes.NOT]
        case And(operands=operands) | Or(operands=operands):
            operator = codes.AND if isinstance(expression, And) else codes.OR
            words = _program(operands[0], terms, path)
            for operand in operands[1:]:
                words += [*_program(operand, terms, path), operator]
            return words
        case _:
            assert_never(expression)


def _consequents(rule: Rule, terms: dict[tuple[str, str], int], number: int) -> list[int]:
    for consequent in rule.consequents:
        if (consequent.variable, consequent.term) not in terms:
            raise InvalidSystemError(f"no output term '{consequent.variable} is {consequent.term}'", f"rules[{number}]")
    return [terms[consequent.variable, consequent.term] for consequent in rule.consequents]


def _neighbours(geometries: list[_Geometry]) -> NDArray[np.int64]:
    first = 0
    parts = []
    for geometry in geometries:
        parts.append(np.where(geometry.neighbour >= 0, geometry.neighbour + first, -1))
        first += len(geometry.shape)
    return np.concatenate(parts)


@functools.lru_cache(maxsize=_CACHED_VARIABLES)
def _encode_terms(variable: Input | Output) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    encoded = [shapes.encode(term.shape) for term in variable.terms]
    return np.array([code for code, _ in encoded], dtype=np.int64), np.array(
        [four for _, four in encoded], dtype=np.float64
    )


@functools.lru_cache(maxsize=_CACHED_VARIABLES)
def _geometry(output: Output) -> _Geometry:
    """Return what defuzzification needs of an output's sets, as they lie within its range."""
    shape, parameter = _encode_terms(output)
    linear = [isinstance(term.shape, shapes.PIECEWISE_LINEAR) for term in output.terms]
    points = {output.low, output.high}
    for term in output.terms:
        points.update(shapes.break_points(term.shape))
    breaks = np.array(sorted(u for u in points if output.low <= u <= output.high), dtype=np.float64)
    edge = np.array([_edges(p, breaks) if is_linear else np.zeros((len(breaks) - 1, 2))
                     for p, is_linear in zip(parameter, linear, strict=True)])  # fmt: skip
    order, neighbour = _order(parameter)
    overlaps_only_neighbours = all(linear) and _only_neighbours_overlap(parameter[order], output)
    middle = 0.5 * (output.low + output.high)
    empty = _cut(breaks - middle, np.zeros((len(breaks) - 1, 2)))
    cuts = [_cut(breaks - middle, edges) for edges in edge]
    for k in range(len(shape)):
        if overlaps_only_neighbours and neighbour[k] >= 0:
            cuts.append(_overlap_cut(breaks - middle, edge[k], edge[neighbour[k]]))
        else:
            cuts.append(empty)
    return _Geometry(shape, parameter, neighbour, tuple(cuts), breaks, edge, overlaps_only_neighbours, all(linear))


def _edges(parameter: NDArray[np.float64], breaks: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return a trapezoid's degrees just inside both ends of every interval between break points, (n, 2).

    The degrees at the ends themselves will not do: at a vertical side they belong to one of the intervals only.
    """
    a, b, c, d = (float(value) for value in parameter)
    edges = np.zeros((len(breaks) - 1, 2))
    for i, (left, right) in enumerate(itertools.pairwise(breaks)):
        if left >= b and right <= c:
            edges[i] = 1.0
        elif left >= a and right <= b:  # a < b, since the interval is not empty
            edges[i] = (1.0, 1.0) if math.isinf(a) else ((left - a) / (b - a), (right - a) / (b - a))
        elif left >= c and right <= d:
            edges[i] = (1.0, 1.0) if math.isinf(d) else ((d - left) / (d - c), (d - right) / (d - c))
    return edges


def _order(parameter: NDArray[np.float64]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the terms from left to right, and for each term its right-hand neighbour or -1."""
    order = np.lexsort((parameter[:, 3], parameter[:, 2], parameter[:, 1], parameter[:, 0]))
    neighbour = np.full(len(order), -1, dtype=np.int64)
    neighbour[order[:-1]] = order[1:]
    return order, neighbour


def _only_neighbours_overlap(parameter: NDArray[np.float64], output: Output) -> bool:
    """Whether, of trapezoids from left to right, no set reaches beyond the beginning of the one after the next."""
    left = np.maximum(parameter[:, 0], output.low)
    right = np.minimum(parameter[:, 3], output.high)
    reach = np.maximum.accumulate(right)
    return bool(np.all(reach[:-2] <= left[2:])) if len(left) > 2 else True


def _cut(breaks: NDArray[np.float64], edges: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the clipping polynomials of a set of linear pieces, see ``exact.cut_polynomials``."""
    knots = np.unique(np.concatenate([[0.0], edges.ravel()]))
    cut = np.empty((len(knots), 8))
    low, high = np.ascontiguousarray(edges.T)
    exact.cut_polynomials(breaks[:-1], breaks[1:], low, high, knots, cut)
    return cut


def _overlap_cut(
    breaks: NDArray[np.float64], first: NDArray[np.float64], second: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the clipping polynomials of the intersection of two sets, which bends also where they cross."""
    difference = first - second
    crossings = [breaks[0]]
    pieces = []
    for i in range(len(breaks) - 1):
        (a, b), left, right = difference[i], breaks[i], breaks[i + 1]
        at = [0.0, a / (a - b), 1.0] if a * b < 0 else [0.0, 1.0]
        for start, end in itertools.pairwise(at):
            ends = [
                min(edges[i, 0] + t * (edges[i, 1] - edges[i, 0]) for edges in (first, second)) for t in (start, end)
            ]
            crossings.append(left + end * (right - left))
            pieces.append(ends)
    return _cut(np.array(crossings), np.array(pieces))
