"""A lookup table in C, interpolated linearly between its points, with a bound of its error."""

from __future__ import annotations

import itertools
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fuzzy.errors import InvalidSystemError
from fuzzy.export.c_functions import constant
from fuzzy.inference import Controller, compile_system
from fuzzy.system import FuzzySystem

MAX_VALUES = 1_000_000
"""Greatest number of values of a table."""

_PROBES = 400_000
"""About how many places the error is measured at, besides the table's own points."""

_MARGIN = 1.5
"""Bound of the error over the largest one that was measured: between the probes it may be larger."""


class Body(NamedTuple):
    """Definitions that stand before the function, and its variables and statements."""

    definitions: str
    variables: str
    statements: str


def lookup(system: FuzzySystem, points: int, *, is_single: bool) -> tuple[Body, tuple[float, ...]]:
    """Return a table and what interpolates in it, and how far each output is off at most.

    Args:
        system: A valid system.
        points: Points on each input's axis, both ends included.
        is_single: Whether the table is float.

    Raises:
        InvalidSystemError: If the table is too large, or an output is undefined somewhere.
    """
    n_in, n_out = len(system.inputs), len(system.outputs)
    if points < 2 or points**n_in * n_out > MAX_VALUES:
        valid = f"valid are 2 points and more of each input, and at most {MAX_VALUES} values"
        raise InvalidSystemError(f"a table of {points} points for each of {n_in} inputs: {valid}")
    controller = compile_system(system)
    axes = [np.linspace(entry.low, entry.high, points) for entry in system.inputs]
    values = _evaluated(controller, axes)
    if not np.isfinite(values).all():
        raise InvalidSystemError("an output is undefined somewhere (no_fire: nan): a table cannot say it", "outputs")
    rounding = np.finfo(np.float32 if is_single else np.float64).eps * np.abs(values).max(axis=0) * 8
    bounds = _MARGIN * _largest_error(controller, axes, values) + rounding
    return _body(system, values, points), tuple(float(bound) for bound in bounds)


def _evaluated(controller: Controller, axes: list[NDArray[np.float64]]) -> NDArray[np.float64]:
    """Return (n points, n_out) outputs over a grid, the last input's axis running fastest."""
    grid = np.stack([axis.ravel() for axis in np.meshgrid(*axes, indexing="ij")], axis=-1)
    return controller.batch(grid)


def _largest_error(
    controller: Controller, axes: list[NDArray[np.float64]], values: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the largest error of each output at places spread evenly over all cells, and at random ones."""
    n_in = len(axes)
    per_axis = max(3, round(_PROBES ** (1 / n_in)))
    random = np.random.default_rng(0)
    spread = np.column_stack([random.uniform(axis[0], axis[-1], _PROBES) for axis in axes])
    probes = [spread]
    if per_axis**n_in <= 2 * _PROBES:
        even = [np.linspace(axis[0], axis[-1], per_axis) for axis in axes]
        probes.append(np.stack([axis.ravel() for axis in np.meshgrid(*even, indexing="ij")], axis=-1))
    places = np.concatenate(probes)
    return np.abs(interpolated(axes, values, places) - controller.batch(places)).max(axis=0)


def interpolated(
    axes: list[NDArray[np.float64]], values: NDArray[np.float64], places: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return (n, n_out) what the table gives at ``places`` (n, n_in), computed as in C."""
    points = axes[0].size
    index = np.empty(places.shape, dtype=np.intp)
    share = np.empty(places.shape)
    for i, axis in enumerate(axes):
        position = (places[:, i] - axis[0]) * ((points - 1) / (axis[-1] - axis[0]))
        index[:, i] = np.clip(position.astype(np.intp), 0, points - 2)
        share[:, i] = position - index[:, i]
    found = np.zeros((len(places), values.shape[1]))
    for corner in itertools.product((0, 1), repeat=len(axes)):
        row = np.zeros(len(places), dtype=np.intp)
        weight = np.ones(len(places))
        for i, side in enumerate(corner):
            row = row * points + index[:, i] + side
            weight *= share[:, i] if side else 1 - share[:, i]
        found += weight[:, np.newaxis] * values[row]
    return found


def _body(system: FuzzySystem, values: NDArray[np.float64], points: int) -> Body:
    n_in, n_out = len(system.inputs), len(system.outputs)
    rows = ",\n    ".join("{" + ", ".join(constant(float(value)) for value in row) + "}" for row in values)
    definitions = f"\nstatic const REAL table[{len(values)}][{n_out}] = {{\n    {rows}}};\n"
    variables = f"    REAL position, share[{n_in}], weight;\n    int index[{n_in}], corner, i, k, row;\n"
    locate = "".join(
        f"    position = (x{i} - {constant(entry.low)}) * {constant((points - 1) / (entry.high - entry.low))};\n"
        f"    index[{i}] = position >= C({points - 2}.0) ? {points - 2} : (int)position;\n"
        f"    share[{i}] = position - (REAL)index[{i}];\n"
        for i, entry in enumerate(system.inputs)
    )
    statements = (
        f"{locate}"
        f"    for (k = 0; k < {n_out}; k++)\n        y[k] = C(0.0);\n"
        f"    for (corner = 0; corner < {2**n_in}; corner++) {{\n"
        "        weight = C(1.0);\n        row = 0;\n"
        f"        for (i = 0; i < {n_in}; i++) {{\n"
        "            int side = (corner >> i) & 1;\n"
        f"            row = row * {points} + index[i] + side;\n"
        "            weight *= side ? share[i] : C(1.0) - share[i];\n        }\n"
        f"        for (k = 0; k < {n_out}; k++)\n            y[k] += weight * table[row][k];\n    }}\n"
    )
    return Body(definitions, variables, statements)
