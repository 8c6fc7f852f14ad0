"""Integrals and centroids of output sets of which some are curved, by adaptive Gauss-Kronrod quadrature.

Between the points where another member begins to lead the integrand is analytic, so that the rule converges at once;
an interval is therefore divided where two members cross, rather than in the middle. Errors are judged by the area of
the whole set, which may be tiny: where all rules fire weakly, or where the universe ends in a Gaussian's tail.
"""

import math

import numpy as np

from fuzzy.kernels import exact, membership, norms, sets
from fuzzy.kernels.address import outputs_at, rules_at, workspace_at
from fuzzy.kernels.jit import addressed_kernel, borrowing_kernel
from fuzzy.kernels.norms import MAX, NILPOTENT_MINIMUM, SUM

TOLERANCE = 1e-10
"""Accepted difference of the two rules on an interval, as a share of the whole area; the finer one is far closer."""

_NARROWEST = 1e-14
"""Width of an interval that is not divided further, as a share of the range."""

_WAITING = 60
"""Parts of an interval that may wait to be divided: each division halves one, or cuts it where members cross."""

_PENDING = 6
"""Numbers kept of an interval that may have to be divided: both ends, area, moment, error, where to divide it."""

_CROSSING_STEPS = 40
END = 1.0 - 2e-9
"""Place next to an interval's end, where only the leader is asked for: the ends themselves may lie on a jump."""

# Gauss-Kronrod 7-15: Kronrod, "Nodes and Weights of Quadrature Formulas", 1965; values as in QUADPACK's dqk15.
_NODE = np.array(
    [
        END,
        0.991455371120812639206854697526329,
        0.949107912342758524526189684047851,
        0.864864423359769072789712788640926,
        0.741531185599394439863864773280788,
        0.586087235467691130294144691693310,
        0.405845151377397166906606412076961,
        0.207784955007898467600689403773245,
        0.0,
    ]
)
_KRONROD = np.array(
    [
        0.0,
        0.022935322010529224963732008058970,
        0.063092092629978553290700663189204,
        0.104790010322250183839876322541518,
        0.140653259715525918745189590510238,
        0.169004726639267902826583426598550,
        0.190350578064785409913256402421014,
        0.204432940075298892414161999234649,
        0.209482141084727828012999174891714,
    ]
)
_GAUSS = np.array(
    [
        0.0,
        0.0,
        0.129484966168869693270611432679082,
        0.0,
        0.279705391489276667901467771423780,
        0.0,
        0.381830050505118944950369775488975,
        0.0,
        0.417959183673469387755102040816327,
    ]
)
_NODES = 2 * _NODE.size - 1


@addressed_kernel
def centroid(address, output):
    """Return the centroid of the aggregate (paper eqs. (31), (32)) of the members' sets.

    Args:
        address: Of a compiled system and its workspace, see ``fuzzy.kernels.address``.
        output: Number of the output.
    """
    outputs = outputs_at(address)
    scratch = workspace_at(address).scratch
    start = rules_at(address).member_start[output]
    end = start + workspace_at(address).member_count[output]
    area = 0.0
    moment = 0.0
    if outputs.aggregation[0] == SUM:
        for member in range(start, end):
            count = bends(address, output, member, member + 1)
            part, part_moment = integrate(address, output, member, member + 1, scratch, count)
            area += part
            moment += part_moment
    else:
        count = bends(address, output, start, end)
        area, moment = integrate(address, output, start, end, scratch, count)
    middle = 0.5 * (outputs.range[output, 0] + outputs.range[output, 1])
    return middle + moment / area if area > 0.0 else math.nan


@borrowing_kernel
def integrate(address, output, start, end, scratch, count):
    """Return area and moment, about the middle of the range, of the aggregate of the members ``start`` to ``end``.

    Args:
        address: Of a compiled system and its workspace.
        output: Number of the output.
        start: First member.
        end: The member after the last one.
        scratch: Its first ``count`` numbers are the places between which to integrate; what follows is used.
        count: How many.
    """
    outputs = outputs_at(address)
    span = outputs.range[output, 1] - outputs.range[output, 0]
    area = 0.0
    moment = 0.0
    estimate = 0.0
    pending = count
    for i in range(count - 1):
        if scratch[i + 1] <= scratch[i]:
            continue
        part, part_moment, error, cut = _interval(address, output, start, end, scratch[i], scratch[i + 1])
        estimate += part
        if error <= TOLERANCE * part:
            area += part
            moment += part_moment
        else:
            scratch[pending] = scratch[i]
            scratch[pending + 1] = scratch[i + 1]
            scratch[pending + 2] = part
            scratch[pending + 3] = part_moment
            scratch[pending + 4] = error
            scratch[pending + 5] = cut
            pending += _PENDING
    for p in range(count, pending, _PENDING):
        if scratch[p + 4] <= TOLERANCE * estimate:
            area += scratch[p + 2]
            moment += scratch[p + 3]
            continue
        stack = scratch[pending:]
        stack[0] = scratch[p]
        stack[1] = scratch[p + 5]
        stack[2] = scratch[p + 5]
        stack[3] = scratch[p + 1]
        waiting = 2
        while waiting > 0:
            waiting -= 1
            a = stack[2 * waiting]
            b = stack[2 * waiting + 1]
            part, part_moment, error, cut = _interval(address, output, start, end, a, b)
            if error <= TOLERANCE * estimate or b - a <= _NARROWEST * span or waiting + 2 > _WAITING:
                area += part
                moment += part_moment
                continue
            stack[2 * waiting + 1] = cut
            stack[2 * waiting + 2] = cut
            stack[2 * waiting + 3] = b
            waiting += 2
    return area, moment


