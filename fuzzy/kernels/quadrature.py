"""Integrals of output sets of which some are curved, by adaptive Gauss-Kronrod quadrature.

Between the points where another member begins to lead the integrand is analytic, so that the rule converges at once;
an interval is therefore divided where two members cross, rather than in the middle. Errors are judged by the area of
the whole set, which may be tiny: where all rules fire weakly, or where the universe ends in a Gaussian's tail. So an
interval whose error is not small by its own area waits until all others have been integrated.
"""

import math

import numpy as np

from fuzzy.kernels import exact, norms, places, sets
from fuzzy.kernels.address import at, outputs_at, workspace_at
from fuzzy.kernels.jit import borrowing_kernel
from fuzzy.kernels.norms import MAX, NILPOTENT_MAXIMUM, NILPOTENT_MINIMUM

TOLERANCE = 1e-10
"""Accepted difference of the two rules on an interval, as a share of the whole area; the finer one is far closer."""

_NARROWEST = 1e-14
"""Width of an interval that is not divided further, as a share of the range."""

_AREA, _MOMENT, _ESTIMATE, _COUNT = range(4)
"""Places of an account: what has been integrated, an estimate of the whole area, how many intervals wait."""

_FIRST = 4
_WAITING = 8
"""Where the waiting intervals begin, and the numbers kept of each: both ends, area, moment, error, and its members."""

_ROOM = 64
"""Intervals that may wait; what comes then is judged by the area that is known so far, which is more than is asked."""

_PARTS = 60
"""Parts of an interval that may wait to be divided: each division halves one, or cuts it where members cross."""

_MOST_INTERVALS = 1000
"""Parts of an interval that are integrated at most: two sets whose sum is 1 everywhere, but for rounding, jump to and
fro under the nilpotent maximum, and no division would ever be the last."""

ACCOUNT = _FIRST + _WAITING * _ROOM + 2 * _PARTS
"""Numbers that an account takes."""

_CROSSING_STEPS = 80
_CROSSING = 1e-9
"""Accepted error of a crossing, as a share of its interval: what it costs is of second order."""

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


@borrowing_kernel
def begin(account):
    """Begin an account of ``ACCOUNT`` numbers."""
    account[:_FIRST] = 0.0


@borrowing_kernel
def enter(address, output, start, end, stride, a, b, account):
    """Integrate the aggregate of every ``stride``-th of the members ``start`` to ``end`` on [a, b].

    Args:
        address: Of a compiled system and its workspace.
        output: Number of the output.
        start: First member.
        end: The member after the last one.
        stride: 1 for all members between; the distance of two that are integrated without those between them.
        a: Where the interval begins; all these members are smooth inside.
        b: Where it ends; nothing is integrated if that is not behind ``a``.
        account: Where to add the integral.
    """
    if b <= a:
        return
    part, moment, error, _ = _interval(address, output, start, end, stride, a, b)
    account[_ESTIMATE] += part
    waiting = int(account[_COUNT])
    if error <= TOLERANCE * part:
        account[_AREA] += part
        account[_MOMENT] += moment
    elif waiting == _ROOM:
        _divide(address, output, start, end, stride, a, b, account)
    else:
        kept = account[_FIRST + _WAITING * waiting :]
        kept[0] = a
        kept[1] = b
        kept[2] = part
        kept[3] = moment
        kept[4] = error
        kept[5] = start
        kept[6] = end
        kept[7] = stride
        account[_COUNT] += 1


@borrowing_kernel
def enter_level(address, output, degree, a, b, account):
    """Integrate a constant degree over [a, b]."""
    outputs = outputs_at(address)
    area = degree * (b - a)
    account[_AREA] += area
    account[_ESTIMATE] += area
    account[_MOMENT] += 0.5 * area * (a + b - outputs.range[at(output), 0] - outputs.range[output, 1])


@borrowing_kernel
def finish(address, output, account):
    """Return area, and moment about the middle of the range, of all that has been entered."""
    for n in range(int(account[_COUNT])):
        kept = account[_FIRST + _WAITING * n :]
        if kept[4] <= TOLERANCE * account[_ESTIMATE]:
            account[_AREA] += kept[2]
            account[_MOMENT] += kept[3]
        else:
            _divide(address, output, int(kept[5]), int(kept[6]), int(kept[7]), kept[0], kept[1], account)
    return account[_AREA], account[_MOMENT]


@borrowing_kernel
def _divide(address, output, start, end, stride, a, b, account):
    """Integrate over the parts of an interval, divided until the error of each is small."""
    outputs = outputs_at(address)
    span = outputs.range[at(output), 1] - outputs.range[output, 0]
    stack = account[_FIRST + _WAITING * _ROOM :]
    stack[0] = a
    stack[1] = b
    waiting = 1
    count = 0
    while waiting > 0:
        waiting -= 1
        count += 1
        a = stack[2 * waiting]
        b = stack[2 * waiting + 1]
        part, moment, error, cut = _interval(address, output, start, end, stride, a, b)
        is_enough = error <= TOLERANCE * account[_ESTIMATE] or count + waiting >= _MOST_INTERVALS
        if is_enough or b - a <= _NARROWEST * span or waiting + 2 > _PARTS:
            account[_AREA] += part
            account[_MOMENT] += moment
            continue
        stack[2 * waiting + 1] = cut
        stack[2 * waiting + 2] = cut
        stack[2 * waiting + 3] = b
        waiting += 2


