"""Defuzzification over samples of the aggregated set, as other engines do it."""

import math

from fuzzy.kernels import sets
from fuzzy.kernels import tables as codes
from fuzzy.kernels.address import outputs_at, workspace_at
from fuzzy.kernels.jit import addressed_kernel


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
    low = outputs.range[output, 0]
    high = outputs.range[output, 1]
    n = outputs.sampling[0]
    middle = 0.5 * (low + high)  # moments are taken about it: there they cancel least
    area = 0.0
    moment = 0.0
    for i in range(n):
        if outputs.sampling[1] == codes.ENDPOINTS:
            u = low + i * (high - low) / (n - 1)
        else:
            u = low + (i + 0.5) * (high - low) / n
        degree = sets.aggregated_degree(address, output, u, scale)
        area += degree
        moment += degree * (u - middle)
    return middle + moment / area if area > 0.0 else math.nan
