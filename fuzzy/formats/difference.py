"""How far two systems differ, such as one and what a format could say of it."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from fuzzy.inference import compile_system
from fuzzy.system import FuzzySystem

_GRID_POINTS = 20_000
_MOST_PER_AXIS = 101


class Difference(NamedTuple):
    """How far two systems differ at most over a grid.

    Attributes:
        largest: Largest difference of any output; infinite where one of the two is undefined alone.
        output: Name of the output.
        inputs: Where it is.
        points: Number of grid points.
    """

    largest: float
    output: str
    inputs: tuple[float, ...]
    points: int


def difference(first: FuzzySystem, second: FuzzySystem) -> Difference:
    """Return the largest difference of the outputs of two systems with the same inputs, in this order, over a grid."""
    per_axis = max(2, min(_MOST_PER_AXIS, int(_GRID_POINTS ** (1 / len(first.inputs)))))
    axes = [np.linspace(entry.low, entry.high, per_axis) for entry in first.inputs]
    if per_axis ** len(axes) > _GRID_POINTS:
        random = np.random.default_rng(0)
        grid = np.column_stack([random.choice(axis, _GRID_POINTS) for axis in axes])
    else:
        grid = np.stack([axis.ravel() for axis in np.meshgrid(*axes, indexing="ij")], axis=-1)
    a, b = (compile_system(system).batch(grid) for system in (first, second))
    apart = np.where(np.isnan(a) & np.isnan(b), 0.0, np.abs(a - b))
    apart = np.where(np.isnan(apart), math.inf, apart)
    row, column = np.unravel_index(int(np.argmax(apart)), apart.shape)
    return Difference(float(apart[row, column]), first.outputs[column].name, tuple(grid[row].tolist()), len(grid))
