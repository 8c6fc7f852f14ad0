"""Closed forms for any aggregate of straight lines.

For implications and aggregations that keep lines straight: all but the Einstein and Hamacher products, and max, min,
sum and bounded sum. Between two knots every term is one line; an implication bends it where its degree passes a level.
Between two such bends the lines are followed from left to right: along the highest one to where another overtakes it.
"""

import math

from fuzzy.kernels import norms, pieces
from fuzzy.kernels.address import outputs_at, rules_at, workspace_at
from fuzzy.kernels.exact import sort
from fuzzy.kernels.jit import addressed_kernel, borrowing_kernel
from fuzzy.kernels.norms import (
    BOUNDED_DIFFERENCE,
    BOUNDED_SUM,
    DRASTIC_PRODUCT,
    IMPLY_ALGEBRAIC_SUM,
    IMPLY_BOUNDED_SUM,
    IMPLY_KLEENE_DIENES,
    LEAST,
    MIN,
    NILPOTENT_MINIMUM,
    PRODUCT,
    SUM,
)


@addressed_kernel
def centroid(address, output):
    """Return the centroid of the aggregated set.

    Args:
        address: Of a compiled system and its workspace, see ``fuzzy.kernels.address``.
        output: Number of the output.
    """
    account = workspace_at(address).scratch[: pieces.ACCOUNT]
    _follow(address, output, pieces.AREA)
    outputs = outputs_at(address)
    return pieces.centre(account, 0.5 * (outputs.range[output, 0] + outputs.range[output, 1]))


@addressed_kernel
def bisector(address, output):
    """Return the place that halves the area of the aggregated set; the middle of a gap that does.

    Args:
        address: Of a compiled system and its workspace, see ``fuzzy.kernels.address``.
        output: Number of the output.
    """
    account = workspace_at(address).scratch[: pieces.ACCOUNT]
    _follow(address, output, pieces.AREA)
    if not pieces.aim(account):
        return math.nan
    _follow(address, output, pieces.HALF)
    return account[pieces.PLACE]


@addressed_kernel
def maximum(address, output):
    """Return the mean, first, last, nearest to 0 or farthest from 0 of the places where the aggregated set is largest.

    Args:
        address: Of a compiled system and its workspace, see ``fuzzy.kernels.address``.
        output: Number of the output.
    """
    _follow(address, output, pieces.TOP)
    return pieces.top(workspace_at(address).scratch[: pieces.ACCOUNT], outputs_at(address).maximum[0])


@borrowing_kernel
def _follow(address, output, question):
    """Enter all straight pieces of the aggregated set into the account at the beginning of ``scratch``.

    Behind it stand the lines of the members in the present interval, two numbers each: first the degrees of their
    terms at both ends, then, bend by bend, their values; and behind these the bends.
    """
    outputs = outputs_at(address)
    workspace = workspace_at(address)
    scratch = workspace.scratch
    start = rules_at(address).member_start[output]
    count = workspace.member_count[output]
    gain = workspace.gain[output]
    code = outputs.implication[0]
    origin = 0.5 * (outputs.range[output, 0] + outputs.range[output, 1])
    # Where an implication takes 1 - w, a degree of 0 is known to rounding only.
    least = 0.0 if code <= PRODUCT else norms.ROUNDING
    account = scratch[: pieces.ACCOUNT]
    terms = scratch[pieces.ACCOUNT : pieces.ACCOUNT + 2 * count]
    lines = scratch[pieces.ACCOUNT + 2 * count : pieces.ACCOUNT + 4 * count]
    places = scratch[pieces.ACCOUNT + 4 * count :]
    pieces.begin(account, question)
    for interval in range(outputs.knot_start[output], outputs.knot_start[output + 1] - 1):
        left = outputs.knot[interval]
        width = outputs.knot[interval + 1] - left
        n_bends = 0
        for m in range(count):
            first = 0.0
            last = 0.0
            for p in range(outputs.side_start[interval], outputs.side_start[interval + 1]):
                if outputs.side_term[p] == workspace.member[start + m]:
                    first = outputs.side[p, 0]
                    last = outputs.side[p, 1]
            terms[2 * m] = first
            terms[2 * m + 1] = last
            level = workspace.level[start + m]
            n_bends = add_bend(first, last, norms.bend_level(code, level), places, n_bends)
            if code == NILPOTENT_MINIMUM:
                n_bends = add_bend(first, last, level, places, n_bends)
        sort(places, n_bends)
        places[n_bends] = 1.0
        begin = 0.0
        for b in range(n_bends + 1):
            end = places[b]
            if end > begin:
                for m in range(count):
                    slope = terms[2 * m + 1] - terms[2 * m]
                    centre = 0.5 * (begin + end)
                    value, rise = imply(code, gain, workspace.level[start + m], terms[2 * m] + centre * slope, slope)
                    lines[2 * m] = value - (centre - begin) * rise
                    lines[2 * m + 1] = rise
                join(account, question, origin, least, outputs.aggregation[0], lines, left, width, begin, end)
                begin = end


