"""Inputs -> InputTables: the cells of each universe, and the lines within them."""

from __future__ import annotations

from typing import NamedTuple

from fuzzy import geometry, sets
from fuzzy.compiler.arrays import KEPT, frozen, integers, numbers, starts
from fuzzy.identity import remembered
from fuzzy.kernels import codes
from fuzzy.kernels.address import entries
from fuzzy.kernels.tables import InputTables, Integers
from fuzzy.system import Input

_PADDING = (0.0,) * (codes.WIDTH - 3)


@remembered(KEPT)
def compile_inputs(inputs: tuple[Input, ...]) -> tuple[InputTables, Integers]:
    """Return the inputs' tables and their entries in a directory."""
    compiled = [_compile_input(variable) for variable in inputs]
    first = starts(len(variable.terms) for variable in inputs)
    pieces = [
        (int(first[i]) + term, shape, parameter)
        for i, variable in enumerate(compiled)
        for cell in variable.cells
        for term, shape, parameter in cell
    ]
    tables = InputTables(
        range=numbers([(variable.low, variable.high) for variable in inputs], 2),
        term_start=first,
        knot_start=starts(len(variable.knots) for variable in compiled),
        knot=numbers([knot for variable in compiled for knot in variable.knots]),
        cell_start=starts(len(variable.cells) for variable in compiled)[:-1].copy(),
        piece_start=starts(len(cell) for variable in compiled for cell in variable.cells),
        piece_term=integers([term for term, _, _ in pieces]),
        piece_shape=integers([shape for _, shape, _ in pieces]),
        piece=numbers([parameter for _, _, parameter in pieces], codes.WIDTH),
        rejects=integers([variable.out_of_range == "reject" for variable in inputs]),
    )
    return tables, entries(frozen(tables))


class _Input(NamedTuple):
    knots: list[float]
    cells: list[list[tuple[int, int, tuple[float, ...]]]]  # term, membership code, parameters of each piece


@remembered(KEPT)
def _compile_input(variable: Input) -> _Input:
    segments = [sets.segments(term) for term in variable.terms]
    points = geometry.knots(segments, variable.low, variable.high)
    cells: list[list[tuple[int, int, tuple[float, ...]]]] = [[] for _ in range(2 * len(points) + 1)]
    for number, (term, parts) in enumerate(zip(variable.terms, segments, strict=True)):
        if parts:
            for cell, line in geometry.cells(parts, points, is_open=term.complement):
                cells[cell].append((number, codes.LINE, (*line, *_PADDING)))
        else:
            for cell in cells:
                cell.append((number, *sets.encode(term)[:2]))
    return _Input(points, cells)
