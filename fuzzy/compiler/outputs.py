"""Outputs -> OutputTables: the sets, their polynomials and samples, and the method of each output."""

from __future__ import annotations

import math
from typing import NamedTuple, assert_never

import numpy as np

from fuzzy import geometry, sets
from fuzzy.compiler import methods
from fuzzy.compiler.arrays import frozen, integers, numbers, starts
from fuzzy.identity import remembered
from fuzzy.kernels import codes
from fuzzy.kernels.address import entries
from fuzzy.kernels.tables import Integers, Numbers, OutputTables
from fuzzy.shapes import Linear
from fuzzy.system import WEIGHTED_VALUES, Inference, Output, Sampling, Term

_KEPT = 32
"""Outputs whose tables are kept: samples make them large."""

_NO_FIRE = {"default": codes.DEFAULT, "hold": codes.HOLD, "midpoint": codes.DEFAULT, "nan": codes.DEFAULT}


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


class _Output(NamedTuple):
    """What the defuzzification of one output needs to know; numbers of terms count from the output's."""

    knots: list[float]
    sides: list[list[tuple[int, float, float]]]  # for each interval: term and degrees at both ends
    neighbours: list[int]
    cuts: list[list[geometry.Polynomial]]
    overlap_cuts: list[list[geometry.Polynomial]]
    encoded: list[sets.Encoded]
    traits: methods.Traits


@remembered(_KEPT)
def compile_outputs(outputs: tuple[Output, ...], inference: Inference) -> tuple[OutputTables, Integers]:
    """Return the outputs' tables and their entries in a directory."""
    compiled = [_compile_output(variable) for variable in outputs]
    first = starts(len(variable.terms) for variable in outputs)
    encoded = [entry for variable in compiled for entry in variable.encoded]
    first_value = starts(len(entry.values) for entry in encoded)
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
    samples = [
        _samples(variable, inference.resolution, tuple(known.knots))
        for variable, known in zip(outputs, compiled, strict=True)
    ]
    tables = OutputTables(
        range=numbers([(variable.low, variable.high) for variable in outputs], 2),
        term_start=first,
        shape=integers([entry.code for entry in encoded]),
        parameter=numbers([_placed(entry, int(first_value[k])) for k, entry in enumerate(encoded)], codes.WIDTH),
        value=numbers([value for entry in encoded for value in entry.values]),
        peak=numbers([_value(term, variable, inference) for variable in outputs for term in variable.terms]),
        implication=integers([methods.IMPLICATION[inference.implication]]),
        aggregation=integers([methods.AGGREGATION[methods.aggregation(inference)]]),
        grouping=integers([methods.grouping(inference)]),
        maximum=integers([methods.MAXIMUM.get(inference.defuzzifier, codes.MEAN)]),
        sample_start=starts(len(places) for places in samples),
        sample=np.ascontiguousarray(np.concatenate(samples)),
        method=integers([methods.method(inference, variable.traits) for variable in compiled]),
        no_fire=integers([_NO_FIRE[variable.no_fire.policy] for variable in outputs]),
        no_fire_value=numbers([no_fire_value(variable) for variable in outputs]),
        neighbour=integers(neighbours),
        cut_start=starts(len(cut) for cut in cuts),
        cut=numbers([row for cut in cuts for row in cut], 8),
        knot_start=starts(len(variable.knots) for variable in compiled),
        knot=numbers([knot for variable in compiled for knot in variable.knots]),
        side_start=starts(len(interval) for interval in sides),
        side_term=integers([term for interval in sides for term, _, _ in interval]),
        side=numbers([(left, right) for interval in sides for _, left, right in interval], 2),
    )
    return tables, entries(frozen(tables))


@remembered(_KEPT)
def _compile_output(output: Output) -> _Output:
    low, high = output.low, output.high
    middle = 0.5 * (low + high)
    segments = [sets.segments(term) for term in output.terms]
    points = geometry.knots(segments, low, high)
    sides: list[list[tuple[int, float, float]]] = [[] for _ in points[1:]]
    for term, parts in enumerate(segments):
        for interval, segment in geometry.sides(parts, points):
            left, right = points[interval], points[interval + 1]
            sides[interval].append((term, geometry.degree(segment, left), geometry.degree(segment, right)))
    inside = [geometry.clipped_to(parts, low, high) for parts in segments]
    neighbours = [-1] * len(segments)
    overlap_cuts: list[list[geometry.Polynomial]] = [[] for _ in segments]
    is_linear = all(segments)
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
            common = geometry.intersection(segments[left], segments[right], low, high)
            overlap_cuts[left] = geometry.cut_polynomials(common, middle)
    return _Output(
        points,
        sides,
        neighbours,
        [geometry.cut_polynomials(parts, middle) for parts in inside],
        overlap_cuts,
        [sets.encode(term) for term in output.terms],
        methods.Traits(is_linear, all(map(sets.is_singleton, output.terms)), overlaps_neighbours),
    )


def _placed(entry: sets.Encoded, first_value: int) -> tuple[float, ...]:
    """Return a set's parameters, its values counted among those of all sets."""
    return (float(first_value), *entry.parameters[1:]) if entry.values else entry.parameters


def _value(term: Term, output: Output, inference: Inference) -> float:
    """Return what a term says the output is, where it says so by itself; otherwise NaN, see ``kernels.weighted``."""
    if isinstance(term.shape, Linear):
        return math.nan
    if sets.is_singleton(term):
        return sets.break_points(term)[0]
    if inference.defuzzifier in WEIGHTED_VALUES:
        return math.nan
    if inference.defuzzifier != "height":
        return 0.0
    left, right = sets.core(term, output.low, output.high)
    return 0.5 * (left + right)


def _samples(output: Output, resolution: object, knots: tuple[float, ...]) -> Numbers:
    """Return (n, 2) places and weights of an output's samples; none where the resolution is exact."""
    if not isinstance(resolution, Sampling):
        return np.empty((0, 2))
    low, high, n = output.low, output.high, resolution.points
    weight = np.ones(n)
    match resolution.rule:
        case "midpoints":
            place = low + (np.arange(n) + 0.5) * (high - low) / n
        case "endpoints" | "polygon":
            place = low + np.arange(n) * (high - low) / (n - 1)
        case "trapezoid":
            place = low + np.arange(n) * (high - low) / (n - 1)
            weight[[0, -1]] = 0.5
        case "left":
            place = np.cumsum([low, *np.full(n - 1, (high - low) / n)])
        case "left_with_break_points":
            bends = (point for term in output.terms for point in sets.break_points(term) if low <= point <= high)
            place = np.unique([*_left_ends_in_single_precision(low, high, n), *knots[1:-1], *bends])
            weight = np.ones(place.size)
        case _:
            assert_never(resolution.rule)
    return np.column_stack([place, weight]).astype(np.float64)


def _left_ends_in_single_precision(low: float, high: float, n: int) -> Numbers:
    """Return the left ends of n intervals as JFML adds them up: rounding moves them off the break points.

    The sum may need one step more than n to reach the end.
    """
    step = (np.float32(high) - np.float32(low)) / np.float32(n)
    steps = np.full(n + n // 8, step, dtype=np.float32)
    places = np.cumsum(np.concatenate([[np.float32(low)], steps]), dtype=np.float32).astype(np.float64)
    return places[places < high]
