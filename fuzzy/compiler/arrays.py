"""Arrays as the kernels read them."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from fuzzy.kernels.tables import Integers, Numbers

KEPT = 64
"""Variables, operators and lists of rules whose tables are kept."""


def integers(values: Any) -> Integers:
    """Return an array of integers."""
    return np.array(values, dtype=np.int64)


def numbers(values: Sequence[Any], columns: int = 0) -> Numbers:
    """Return an array of numbers, with ``columns`` columns or one-dimensional."""
    array = np.array(values, dtype=np.float64)
    return array.reshape(-1, columns) if columns else array


def starts(lengths: Iterable[int]) -> Integers:
    """Return where each of several parts of these lengths begins, and where the last one ends."""
    return integers([0, *itertools.accumulate(lengths)])


def frozen(arrays: tuple[np.ndarray, ...]) -> tuple[np.ndarray, ...]:
    """Make arrays read-only and return them."""
    for array in arrays:
        array.setflags(write=False)
    return arrays
