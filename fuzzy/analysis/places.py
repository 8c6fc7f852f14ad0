"""Where to look: places in the input space, and the numbers of the variables that a caller names."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from fuzzy.errors import InvalidInputError, expected
from fuzzy.system import FuzzySystem, Input, Output

Numbers = NDArray[np.float64]

Place = Mapping[str, float] | Sequence[float] | Numbers
"""A point of the input space: values by name, those that are left out at mid-range; or all of them in order."""

SAMPLES = 2**16
"""About how many places are tried where the whole input space is searched."""


def place_of(system: FuzzySystem, at: Place | None) -> Numbers:
    """Return a point of the input space as an array, (n_in,)."""
    names = [variable.name for variable in system.inputs]
    place = np.array([0.5 * variable.low + 0.5 * variable.high for variable in system.inputs])
    if at is None:
        return place
    if isinstance(at, Mapping):
        given = {number_of(name, system.inputs, "input"): value for name, value in at.items()}
    elif np.ndim(at) == 1 and len(at) == len(names):
        given = dict(enumerate(at))
    else:
        raise InvalidInputError(f"{at} is no place; valid: {len(names)} values ({', '.join(names)}), or some by name")
    for n, value in given.items():
        try:
            place[n] = value
        except (TypeError, ValueError):
            raise InvalidInputError(f"{value!r} is not a number", names[n]) from None
        if not math.isfinite(place[n]):
            raise InvalidInputError(f"{place[n]} is not a finite number", names[n])
    return place


def number_of(name: str | None, variables: tuple[Input, ...] | tuple[Output, ...], kind: str) -> int:
    """Return the number of a variable, the first for None."""
    names = [variable.name for variable in variables]
    if name is None:
        return 0
    if name not in names:
        raise InvalidInputError(f"unknown {kind} {expected(name, names)}")
    return names.index(name)


def check_count(points: int, most: int) -> None:
    """Refuse a number of points that is not whole or not from 2 to ``most``."""
    if isinstance(points, bool) or not isinstance(points, int | np.integer) or not 2 <= points <= most:
        raise InvalidInputError(f"{points!r} points; valid: whole numbers from 2 to {most}")


def cell_middles(inputs: tuple[Input, ...], points: int) -> Numbers:
    """Return the middles of a grid's cells, (points ** n_in, n_in), the first input varying slowest."""
    share = (np.arange(points) + 0.5) / points
    axes = [variable.low + share * (variable.high - variable.low) for variable in inputs]
    return np.stack([grid.ravel() for grid in np.meshgrid(*axes, indexing="ij")], axis=1)


def spread(inputs: tuple[Input, ...], count: int) -> Numbers:
    """Return about ``count`` evenly spread places: a grid up to three inputs, otherwise an additive recurrence.

    References:
        M. Roberts, "The unreasonable effectiveness of quasirandom sequences" (2018): the R_d sequence.
    """
    n_in = len(inputs)
    if n_in <= 3:
        return cell_middles(inputs, round(count ** (1.0 / n_in)))
    ratio = 2.0
    for _ in range(64):  # the root above 1 of r ** (n_in + 1) = r + 1
        ratio = (1.0 + ratio) ** (1.0 / (n_in + 1))
    share = (0.5 + np.outer(np.arange(1, count + 1), ratio ** -np.arange(1.0, n_in + 1))) % 1.0
    low = np.array([variable.low for variable in inputs])
    return low + share * (np.array([variable.high for variable in inputs]) - low)
