"""Defuzzification over samples of the aggregated set, as other engines do it.

Each sample has a place and a weight, see ``fuzzy.compiler``: that is all in which the sampling rules differ.
"""

import math

from fuzzy.kernels import pieces, sets
from fuzzy.kernels.address import outputs_at, workspace_at
from fuzzy.kernels.jit import addressed_kernel

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