@borrowing_kernel
def bends(address, output, start, end):
    """Write the points between which every member is smooth into ``scratch``, in ascending order; return how many."""
    outputs = outputs_at(address)
    workspace = workspace_at(address)
    scratch = workspace.scratch
    low = outputs.range[output, 0]
    high = outputs.range[output, 1]
    scratch[0] = low
    scratch[1] = high
    count = 2
    for member in range(start, end):
        k = workspace.member[member]
        level = norms.bend_level(outputs.implication[0], workspace.level[member])
        found = membership.bends(outputs.shape[k], outputs.parameter[k], outputs.value, level, scratch, count)
        if outputs.implication[0] == NILPOTENT_MINIMUM:
            level = workspace.level[member]
            found = membership.bends(outputs.shape[k], outputs.parameter[k], outputs.value, level, scratch, found)
        kept = count
        for i in range(count, found):
            if low < scratch[i] < high:
                scratch[kept] = scratch[i]
                kept += 1
        count = kept
    exact.sort(scratch, count)
    return count


@borrowing_kernel
def _leading(address, start, end, u, scale):
    """Return the largest degree at ``u``, the second largest, and the member that leads.

    Where the aggregation is not max, none leads: the aggregate, and no second.
    """
    if outputs_at(address).aggregation[0] != MAX:
        return sets.joined(address, start, end, u, scale), -math.inf, start
    best = 0.0
    second = 0.0
    leader = start
    for member in range(start, end):
        degree = sets.implied(address, member, u, scale)
        if degree > best:
            second = best
            best = degree
            leader = member
        elif degree > second:
            second = degree
    return best, second, leader


@borrowing_kernel
def _interval(address, output, start, end, a, b):
    """Integrate the envelope of the members ``start`` to ``end`` over [a, b].

    Returns:
        Area, moment, error, and where to divide the interval if the error is too large. Where members cross, or come
        so near to each other between two nodes that they may cross twice, the error is what may be lost by that.
    """
    outputs = outputs_at(address)
    scale = workspace_at(address).gain[output]
    low = outputs.range[output, 0]
    high = outputs.range[output, 1]
    centre = 0.5 * (a + b)
    half = 0.5 * (b - a)
    offset = centre - 0.5 * (low + high)
    area = moment = coarse_area = coarse_moment = 0.0
    cut = centre
    lost = 0.0
    has_crossing = False
    # The last node, 1, and the one before it, 2: place and lead over the second member; who leads at the last.
    u1 = u2 = a
    lead1 = lead2 = 0.0
    leader1 = -1
    for n in range(_NODES):
        j = min(n, _NODES - 1 - n)
        step = half * (-_NODE[j] if n < _NODES // 2 else _NODE[j])
        u = centre + step
        degree, second, leader = _leading(address, start, end, u, scale)
        area += _KRONROD[j] * degree
        moment += _KRONROD[j] * degree * (offset + step)
        coarse_area += _GAUSS[j] * degree
        coarse_moment += _GAUSS[j] * degree * (offset + step)
        lead = degree - second
        if n > 0 and leader != leader1 and not has_crossing:
            has_crossing = True
            cut = _crossing(address, leader1, leader, u1, u, scale)
            lost = half * degree
        elif n > 1 and lead1 < lead2 and lead1 < lead and not has_crossing:
            gap = 0.25 * max(lead2 - lead1, lead - lead1)
            if lead1 < gap and gap * (u - u2) > lost:
                lost = gap * (u - u2)
                cut = u1
        u2, lead2 = u1, lead1
        u1, lead1, leader1 = u, lead, leader
    area *= half
    moment *= half
    span = high - low
    error = max(abs(area - half * coarse_area), abs(moment - half * coarse_moment) / span, lost)
    if min(cut - a, b - cut) <= 1e-8 * (b - a):  # a crossing at the very end costs nothing
        cut = centre
        error = max(abs(area - half * coarse_area), abs(moment - half * coarse_moment) / span)
    return area, moment, error, cut


@borrowing_kernel
def _crossing(address, first, second, left, right, scale):
    """Return where between ``left`` and ``right`` the second member overtakes the first, by the Illinois method."""
    before = sets.implied(address, second, left, scale) - sets.implied(address, first, left, scale)
    after = sets.implied(address, second, right, scale) - sets.implied(address, first, right, scale)
    width = right - left
    for _ in range(_CROSSING_STEPS):
        if not after > before or right - left <= 1e-9 * width:
            break
        middle = left - before * (right - left) / (after - before)
        if not left < middle < right:
            break
        found = sets.implied(address, second, middle, scale) - sets.implied(address, first, middle, scale)
        if found <= 0.0:
            left = middle
            before = found
            after *= 0.5
        else:
            right = middle
            after = found
            before *= 0.5
        if found == 0.0:
            return middle
    return 0.5 * (left + right)
