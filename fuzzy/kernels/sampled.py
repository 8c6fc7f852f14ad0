"""Defuzzification over samples of the aggregated set, as other engines do it.

Each sample has a place and a weight, see ``fuzzy.compiler``: that is all in which the sampling rules differ, but for
the polygon through the samples. There every set is straight between two samples, and so is the aggregated set between
two points of the polygon: the samples, and where an implication bends a set. It is not straight in truth where two sets
cross, which other engines leave out.
"""

import math

from fuzzy.kernels import membership, norms, pieces, sets
from fuzzy.kernels.address import outputs_at, rules_at, workspace_at
from fuzzy.kernels.exact import sort
from fuzzy.kernels.jit import addressed_kernel, borrowing_kernel

_SAME = 1e-12
"""Difference of two degrees that count as the same, as a share of the greater one."""


@addressed_kernel
def centroid(address, output):
    """Return Σ u μ(u) / Σ μ(u) over the samples (paper eq. (34)).

    Args:
        address: Of a compiled system and its workspace, see ``fuzzy.kernels.address``.
        output: Number of the output.

    Returns:
        The crisp output; NaN where no sample has a degree above 0.
    """
    outputs = outputs_at(address)
    scale = workspace_at(address).gain[output]
    middle = 0.5 * (outputs.range[output, 0] + outputs.range[output, 1])  # moments about it cancel least
    area = 0.0
    moment = 0.0
    for i in range(outputs.sample_start[output], outputs.sample_start[output + 1]):
        u = outputs.sample[i, 0]
        degree = outputs.sample[i, 1] * sets.aggregated_degree(address, output, u, scale)
        area += degree
        moment += degree * (u - middle)
    return middle + moment / area if area > 0.0 else math.nan


@addressed_kernel
def bisector(address, output):
    """Return the first sample at which the sum of degrees reaches half of the whole; between two, if it is just half.

    Args:
        address: Of a compiled system and its workspace, see ``fuzzy.kernels.address``.
        output: Number of the output.
    """
    outputs = outputs_at(address)
    scale = workspace_at(address).gain[output]
    start = outputs.sample_start[output]
    end = outputs.sample_start[output + 1]
    area = 0.0
    for i in range(start, end):
        area += outputs.sample[i, 1] * sets.aggregated_degree(address, output, outputs.sample[i, 0], scale)
    if not area > 0.0:
        return math.nan
    found = 0.0
    half = math.nan
    for i in range(start, end):
        degree = outputs.sample[i, 1] * sets.aggregated_degree(address, output, outputs.sample[i, 0], scale)
        if not math.isnan(half) and degree > 0.0:
            return 0.5 * (half + outputs.sample[i, 0])
        found += degree
        if found > 0.5 * area * (1.0 + _SAME):
            return outputs.sample[i, 0]
        if found >= 0.5 * area * (1.0 - _SAME) and math.isnan(half):
            half = outputs.sample[i, 0]
    return half


@addressed_kernel
def maximum(address, output):
    """Return the mean, first, last, nearest to 0 or farthest from 0 of the samples of the largest degree.

    Args:
        address: Of a compiled system and its workspace, see ``fuzzy.kernels.address``.
        output: Number of the output.
    """
    outputs = outputs_at(address)
    account = workspace_at(address).scratch[: pieces.ACCOUNT]
    scale = workspace_at(address).gain[output]
    pieces.begin(account, pieces.TOP)
    for i in range(outputs.sample_start[output], outputs.sample_start[output + 1]):
        u = outputs.sample[i, 0]
        degree = sets.aggregated_degree(address, output, u, scale)
        pieces.add(account, pieces.TOP, 0.0, u, u, degree, degree)
    return pieces.top(account, outputs.maximum[0])


@addressed_kernel
def polygon_centroid(address, output):
    """Return the centroid of the polygon.

    Args:
        address: Of a compiled system and its workspace, see ``fuzzy.kernels.address``.
        output: Number of the output.
    """
    outputs = outputs_at(address)
    account = workspace_at(address).scratch[: pieces.ACCOUNT]
    _follow_polygon(address, output, pieces.AREA)
    return pieces.centre(account, 0.5 * (outputs.range[output, 0] + outputs.range[output, 1]))


