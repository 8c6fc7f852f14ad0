"""Exact centroids of piecewise-linear output sets.

Every set is cut into level sets: {u : degree(u) >= t} has a width w(t) and a first moment m(t), which for a
piecewise-linear set are a linear and a quadratic function of the level t between two vertex heights. The set
clipped at height h thus has the area A(h) = ∫ w dt and the moment M(h) = ∫ m dt over 0 <= t <= h: a quadratic and a
cubic polynomial in h, whose coefficients are computed once, when a system is compiled
(``fuzzy.geometry.cut_polynomials``). Moments are taken about the middle of the output's range, where they cancel
least.
"""

import math

from fuzzy.kernels.address import at, outputs_at, rules_at, workspace_at
from fuzzy.kernels.jit import addressed_kernel, borrowing_kernel
from fuzzy.kernels.norms import MIN


@borrowing_kernel
def clipped_set(address, index, height):
    """Return area and moment of a set clipped at ``height``; the index is that of ``OutputTables.cut_start``."""
    outputs = outputs_at(address)
    first = outputs.cut_start[at(index)]
    row = outputs.cut_start[at(index + 1)] - 1
    while row > first and outputs.cut[at(row), 0] > height:
        row -= 1
    return cut_below(outputs.cut[at(row)], height)


@borrowing_kernel
def cut_below(cut, height):
    """Return area and moment below ``height`` by one row of ``OutputTables.cut``, an array or a tuple."""
    d = height - cut[0]
    return cut[1] + d * (cut[2] + d * cut[3]), cut[4] + d * (cut[5] + d * (cut[6] + d * cut[7]))


@addressed_kernel
def clipped_centroid(address, output):
    """Return the centroid of the union of clipped sets of which only neighbours overlap.

    max = Σ min(h_k, μ_k) - Σ min(h_k, h_k+1, μ_k, μ_k+1), since no three sets overlap.

    Args:
        address: Of a compiled system and its workspace, see ``fuzzy.kernels.address``.
        output: Number of the output.
    """
    outputs = outputs_at(address)
    workspace = workspace_at(address)
    height = workspace.height
    gain = workspace.gain[at(output)]
    start = rules_at(address).member_start[at(output)]
    area = 0.0
    moment = 0.0
    for n in range(start, start + workspace.member_count[at(output)]):
        k = workspace.member[at(n)]
        part, part_moment = clipped_set(address, k, gain * height[at(k)])
        area += part
        moment += part_moment
        right = outputs.neighbour[at(k)]
        if right >= 0 and height[at(right)] > 0.0:
            common = gain * min(height[at(k)], height[at(right)])
            part, part_moment = clipped_set(address, height.size + k, common)
            area -= part
            moment -= part_moment
    return _centroid(outputs, output, area, moment)


@addressed_kernel
def separate_centroid(address, output):
    """Return the centroid of the sum of the members' sets (paper eq. (32)).

    Args:
        address: Of a compiled system and its workspace, see ``fuzzy.kernels.address``.
        output: Number of the output.
    """
    outputs = outputs_at(address)
    workspace = workspace_at(address)
    clips = outputs.implication[0] == MIN
    start = rules_at(address).member_start[output]
    area = 0.0
    moment = 0.0
    for n in range(start, start + workspace.member_count[output]):
        level = workspace.gain[output] * workspace.level[n]
        part, part_moment = clipped_set(address, workspace.member[n], level if clips else 1.0)
        scale = 1.0 if clips else level
        area += scale * part
        moment += scale * part_moment
    return _centroid(outputs, output, area, moment)


@borrowing_kernel
def _centroid(outputs, output, area, moment):
    middle = 0.5 * (outputs.range[output, 0] + outputs.range[output, 1])
    return middle + moment / area if area > 0.0 else math.nan


