"""The control surface as a table: every combination of input values on a grid, and the outputs there."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fuzzy.errors import InvalidSystemError
from fuzzy.inference import compile_system
from fuzzy.system import FuzzySystem

MAX_ROWS = 2_000_000
"""Greatest number of rows."""


class SurfaceTable(NamedTuple):
    """A grid and the outputs on it.

    Attributes:
        names: Names of the inputs, then of the outputs.
        axes: (points,) values of each input.
        rows: (points ** n_in, n_in + n_out) inputs and outputs; the last input runs fastest.
    """

    names: tuple[str, ...]
    axes: tuple[NDArray[np.float64], ...]
    rows: NDArray[np.float64]


def surface_table(system: FuzzySystem, points: int) -> SurfaceTable:
    """Return the outputs over a grid.

    Args:
        system: A valid system.
        points: Values of each input, both ends of its range included.

    Raises:
        InvalidSystemError: If the table is too large.
    """
    n_in = len(system.inputs)
    if points < 2 or points**n_in > MAX_ROWS:
        valid = f"valid are 2 values and more of each input, and at most {MAX_ROWS} rows"
        raise InvalidSystemError(f"a table of {points} values for each of {n_in} inputs: {valid}")
    axes = tuple(np.linspace(entry.low, entry.high, points) for entry in system.inputs)
    grid = np.stack([axis.ravel() for axis in np.meshgrid(*axes, indexing="ij")], axis=-1)
    names = tuple(entry.name for entry in (*system.inputs, *system.outputs))
    return SurfaceTable(names, axes, np.hstack([grid, compile_system(system).batch(grid)]))