@borrowing_kernel
def add_bend(first, last, level, places, count):
    """Append the place in (0, 1) at which a line has a degree, if it passes it; return the new count."""
    if first < level < last or last < level < first:
        places[count] = (level - first) / (last - first)
        return count + 1
    return count


@borrowing_kernel
def imply(code, gain, w, degree, slope):
    """Return value and slope of an implied line between two bends, times ``gain``, from those of the term's line."""
    if code == MIN:
        return (gain * w, 0.0) if degree >= w else (gain * degree, gain * slope)
    if code == PRODUCT:
        return gain * w * degree, gain * w * slope
    if code == BOUNDED_DIFFERENCE:
        return (degree - (1.0 - w), slope) if degree > 1.0 - w else (0.0, 0.0)
    if code == DRASTIC_PRODUCT:
        if w >= 1.0:
            return degree, slope
        return (w, 0.0) if degree >= 1.0 else (0.0, 0.0)
    if code == NILPOTENT_MINIMUM:
        if degree - norms.ROUNDING <= 1.0 - w and w < 1.0:
            return 0.0, 0.0
        return (w, 0.0) if degree >= w else (degree, slope)
    if code == IMPLY_BOUNDED_SUM:
        return (1.0, 0.0) if degree >= 1.0 - w else (w + degree, slope)
    if code == IMPLY_ALGEBRAIC_SUM:
        return w + (1.0 - w) * degree, (1.0 - w) * slope
    if code == IMPLY_KLEENE_DIENES:
        return (degree, slope) if degree > 1.0 - w else (1.0 - w, 0.0)
    return math.nan, math.nan


@borrowing_kernel
def join(account, question, origin, least, code, lines, left, width, begin, end):
    """Enter the aggregate of lines over a part of an interval; they are their values at ``begin`` and slopes."""
    if code in (SUM, BOUNDED_SUM):
        value = 0.0
        rise = 0.0
        for m in range(lines.size // 2):
            value += lines[2 * m]
            rise += lines[2 * m + 1]
        last = value + (end - begin) * rise
        if code == SUM or (value <= 1.0 and last <= 1.0):
            _enter(account, question, origin, least, left, width, begin, end, value, last)
        elif value >= 1.0 and last >= 1.0:
            _enter(account, question, origin, least, left, width, begin, end, 1.0, 1.0)
        else:
            middle = begin + (1.0 - value) / rise
            _enter(account, question, origin, least, left, width, begin, middle, min(value, 1.0), 1.0)
            _enter(account, question, origin, least, left, width, middle, end, 1.0, min(last, 1.0))
        return
    side = -1.0 if code == LEAST else 1.0
    leading = 0
    for m in range(1, lines.size // 2):
        lead = side * (lines[2 * m] - lines[2 * leading])
        if lead > 0.0 or (lead == 0.0 and side * (lines[2 * m + 1] - lines[2 * leading + 1]) > 0.0):
            leading = m
    x = begin
    while x < end:
        following = leading
        nearest = end
        for m in range(lines.size // 2):
            # Only a line that is steeper can overtake; where it does so follows from their values at ``begin``.
            gain = side * (lines[2 * m + 1] - lines[2 * leading + 1])
            if gain > 0.0:
                crossing = begin + side * (lines[2 * leading] - lines[2 * m]) / gain
                if crossing < nearest or (
                    crossing == nearest < end and side * (lines[2 * m + 1] - lines[2 * following + 1]) > 0.0
                ):
                    nearest = crossing
                    following = m
        nearest = max(nearest, x)
        value = lines[2 * leading]
        rise = lines[2 * leading + 1]
        first = value + (x - begin) * rise
        last = value + (nearest - begin) * rise
        _enter(account, question, origin, least, left, width, x, nearest, first, last)
        if following == leading:
            break
        leading = following
        x = nearest


@borrowing_kernel
def _enter(account, question, origin, least, left, width, begin, end, first, last):
    if end > begin:
        x0 = left + begin * width
        y0 = first if first > least else 0.0
        y1 = last if last > least else 0.0
        pieces.add(account, question, origin, x0, left + end * width, y0, y1)
