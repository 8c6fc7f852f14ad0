"""Membership degrees. A shape reaches the kernels as a code and a row of parameters.

A triangle is a trapezoid whose plateau is one point, so that both share one formula.
"""

import math

import numpy as np
from numpy.typing import NDArray

from fuzzy.kernels.address import at, inputs_at, workspace_at
from fuzzy.kernels.codes import (
    BELL,
    CONCAVE,
    COSINE,
    GAUSSIAN,
    GAUSSIAN2,
    LINE,
    OFFSET,
    PI_SHAPE,
    POINTS,
    SCALE,
    SIGMOID,
    SIGMOID_DIFFERENCE,
    SIGMOID_PRODUCT,
    SPIKE,
    TRAPEZOID,
)
from fuzzy.kernels.jit import borrowing_kernel, inlined_kernel


@inlined_kernel
def degree(code: int, p: NDArray[np.float64], values: NDArray[np.float64], x: float) -> float:
    """Return the membership degree of ``x``.

    Args:
        code: A shape's code, see ``fuzzy.kernels.codes``.
        p: (8,) parameters, in the code's order, and offset, scale and peak; (4,) are enough for
            ``LINE``.
        values: What points consist of; read for ``POINTS`` only.
        x: Crisp value, finite.

    Returns:
        Degree in [0, 1]. Where a side is vertical (a = b) the degree of b is 1, the set being closed.
    """
    if code == LINE:
        return p[2] + (x - p[0]) / p[1]
    return p[OFFSET] + p[SCALE] * shape_degree(code, p, values, x)


@inlined_kernel
def shape_degree(code, p, values, x):
    """Return the degree of the shape alone, without height and complement; arguments as for ``degree``."""
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
    if code == GAUSSIAN:
        z = (x - p[0]) / p[1]
        return math.exp(-0.5 * z * z)
    if code == GAUSSIAN2:
        left = (x - p[0]) / p[1] if x < p[0] else 0.0
        right = (x - p[2]) / p[3] if x > p[2] else 0.0
        return math.exp(-0.5 * (left * left + right * right))
    if code == BELL:
        z = abs((x - p[0]) / p[1])
        return 1.0 / (1.0 + z ** (2.0 * p[2]))
    if code == SIGMOID:
        return _sigmoid(p[0], p[1], x)
    if code == SIGMOID_DIFFERENCE:
        return abs(_sigmoid(p[0], p[1], x) - _sigmoid(p[2], p[3], x))
    if code == SIGMOID_PRODUCT:
        return _sigmoid(p[0], p[1], x) * _sigmoid(p[2], p[3], x)
    if code == PI_SHAPE:
        return _s_shape(x - p[0], p[1] - x, p[1] - p[0]) * _s_shape(p[3] - x, x - p[2], p[3] - p[2])
    if code == COSINE:
        z = (x - p[0]) / p[1]
        return 0.5 * (1.0 + math.cos(2.0 * math.pi * z)) if abs(z) <= 0.5 else 0.0
    if code == SPIKE:
        return math.exp(-abs(10.0 / p[1] * (x - p[0])))
    if code == CONCAVE:
        if (p[0] < p[1]) == (x < p[1]):
            return (p[1] - p[0]) / (2.0 * p[1] - p[0] - x)
        return 1.0
    if code == POINTS:
        return _points(values, int(p[0]), int(p[1]), x)
    return 0.0


@borrowing_kernel
def _sigmoid(center, slope, x):
    return 1.0 / (1.0 + math.exp(-slope * (x - center)))


@borrowing_kernel
def _s_shape(above, below, width):
    """Return an s shape's degree from the distances of x from its foot and from its top."""
    if below <= 0.0 or math.isnan(below):
        return 1.0
    if above <= 0.0:
        return 0.0
    if above <= below:
        return 2.0 * (above / width) ** 2
    return 1.0 - 2.0 * (below / width) ** 2


@borrowing_kernel
def _points(values, first, count, x):
    """Return the degree of a set by points: linear between, constant outside, the larger one at a jump."""
    last = first + count - 1
    if x < values[first]:
        return values[first + count]
    if x > values[last]:
        return values[last + count]
    i = first
    while i < last and values[i + 1] < x:
        i += 1
    # Now values[i] <= x <= values[i + 1], or i is the last point.
    if i == last or x == values[i]:
        found = values[i + count]
    else:
        found = values[i + count] + (x - values[i]) * (values[i + 1 + count] - values[i + count]) / (
            values[i + 1] - values[i]
        )
    if i < last and values[i + 1] == x:
        found = values[i + 1 + count]
        if i + 1 < last and values[i + 2] == x:
            found = max(found, values[i + 2 + count])
    if i < last and x == values[i] and values[i + 1] == x:
        found = max(values[i + count], values[i + 1 + count])
    return found


@borrowing_kernel
def degrees(code, p, values, x, out):
    """Write the membership degrees of ``x`` (n,) into ``out`` (n,)."""
    for i in range(x.size):
        out[i] = degree(code, p, values, x[i])


@borrowing_kernel
def fuzzify(address, x):
    """Write the degree of every input term for one crisp input vector into ``workspace.membership``.

    Only the pieces of one cell are computed for each input, see ``InputTables``; their terms, as far as their degree
    is above 0, are listed in ``workspace.active``.

    Args:
        address: Of a compiled system and its workspace, see ``fuzzy.kernels.address``.
        x: (n_in,) crisp inputs in their units; those outside their range count as its nearest end, unless it rejects
            them.

    Returns:
        Whether all inputs are finite, and none is rejected.

    References:
        IEC 61131-7:2000, fuzzification.
    """
    inputs = inputs_at(address)
    workspace = workspace_at(address)
    membership = workspace.membership
    active = workspace.active
    # Sets by points are pieces of lines: no shape here reads values beside the table.
    for i in range(inputs.cell_start.size):
        low = inputs.range[at(i), 0]
        high = inputs.range[at(i), 1]
        value = min(max(x[at(i)], low), high)
        if not math.isfinite(x[at(i)]) or (value != x[at(i)] and inputs.rejects[at(i)] == 1):
            return False
        workspace.clamped[at(i)] = value
        first = inputs.term_start[at(i)]
        for n in range(first, first + workspace.active_count[at(i)]):
            membership[at(active[at(n)])] = 0.0
        cell = inputs.cell_start[at(i)]
        for knot in inputs.knot[at(inputs.knot_start[at(i)]) : at(inputs.knot_start[at(i + 1)])]:
            cell += int(knot < value) + int(knot <= value)
        end = first
        for n in range(inputs.piece_start[at(cell)], inputs.piece_start[at(cell + 1)]):
            found = degree(inputs.piece_shape[at(n)], inputs.piece[at(n)], inputs.knot, value)
            if found > 0.0:
                k = inputs.piece_term[at(n)]
                membership[at(k)] = found
                active[at(end)] = k
                end += 1
        workspace.active_count[at(i)] = end - first
    return True
