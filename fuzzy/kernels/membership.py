"""Membership degrees. A shape reaches the kernels as a code and four parameters.

A triangle is a trapezoid whose plateau is one point, so that both share one formula.
"""

import math

import numpy as np
from numpy.typing import NDArray

from fuzzy.kernels.address import tables_at, workspace_at
from fuzzy.kernels.jit import kernel

TRAPEZOID = 0
"""(a, b, c, d): 0 outside [a, d], 1 on [b, c], linear between; an infinite a or d is an open shoulder."""
GAUSSIAN = 1
"""(mean, sigma, -, -)."""


@kernel
def degree(code: int, p: NDArray[np.float64], x: float) -> float:
    """Return the membership degree of ``x``.

    Args:
        code: ``TRAPEZOID`` or ``GAUSSIAN``.
        p: (4,) parameters, in the order of the code's comment.
        x: Crisp value, finite.

    Returns:
        Degree in [0, 1]. Where a side is vertical (a = b) the degree of b is 1, the set being closed.
    """
    if code == TRAPEZOID:
        if x < p[1]:
            if x <= p[0]:
                return 0.0
            return (x - p[0]) / (p[1] - p[0]) if p[0] > -math.inf else 1.0
        if x > p[2]:
            if x >= p[3]:
                return 0.0
            return (p[3] - x) / (p[3] - p[2]) if p[3] < math.inf else 1.0
        return 1.0
    z = (x - p[0]) / p[1]
    return math.exp(-0.5 * z * z)


@kernel
def degrees(code: int, p: NDArray[np.float64], x: NDArray[np.float64], out: NDArray[np.float64]) -> None:
    """Write the membership degrees of ``x`` (n,) into ``out`` (n,)."""
    for i in range(x.size):
        out[i] = degree(code, p, x[i])


@kernel
def fuzzify(address, x):
    """Write the degree of every input term for one crisp input vector into ``workspace.membership``.

    Args:
        address: Of a compiled system and its workspace, see ``fuzzy.kernels.address``.
        x: (n_in,) crisp inputs in their units, finite; those outside their range count as its nearest end.

    References:
        IEC 61131-7:2000, fuzzification.
    """
    tables = tables_at(address)
    membership = workspace_at(address).membership
    for i in range(x.size):
        value = min(max(x[i], tables.input_range[i, 0]), tables.input_range[i, 1])
        for k in range(tables.input_start[i], tables.input_start[i + 1]):
            membership[k] = degree(tables.input_shape[k], tables.input_parameter[k], value)
