"""Centroids of output sets of which some are curved.

The upper envelope of the members is divided into pieces that one member leads. Between its turning points every
implied set rises or falls, so that its values at both ends of an interval bound it inside: a member whose greatest
value there is below the least of another never leads. Of two that are left, one of which rises while the other falls,
each leads on one side of one crossing. A piece's integral is then that of one smooth function.
"""

import math

from fuzzy.kernels import codes, exact, norms, places, quadrature, sets
from fuzzy.kernels.address import outputs_at, rules_at, workspace_at
from fuzzy.kernels.jit import addressed_kernel, borrowing_kernel
from fuzzy.kernels.norms import MAX, NILPOTENT_MINIMUM, SUM

_DEPTH = 5
"""How often an interval is halved in which more than two members may lead; then all of them are integrated together."""


@addressed_kernel
def centroid(address, output):
    """Return the centroid of the aggregate (paper eqs. (31), (32)) of the members' sets.

    Args:
        address: Of a compiled system and its workspace, see ``fuzzy.kernels.address``.
        output: Number of the output.
    """
    outputs = outputs_at(address)
    scratch = workspace_at(address).scratch
    account = scratch[: quadrature.ACCOUNT]
    rest = scratch[quadrature.ACCOUNT :]
    start = rules_at(address).member_start[output]
    end = start + workspace_at(address).member_count[output]
    low = outputs.range[output, 0]
    high = outputs.range[output, 1]
    quadrature.begin(account)
    if outputs.aggregation[0] == SUM:
        for member in range(start, end):
            _enter(address, output, member, member + 1, 1, low, high, account, rest)
    elif outputs.aggregation[0] == MAX and _turns_are_known(outputs):
        _follow(address, output, start, end, account, rest)
    else:
        _enter(address, output, start, end, 1, low, high, account, rest)
    area, moment = quadrature.finish(address, output, account)
    return 0.5 * (low + high) + moment / area if area > 0.0 else math.nan


@borrowing_kernel
def _enter(address, output, start, end, stride, a, b, account, points):
    """Integrate the aggregate of every ``stride``-th of the members ``start`` to ``end`` over [a, b]."""
    count = quadrature.bends(address, start, end, stride, a, b, points)
    for i in range(count - 1):
        quadrature.enter(address, output, start, end, stride, points[i], points[i + 1], account)


@borrowing_kernel
def _turns_are_known(outputs):
    unknown = 0
    for code in outputs.shape:
        unknown += int(code == codes.SIGMOID_DIFFERENCE)
    return unknown == 0


@borrowing_kernel
def _turns(address, output, start, end, points):
    """Write the points between which every member rises, falls or is level, over the range; return how many."""
    outputs = outputs_at(address)
    workspace = workspace_at(address)
    code = outputs.implication[0]
    low = outputs.range[output, 0]
    high = outputs.range[output, 1]
    points[0] = low
    points[1] = high
    count = 2
    for member in range(start, end):
        k = workspace.member[member]
        level = (
            workspace.level[member] if code == NILPOTENT_MINIMUM else norms.bend_level(code, workspace.level[member])
        )
        found = places.turns(outputs.shape[k], outputs.parameter[k], outputs.value, level, points, count)
        count = quadrature.within(low, high, points, count, found)
    exact.sort(points, count)
    return count


@borrowing_kernel
def _follow(address, output, start, end, account, rest):
    """Integrate the upper envelope of the members ``start`` to ``end`` over the whole range."""
    _sort_by_level(address, start, end)
    count = _turns(address, output, start, end, rest)
    stack = rest[count : count + 2 * (_DEPTH + 2)]
    points = rest[count + 2 * (_DEPTH + 2) :]
    for i in range(count - 1):
        # The halves of an interval that wait, the leftmost last: where each ends, and how often it was halved.
        stack[0] = rest[i + 1]
        stack[1] = 0.0
        waiting = 1
        a = rest[i]
        while waiting > 0:
            b = stack[2 * waiting - 2]
            depth = stack[2 * waiting - 1]
            if b <= a or _is_settled(address, output, start, end, a, b, account, points):
                a = max(a, b)
                waiting -= 1
            elif depth == _DEPTH:
                _enter(address, output, start, end, 1, a, b, account, points)
                a = b
                waiting -= 1
            else:
                stack[2 * waiting - 1] = depth + 1.0
                stack[2 * waiting] = 0.5 * (a + b)
                stack[2 * waiting + 1] = depth + 1.0
                waiting += 1


@borrowing_kernel
def _sort_by_level(address, start, end):
    """Put the members of the highest levels first: by insertion, since they are few."""
    member = workspace_at(address).member
    level = workspace_at(address).level
    for i in range(start + 1, end):
        k = member[i]
        highest = level[i]
        j = i - 1
        while j >= start and level[j] < highest:
            member[j + 1] = member[j]
            level[j + 1] = level[j]
            j -= 1
        member[j + 1] = k
        level[j + 1] = highest


@borrowing_kernel
def _is_settled(address, output, start, end, a, b, account, points):
    """Integrate the envelope over an interval in which members rise or fall, if it is clear which of them lead."""
    scale = workspace_at(address).gain[output]
    inner = 0.5 * (1.0 - quadrature.END) * (b - a)  # at the ends themselves sets may jump
    left = a + inner
    right = b - inner
    is_limited = outputs_at(address).implication[0] < norms.IMPLY_BOUNDED_SUM  # to the level, by a t-norm
    first = start
    second = -1
    floor = -1.0
    for n in range(start, end):
        if is_limited and scale * workspace_at(address).level[n] <= floor:
            end = n  # this one and all that follow stay below
            break
        points[2 * (n - start)] = sets.implied(address, n, left, scale)
        points[2 * (n - start) + 1] = sets.implied(address, n, right, scale)
        least = min(points[2 * (n - start)], points[2 * (n - start) + 1])
        if least > floor:
            floor = least
            first = n
    for n in range(start, end):
        if n != first and max(points[2 * (n - start)], points[2 * (n - start) + 1]) > floor:
            if second >= 0:
                return False
            second = n
    begins = points[2 * (first - start)]
    ends = points[2 * (first - start) + 1]
    if second < 0:
        _enter_leader(address, output, first, a, b, begins, ends, account, points)
        return True
    other_begins = points[2 * (second - start)]
    other_ends = points[2 * (second - start) + 1]
    if (ends - begins) * (other_ends - other_begins) > 0.0:  # they may cross more than once
        _enter(address, output, min(first, second), max(first, second) + 1, abs(first - second), a, b, account, points)
        return True
    if begins < other_begins:
        first, second = second, first
        begins, ends, other_begins, other_ends = other_begins, other_ends, begins, ends
    cut = b if ends >= other_ends else quadrature.crossing(address, first, second, left, right, scale)
    _enter_leader(address, output, first, a, cut, begins, ends, account, points)
    _enter_leader(address, output, second, cut, b, other_begins, other_ends, account, points)
    return True


@borrowing_kernel
def _enter_leader(address, output, member, a, b, begins, ends, account, points):
    """Integrate one member's set over a part of an interval at whose ends its degrees are ``begins`` and ``ends``."""
    if begins == ends:  # level, since it neither rises nor falls between
        quadrature.enter_level(address, output, begins, a, b, account)
    elif b > a:
        _enter(address, output, member, member + 1, 1, a, b, account, points)
