"""Membership degrees. A shape reaches the kernels as a code and four parameters.

A triangle is a trapezoid whose plateau is one point, so that both share one formula.
"""

import math

import numpy as np
from numpy.typing import NDArray

from fuzzy.kernels.address import at, inputs_at, workspace_at
from fuzzy.kernels.jit import borrowing_kernel

TRAPEZOID = 0
"""(a, b, c, d): 0 outside [a, d], 1 on [b, c], linear between; an infinite a or d is an open shoulder."""
GAUSSIAN = 1
"""(mean, sigma, -, -)."""
LINE = -1
"""(origin, run, offset, -): offset + (x - origin) / run, a piece of a piecewise-linear shape."""

_DEVIATIONS = np.array([0.0, 1.5, 3.5, 8.0, 9.0, 12.0, 38.0])
"""Standard deviations from a Gaussian's mean: between them a polynomial follows it, and beyond the last it is 0."""


@borrowing_kernel
def degree(code: int, p: NDArray[np.float64], x: float) -> float:
    """Return the membership degree of ``x``.

    Args:
        code: ``TRAPEZOID``, ``GAUSSIAN`` or ``LINE``.
        p: (4,) parameters, in the order of the code's comment.
        x: Crisp value, finite.

    Returns:
        Degree in [0, 1]. Where a side is vertical (a = b) the degree of b is 1, the set being closed.
    """
    if code == LINE:
        return p[2] + (x - p[0]) / p[1]
    if code == TRAPEZOID:
        if x < p[1]:
            if x <= p[0]:
                return 0.0
            return (x - p[0]) / (p[1] - p[0]) if p[0] > -math.inf else 1.0
        if x > p[2]:
            if x >= p[3]:
                return 0.0
            return (x - p[3]) / (p[2] - p[3]) if p[3] < math.inf else 1.0
        return 1.0
    z = (x - p[0]) / p[1]
    return math.exp(-0.5 * z * z)


@borrowing_kernel
def bends(code: int, p: NDArray[np.float64], level: float, out: NDArray[np.float64], count: int) -> int:
    """Append the points between which a set clipped at ``level`` is smooth, and not hidden from a quadrature.

    Args:
        code: ``TRAPEZOID`` or ``GAUSSIAN``.
        p: (4,) parameters.
        level: Greater than 0.
        out: (n,) list, with room for 16 more.
        count: Length of the list.

    Returns:
        The new length of the list; infinite and unsorted points are possible.
    """
    if code == TRAPEZOID:
        for i in range(4):
            out[count + i] = p[i]
        out[count + 4] = p[0] + level * (p[1] - p[0])
        out[count + 5] = p[3] + level * (p[2] - p[3])
        return count + 6
    for i in range(_DEVIATIONS.size):
        out[count + 2 * i] = p[0] - _DEVIATIONS[i] * p[1]
        out[count + 2 * i + 1] = p[0] + _DEVIATIONS[i] * p[1]
    count += 2 * _DEVIATIONS.size
    if level < 1.0:
        reach = p[1] * math.sqrt(-2.0 * math.log(level))
        out[count] = p[0] - reach
        out[count + 1] = p[0] + reach
        count += 2
    return count


@borrowing_kernel
def degrees(code: int, p: NDArray[np.float64], x: NDArray[np.float64], out: NDArray[np.float64]) -> None:
    """Write the membership degrees of ``x`` (n,) into ``out`` (n,)."""
    for i in range(x.size):
        out[i] = degree(code, p, x[i])


@borrowing_kernel
def fuzzify(address, x):
    """Write the degree of every input term for one crisp input vector into ``workspace.membership``.

    Only the pieces of one cell are computed for each input, see ``InputTables``; their terms, as far as their degree
    is above 0, are listed in ``workspace.active``.

    Args:
        address: Of a compiled system and its workspace, see ``fuzzy.kernels.address``.
        x: (n_in,) crisp inputs in their units; those outside their range count as its nearest end.

    Returns:
        Whether all inputs are finite.

    References:
        IEC 61131-7:2000, fuzzification.
    """
    inputs = inputs_at(address)
    workspace = workspace_at(address)
    membership = workspace.membership
    active = workspace.active
    for i in range(inputs.cell_start.size):
        low = inputs.range[at(i), 0]
        high = inputs.range[at(i), 1]
        value = min(max(x[at(i)], low), high)
        if not math.isfinite(x[at(i)]):
            return False
        first = inputs.term_start[at(i)]
        for n in range(first, first + workspace.active_count[at(i)]):
            membership[at(active[at(n)])] = 0.0
        cell = inputs.cell_start[at(i)]
        for knot in inputs.knot[at(inputs.knot_start[at(i)]) : at(inputs.knot_start[at(i + 1)])]:
            cell += int(knot < value) + int(knot <= value)
        end = first
        for n in range(inputs.piece_start[at(cell)], inputs.piece_start[at(cell + 1)]):
            found = degree(inputs.piece_shape[at(n)], inputs.piece[at(n)], value)
            if found > 0.0:
                k = inputs.piece_term[at(n)]
                membership[at(k)] = found
                active[at(end)] = k
                end += 1
        workspace.active_count[at(i)] = end - first
    return True
