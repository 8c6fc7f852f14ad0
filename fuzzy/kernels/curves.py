"""Bisector and maxima of output sets of which some are curved."""

import math

from fuzzy.kernels import pieces, sets
from fuzzy.kernels.address import outputs_at, rules_at, workspace_at
from fuzzy.kernels.jit import addressed_kernel, borrowing_kernel
from fuzzy.kernels.quadrature import ACCOUNT, END, TOLERANCE, begin, bends, enter, finish

_STEPS = 40
_SEARCHED = 16
"""Steps in which an interval is searched for its maximum."""
_GOLDEN = 0.5 * (math.sqrt(5.0) - 1.0)
_SAME = 1e-12
"""Difference of two degrees that count as the same, as a share of the greater one."""
_LEVEL = 1e-5
"""Least width of a plateau, as a share of the interval: around a rounded top, degrees are the same up to there."""


@addressed_kernel
def bisector(address, output):
    """Return the place that halves the area of the aggregated set; the middle of a gap that does.

    Args:
        address: Of a compiled system and its workspace, see ``fuzzy.kernels.address``.
        output: Number of the output.
    """
    outputs = outputs_at(address)
    scratch = workspace_at(address).scratch
    start = rules_at(address).member_start[output]
    end = start + workspace_at(address).member_count[output]
    scale = workspace_at(address).gain[output]
    account = scratch[:ACCOUNT]
    points = scratch[ACCOUNT:]
    count = bends(address, start, end, 1, outputs.range[output, 0], outputs.range[output, 1], points)
    parts = points[count:]
    total = 0.0
    for i in range(count - 1):
        parts[i] = _area(address, output, start, end, points[i], points[i + 1], account)
        total += parts[i]
    if not total > 0.0:
        return math.nan
    before = 0.0
    for i in range(count - 1):
        if before + parts[i] >= 0.5 * total * (1.0 - TOLERANCE):
            left = points[i]
            right = points[i + 1]
            if before + parts[i] <= 0.5 * total * (1.0 + TOLERANCE):
                # This interval ends at one half: what follows it may be a gap.
                j = i + 1
                while j < count - 2 and parts[j] == 0.0:
                    j += 1
                return 0.5 * (right + points[j])
            x = left + (right - left) * (0.5 * total - before) / parts[i]
            low = left
            high = right
            for _ in range(_STEPS):
                found = _area(address, output, start, end, left, x, account)
                error = before + found - 0.5 * total
                if error > 0.0:
                    high = x
                else:
                    low = x
                density = sets.joined(address, start, end, x, scale)
                step = error / density if density > 0.0 else math.inf
                x -= step
                if abs(step) <= 1e-14 * (abs(left) + abs(right)):
                    break
                if not low < x < high:
                    x = 0.5 * (low + high)
            return x
        before += parts[i]
    return math.nan


@borrowing_kernel
def _area(address, output, start, end, a, b, account):
    """Return the area of the aggregate of the members ``start`` to ``end`` over [a, b], where each is smooth."""
    begin(account)
    enter(address, output, start, end, 1, a, b, account)
    area, _ = finish(address, output, account)
    return area


@addressed_kernel
def maximum(address, output):
    """Return the mean, first, last, nearest to 0 or farthest from 0 of the places where the aggregated set is largest.

    Between two bends the set rises, falls or is level, or has one maximum within, which is searched.

    Args:
        address: Of a compiled system and its workspace, see ``fuzzy.kernels.address``.
        output: Number of the output.
    """
    outputs = outputs_at(address)
    scratch = workspace_at(address).scratch
    start = rules_at(address).member_start[output]
    end = start + workspace_at(address).member_count[output]
    count = bends(address, start, end, 1, outputs.range[output, 0], outputs.range[output, 1], scratch)
    account = scratch[count : count + pieces.ACCOUNT]
    pieces.begin(account, pieces.TOP)
    for i in range(count - 1):
        left = scratch[i]
        right = scratch[i + 1]
        if right <= left:
            continue
        _enter_top(address, output, start, end, left, right, account)
    return pieces.top(account, outputs.maximum[0])


@borrowing_kernel
def _enter_top(address, output, start, end, left, right, account):
    """Enter the highest part of the set between two bends, found among samples and then by the golden section."""
    scale = workspace_at(address).gain[output]
    inner = 0.5 * (1.0 - END) * (right - left)  # at the bends themselves the set may jump
    step = (right - left - 2.0 * inner) / _SEARCHED
    best = -1.0
    at = 0
    for n in range(_SEARCHED + 1):
        degree = sets.joined(address, start, end, left + inner + n * step, scale)
        if degree > best * (1.0 + _SAME):
            best = degree
            at = n
    low = left + inner + max(at - 1, 0) * step
    high = left + inner + min(at + 1, _SEARCHED) * step
    place = left + inner + at * step
    if 0 < at < _SEARCHED:
        for _ in range(_STEPS):
            first = high - _GOLDEN * (high - low)
            second = low + _GOLDEN * (high - low)
            if sets.joined(address, start, end, first, scale) >= sets.joined(address, start, end, second, scale):
                high = second
            else:
                low = first
        place = 0.5 * (low + high)
        best = max(best, sets.joined(address, start, end, place, scale))
    begin = _edge(address, output, start, end, place, left + inner, best)
    finish = _edge(address, output, start, end, place, right - inner, best)
    if begin <= left + inner:
        begin = left
    if finish >= right - inner:
        finish = right
    is_level = finish - begin > _LEVEL * (right - left)
    if not is_level:
        begin = finish = left if at == 0 else right if at == _SEARCHED else place
    pieces.add(account, pieces.TOP, 0.0, begin, finish, best, best)


@borrowing_kernel
def _edge(address, output, start, end, place, limit, best):
    """Return how far from ``place`` towards ``limit`` the set is as high as ``best``, by bisection."""
    scale = workspace_at(address).gain[output]
    if sets.joined(address, start, end, limit, scale) >= best * (1.0 - _SAME):
        return limit
    inside = place
    outside = limit
    for _ in range(60):
        middle = 0.5 * (inside + outside)
        if sets.joined(address, start, end, middle, scale) >= best * (1.0 - _SAME):
            inside = middle
        else:
            outside = middle
    return inside