@addressed_kernel
def envelope_centroid(address, output):
    """Return the centroid of the upper envelope of clipped or scaled piecewise-linear sets (paper eq. (31)).

    Each interval between knots is divided where a member bends at its level and where two members cross; between
    these points the envelope is a straight line.

    Args:
        address: Of a compiled system and its workspace, see ``fuzzy.kernels.address``.
        output: Number of the output.
    """
    outputs = outputs_at(address)
    heights = workspace_at(address).height
    scratch = workspace_at(address).scratch
    area = 0.0
    moment = 0.0
    for interval in range(outputs.knot_start[output], outputs.knot_start[output + 1] - 1):
        count = 0
        first = outputs.side_start[interval]
        end = outputs.side_start[interval + 1]
        for p in range(first, end):
            if heights[outputs.side_term[p]] > 0.0:
                count = _add_bends(address, output, p, end, scratch, count)
        sort(scratch, count)
        scratch[count] = 1.0
        begin = 0.0
        for c in range(count + 1):
            if scratch[c] > begin:
                part, part_moment = _segment(address, output, interval, begin, scratch[c])
                area += part
                moment += part_moment
                begin = scratch[c]
    return _centroid(outputs, output, area, moment)


@borrowing_kernel
def _add_bends(address, output, p, end, scratch, count):
    """Append the places in (0, 1) at which side ``p`` meets its level or a later side; return the new count."""
    outputs = outputs_at(address)
    workspace = workspace_at(address)
    gain = workspace.gain[output]
    clips = outputs.implication[0] == MIN
    height = gain * workspace.height[outputs.side_term[p]]
    left = outputs.side[p, 0]
    right = outputs.side[p, 1]
    if clips:
        count = _add_crossing(left - height, right - height, scratch, count)
    else:
        left *= height
        right *= height
    for q in range(p + 1, end):
        other = gain * workspace.height[outputs.side_term[q]]
        if other > 0.0:
            scale = 1.0 if clips else other
            start = scale * outputs.side[q, 0]
            stop = scale * outputs.side[q, 1]
            count = _add_crossing(left - start, right - stop, scratch, count)
            if clips:  # one's plateau against the other's side
                count = _add_crossing(left - other, right - other, scratch, count)
                count = _add_crossing(start - height, stop - height, scratch, count)
    return count


@borrowing_kernel
def _segment(address, output, interval, begin, end):
    """Return area and moment of the envelope on a part of an interval where it is one straight line.

    Args:
        address: Of a compiled system and its workspace.
        output: Number of the output.
        interval: Number of the interval, that of its left knot.
        begin: Where the part begins, as a share of the interval.
        end: Where it ends.
    """
    outputs = outputs_at(address)
    workspace = workspace_at(address)
    clips = outputs.implication[0] == MIN
    left = outputs.knot[interval]
    width = outputs.knot[interval + 1] - left
    centre = 0.5 * (begin + end)
    value = 0.0
    rise = 0.0
    for p in range(outputs.side_start[interval], outputs.side_start[interval + 1]):
        height = workspace.gain[output] * workspace.height[outputs.side_term[p]]
        # The line that is largest in the middle is so on the whole part: none cross inside it. Whether it is a
        # plateau is decided there too, since at the ends rounding would decide.
        slope = outputs.side[p, 1] - outputs.side[p, 0]
        at_centre = outputs.side[p, 0] + centre * slope
        if not clips:
            at_centre *= height
            slope *= height
        elif at_centre >= height:
            at_centre = height
            slope = 0.0
        if at_centre > value and height > 0.0:
            value = at_centre
            rise = slope
    length = (end - begin) * width
    middle = 0.5 * (outputs.range[output, 0] + outputs.range[output, 1])
    area = length * value
    return area, area * (left - middle + centre * width) + length * length * (end - begin) * rise / 12.0


@borrowing_kernel
def _add_crossing(a, b, scratch, count):
    """Append the place in (0, 1) at which a line from ``a`` to ``b`` is 0, if it changes sign; return the new count."""
    if (a < 0.0 < b) or (b < 0.0 < a):
        scratch[count] = a / (a - b)
        return count + 1
    return count


@borrowing_kernel
def sort(values, count):
    """Sort the first ``count`` values in place by insertion: they are few."""
    for i in range(1, count):
        value = values[i]
        j = i - 1
        while j >= 0 and values[j] > value:
            values[j + 1] = values[j]
            j -= 1
        values[j + 1] = value