@borrowing_kernel
def bends(address, start, end, stride, low, high, points):
    """Write the points between which every ``stride``-th member is smooth, ``low`` to ``high``; return how many."""
    outputs = outputs_at(address)
    workspace = workspace_at(address)
    code = outputs.implication[0]
    points[0] = low
    points[1] = high
    count = 2
    for member in range(start, end, stride):
        k = workspace.member[member]
        level = norms.bend_level(code, workspace.level[member])
        found = places.bends(outputs.shape[k], outputs.parameter[k], outputs.value, level, points, count)
        if code == NILPOTENT_MINIMUM:
            level = workspace.level[member]
            found = places.bends(outputs.shape[k], outputs.parameter[k], outputs.value, level, points, found)
        count = within(low, high, points, count, found)
    exact.sort(points, count)
    return count


@borrowing_kernel
def within(low, high, points, count, end):
    """Keep of the points ``count`` to ``end`` those between ``low`` and ``high``; return the new count."""
    for i in range(count, end):
        if low < points[i] < high:
            points[count] = points[i]
            count += 1
    return count


@borrowing_kernel
def _leading(address, start, end, stride, u, scale):
    """Return the largest degree at ``u``, the second largest, and the member that leads.

    Where the aggregation is not max, none leads: the aggregate, and no second.
    """
    if outputs_at(address).aggregation[0] != MAX:
        return sets.joined(address, start, end, u, scale), -math.inf, start
    best = 0.0
    second = 0.0
    leader = start
    for member in range(start, end, stride):
        degree = sets.implied(address, member, u, scale)
        if degree > best:
            second = best
            best = degree
            leader = member
        elif degree > second:
            second = degree
    return best, second, leader


@borrowing_kernel
def _interval(address, output, start, end, stride, a, b):
    """Integrate the envelope of the members ``start`` to ``end`` over [a, b].

    Returns:
        Area, moment, error, and where to divide the interval if the error is too large. Where members cross, or come
        so near to each other between two nodes that they may cross twice, the error is what may be lost by that.
    """
    outputs = outputs_at(address)
    scale = workspace_at(address).gain[at(output)]
    low = outputs.range[at(output), 0]
    high = outputs.range[at(output), 1]
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
    skipped = int(end == start + 1)  # the outermost nodes tell who leads, no more
    for n in range(skipped, _NODES - skipped):
        j = min(n, _NODES - 1 - n)
        step = half * (-_NODE[at(j)] if n < _NODES // 2 else _NODE[at(j)])
        u = centre + step
        degree, second, leader = _leading(address, start, end, stride, u, scale)
        area += _KRONROD[at(j)] * degree
        moment += _KRONROD[at(j)] * degree * (offset + step)
        coarse_area += _GAUSS[at(j)] * degree
        coarse_moment += _GAUSS[at(j)] * degree * (offset + step)
        lead = degree - second
        if n > skipped and leader != leader1 and not has_crossing:
            has_crossing = True
            cut = crossing(address, leader1, leader, u1, u, scale)
            lost = half * degree
        elif n > skipped + 1 and lead1 < lead2 and lead1 < lead and not has_crossing:
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
    if outputs.aggregation[0] == NILPOTENT_MAXIMUM and _may_jump(address, start, end, stride, a, b):
        cut = centre
        error = max(error, b - a)
    return area, moment, error, cut


@borrowing_kernel
def _may_jump(address, start, end, stride, a, b):
    """Return whether the nilpotent maximum of the members may jump between ``a`` and ``b``.

    It does where the two largest degrees add up to 1. Each member rises or falls there, so that its degrees at both
    ends bound those between; a jump may be so narrow that no node of a rule meets it.
    """
    inner = 0.5 * (1.0 - END) * (b - a)
    most = second_most = least = second_least = 0.0
    for member in range(start, end, stride):
        first = sets.implied(address, member, a + inner, 1.0)
        last = sets.implied(address, member, b - inner, 1.0)
        high = max(first, last)
        low = min(first, last)
        second_most = max(second_most, min(most, high))
        most = max(most, high)
        second_least = max(second_least, min(least, low))
        least = max(least, low)
    always = second_least >= 1.0 - least
    return not always and second_most >= 1.0 - most


@borrowing_kernel
def crossing(address, first, second, left, right, scale):
    """Return where between ``left`` and ``right`` the second member overtakes the first.

    References:
        Chandrupatla, "A new hybrid quadratic/bisection algorithm for finding the zero of a nonlinear function without
        using derivatives", 1997.
    """
    tolerance = _CROSSING * (right - left)
    other = left
    lead_other = sets.implied(address, second, left, scale) - sets.implied(address, first, left, scale)
    last = lead_last = 0.0
    best = right
    lead = sets.implied(address, second, right, scale) - sets.implied(address, first, right, scale)
    if lead_other >= 0.0 or lead <= 0.0:  # no crossing, or at an end
        return left if lead_other >= 0.0 else right
    share = 0.5
    for _ in range(_CROSSING_STEPS):
        if abs(best - other) <= tolerance or lead == 0.0:
            break
        least = 0.5 * tolerance / abs(best - other)
        place = best + min(max(share, least), 1.0 - least) * (other - best)
        if place in (best, other):  # far from zero no number lies between them
            break
        found = sets.implied(address, second, place, scale) - sets.implied(address, first, place, scale)
        if (found > 0.0) == (lead > 0.0):
            last, lead_last = best, lead
        else:
            last, lead_last = other, lead_other
            other, lead_other = best, lead
        best, lead = place, found
        # Inverse quadratic interpolation where the three places promise that it is monotone, otherwise halving.
        x = (best - other) / (last - other)
        y = (lead - lead_other) / (lead_last - lead_other)
        share = 0.5
        if y * y < x and (1.0 - y) * (1.0 - y) < 1.0 - x:
            share = lead / (lead_other - lead) * lead_last / (lead_other - lead_last)
            share += (last - best) / (other - best) * lead / (lead_last - lead) * lead_other / (lead_last - lead_other)
    return best if abs(lead) < abs(lead_other) else other
