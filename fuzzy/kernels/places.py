"""Places of a set: where it bends, where it turns, and where it has a degree."""

import math

import numpy as np

from fuzzy.kernels.codes import (
    BELL,
    COSINE,
    GAUSSIAN,
    GAUSSIAN2,
    OFFSET,
    PEAK,
    PI_SHAPE,
    POINTS,
    SCALE,
    SIGMOID,
    SIGMOID_DIFFERENCE,
    SIGMOID_PRODUCT,
    SPIKE,
    TRAPEZOID,
)
from fuzzy.kernels.jit import borrowing_kernel
from fuzzy.kernels.membership import degree, shape_degree

_DEVIATIONS = np.array([0.0, 1.5, 3.5, 8.0, 9.0, 12.0, 38.0])
"""Distances from the middle of a curve, in its own unit of length: between them a polynomial follows it."""


@borrowing_kernel
def bends(code, p, values, level, out, count):
    """Append the points between which a set cut at ``level`` is smooth, and not hidden from a quadrature.

    Args:
        code: One of the codes of shapes, but ``LINE``.
        p: (8,) parameters.
        values: What points consist of.
        level: Degree at which an implication bends the set; none where it is not inside the set's degrees.
        out: (n,) list, with room for ``MOST_BENDS`` more, or for two for each point of a set by points.
        count: Length of the list.

    Returns:
        The new length of the list; infinite and unsorted points are possible.
    """
    before = count
    level = (level - p[OFFSET]) / p[SCALE]
    cuts = 0.0 < level < 1.0
    if code == TRAPEZOID:
        for i in range(4):
            out[count + i] = p[i]
        count += 4
        if cuts:
            out[count] = p[0] + level * (p[1] - p[0])
            out[count + 1] = p[3] + level * (p[2] - p[3])
            count += 2
        return count
    if code == POINTS:
        first = int(p[0])
        n = int(p[1])
        for i in range(first, first + n):
            out[count] = values[i]
            count += 1
            if i > first and cuts:
                low = values[i - 1 + n] - level
                high = values[i + n] - level
                if low * high < 0.0:
                    out[count] = values[i - 1] + (values[i] - values[i - 1]) * low / (low - high)
                    count += 1
        return count
    count = _curve_bends(code, p, out, count)
    if not cuts:
        return count
    end = count
    count = _inverses(code, p, level, out, count)
    if count > end:
        return count
    # Between two of its own points a curve rises or falls: it meets the level at most once there.
    for i in range(before, end):
        nearest = math.inf
        for j in range(before, end):
            if out[i] < out[j] < nearest:
                nearest = out[j]
        if math.isfinite(out[i]) and nearest < math.inf:
            left = shape_degree(code, p, values, out[i]) - level
            right = shape_degree(code, p, values, nearest) - level
            if left * right < 0.0:
                out[count] = _level_crossing(code, p, values, level, out[i], nearest)
                count += 1
    return count


@borrowing_kernel
def turns(code, p, values, level, out, count):
    """Append the points between which a set rises, falls or is level, and some of those at which it is cut.

    Arguments and result are those of ``bends``, of which these are the fewest with which an envelope can be followed.
    ``SIGMOID_DIFFERENCE`` may turn elsewhere, too.
    """
    if code in (TRAPEZOID, POINTS):
        return bends(code, p, values, level, out, count)
    level = (level - p[OFFSET]) / p[SCALE]
    out[count] = p[PEAK]
    count += 1
    if code in (GAUSSIAN2, PI_SHAPE):  # a plateau's ends, and jumps
        for i in range(4):
            out[count + i] = p[i]
        count += 4
    return _inverses(code, p, level, out, count) if 0.0 < level < 1.0 else count