@addressed_kernel
def polygon_bisector(address, output):
    """Return the place that halves the area of the polygon; the middle of a gap that does.

    Args:
        address: Of a compiled system and its workspace, see ``fuzzy.kernels.address``.
        output: Number of the output.
    """
    account = workspace_at(address).scratch[: pieces.ACCOUNT]
    _follow_polygon(address, output, pieces.AREA)
    if not pieces.aim(account):
        return math.nan
    _follow_polygon(address, output, pieces.HALF)
    return account[pieces.PLACE]


@addressed_kernel
def polygon_maximum(address, output):
    """Return the mean, first, last, nearest to 0 or farthest from 0 of the polygon's points of the largest degree.

    Args:
        address: Of a compiled system and its workspace, see ``fuzzy.kernels.address``.
        output: Number of the output.
    """
    _follow_polygon(address, output, pieces.TOP)
    return pieces.top(workspace_at(address).scratch[: pieces.ACCOUNT], outputs_at(address).maximum[0])


@borrowing_kernel
def _follow_polygon(address, output, question):
    """Enter the polygon into the account at the beginning of ``scratch``; for its maxima, its points only.

    Behind the account stand the degrees of the members' terms at both ends of the present interval, two numbers each,
    and behind these the bends.
    """
    outputs = outputs_at(address)
    workspace = workspace_at(address)
    start = rules_at(address).member_start[output]
    count = workspace.member_count[output]
    code = outputs.implication[0]
    origin = 0.5 * (outputs.range[output, 0] + outputs.range[output, 1])
    account = workspace.scratch[: pieces.ACCOUNT]
    degrees = workspace.scratch[pieces.ACCOUNT : pieces.ACCOUNT + 2 * count]
    bends = workspace.scratch[pieces.ACCOUNT + 2 * count :]
    pieces.begin(account, question)
    first = outputs.sample_start[output]
    for i in range(first, outputs.sample_start[output + 1]):
        end = outputs.sample[i, 0]
        begin = outputs.sample[max(i - 1, first), 0]
        for m in range(count):
            k = workspace.member[start + m]
            degrees[2 * m] = degrees[2 * m + 1]
            degrees[2 * m + 1] = membership.degree(outputs.shape[k], outputs.parameter[k], outputs.value, end)
        if i == first:
            _enter_point(account, question, end, _aggregated(address, output, degrees, 1.0))
            continue
        n_bends = 0
        for m in range(count):
            level = norms.bend_level(code, workspace.level[start + m])
            if min(degrees[2 * m], degrees[2 * m + 1]) < level < max(degrees[2 * m], degrees[2 * m + 1]):
                bends[n_bends] = (level - degrees[2 * m]) / (degrees[2 * m + 1] - degrees[2 * m])
                n_bends += 1
        sort(bends, n_bends)
        bends[n_bends] = 1.0
        x0 = begin
        y0 = _aggregated(address, output, degrees, 0.0)
        for b in range(n_bends + 1):
            x1 = begin + bends[b] * (end - begin)
            y1 = _aggregated(address, output, degrees, bends[b])
            if question == pieces.TOP:
                _enter_point(account, question, x1, y1)
            elif x1 > x0:
                pieces.add(account, question, origin, x0, x1, y0, y1)
            x0 = x1
            y0 = y1


@borrowing_kernel
def _enter_point(account, question, u, degree):
    if question == pieces.TOP:
        pieces.add(account, question, 0.0, u, u, degree, degree)


@borrowing_kernel
def _aggregated(address, output, degrees, share):
    """Return the degree of the aggregated set at a share of an interval in which every set is straight."""
    outputs = outputs_at(address)
    workspace = workspace_at(address)
    code = outputs.implication[0]
    start = rules_at(address).member_start[output]
    total = 0.0
    for m in range(degrees.size // 2):
        degree = (1.0 - share) * degrees[2 * m] + share * degrees[2 * m + 1]
        degree = sets.imply(code, workspace.level[start + m], degree, workspace.gain[output])
        total = sets.join(outputs.aggregation[0], total, degree) if m > 0 else degree
    return total