@borrowing_kernel
def _inverses(code, p, level, out, count):
    """Append where a curve has a degree in (0, 1), if that can be said by a formula; return the new count."""
    reach = -1.0
    if code == GAUSSIAN:
        reach = p[1] * math.sqrt(-2.0 * math.log(level))
    elif code == BELL:
        reach = p[1] * (1.0 / level - 1.0) ** (0.5 / p[2])
    elif code == SPIKE:
        reach = -0.1 * p[1] * math.log(level)
    elif code == COSINE:
        reach = p[1] * math.acos(2.0 * level - 1.0) / (2.0 * math.pi)
    if reach >= 0.0:
        out[count] = p[0] - reach
        out[count + 1] = p[0] + reach
        return count + 2
    if code == GAUSSIAN2 and p[0] <= p[2]:
        reach = math.sqrt(-2.0 * math.log(level))
        out[count] = p[0] - p[1] * reach
        out[count + 1] = p[2] + p[3] * reach
        return count + 2
    if code == SIGMOID and p[1] != 0.0:
        out[count] = p[0] - math.log(1.0 / level - 1.0) / p[1]
        return count + 1
    return count


@borrowing_kernel
def _curve_bends(code, p, out, count):
    """Append the points between which a curve is smooth, monotone, and near to a polynomial."""
    if code in (GAUSSIAN, BELL, SIGMOID, SPIKE, COSINE):
        unit = p[1]
        if code == SIGMOID:
            unit = 1.0 / p[1] if p[1] != 0.0 else 1.0
        elif code == SPIKE:
            unit = 0.2 * p[1]
        elif code == COSINE:
            unit = p[1] / 3.0
        for i in range(_DEVIATIONS.size):
            out[count + 2 * i] = p[0] - _DEVIATIONS[i] * unit
            out[count + 2 * i + 1] = p[0] + _DEVIATIONS[i] * unit
        return count + 2 * _DEVIATIONS.size
    if code in (GAUSSIAN2, SIGMOID_PRODUCT, SIGMOID_DIFFERENCE):
        for side in range(2):
            unit = p[2 * side + 1]
            if code != GAUSSIAN2:
                unit = 1.0 / unit if unit != 0.0 else 1.0
            for i in range(_DEVIATIONS.size):
                distance = _DEVIATIONS[i] * unit
                if code != GAUSSIAN2:
                    out[count] = p[2 * side] - distance
                    out[count + 1] = p[2 * side] + distance
                    count += 2
                else:
                    out[count] = p[2 * side] + (distance if side == 1 else -distance)
                    count += 1
        out[count] = p[PEAK]
        if code == SIGMOID_DIFFERENCE and p[1] != p[3]:  # where the two sigmoids cross
            out[count + 1] = (p[1] * p[0] - p[3] * p[2]) / (p[1] - p[3])
            return count + 2
        return count + 1
    if code == PI_SHAPE:
        for i in range(4):
            out[count + i] = p[i]
        out[count + 4] = 0.5 * (p[0] + p[1])
        out[count + 5] = 0.5 * (p[2] + p[3])
        out[count + 6] = p[PEAK]
        return count + 7
    out[count] = p[0]
    out[count + 1] = p[1]
    length = p[0] - p[1]
    out[count + 2] = p[0] + 3.0 * length
    out[count + 3] = p[0] + 30.0 * length
    out[count + 4] = p[0] + 1e3 * length
    return count + 5


@borrowing_kernel
def _level_crossing(code, p, values, level, left, right):
    """Return where a monotone part of a shape has a degree, by bisection."""
    rises = shape_degree(code, p, values, right) > level
    for _ in range(80):
        middle = 0.5 * (left + right)
        if not left < middle < right:
            break
        if (shape_degree(code, p, values, middle) > level) == rises:
            right = middle
        else:
            left = middle
    return 0.5 * (left + right)


@borrowing_kernel
def inverse(code, p, values, level, low, high):
    """Return where a monotone set on [low, high] first reaches a degree, seen from the end at which it is smallest.

    The end that is nearer in degree where the set does not reach it. For Tsukamoto's inference.
    """
    rises = degree(code, p, values, high) > degree(code, p, values, low)
    for _ in range(200):
        middle = 0.5 * (low + high)
        if not low < middle < high:
            break
        if (degree(code, p, values, middle) >= level) == rises:
            high = middle
        else:
            low = middle
    if rises:
        return low if degree(code, p, values, low) >= level else high
    return high if degree(code, p, values, high) >= level else low
