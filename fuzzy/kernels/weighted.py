"""Outputs without an aggregated set: the values of their terms, weighted by how far the rules activate them.

References:
    Takagi, Sugeno, "Fuzzy Identification of Systems and Its Applications", 1985; Tsukamoto, "An Approach to Fuzzy
    Reasoning Method", 1979; IEC 61131-7:2000, centre of gravity for singletons.
"""

import math

from fuzzy.kernels import codes, places
from fuzzy.kernels.address import outputs_at, rules_at, workspace_at
from fuzzy.kernels.jit import addressed_kernel, borrowing_kernel


@borrowing_kernel
def term_value(address, output, k, level):
    """Return what a term says the output is, where rules activate it to ``level``.

    The peak of a set or the place of a singleton; a linear function of the inputs within their ranges (Takagi and
    Sugeno); or, of a monotone set, the place of degree ``level`` (Tsukamoto).
    """
    outputs = outputs_at(address)
    if not math.isnan(outputs.peak[k]):
        return outputs.peak[k]
    p = outputs.parameter[k]
    if outputs.shape[k] != codes.LINEAR:
        low = outputs.range[output, 0]
        high = outputs.range[output, 1]
        return places.inverse(outputs.shape[k], p, outputs.value, level, low, high)
    clamped = workspace_at(address).clamped
    first = int(p[0])
    value = outputs.value[first + clamped.size]
    for i in range(clamped.size):
        value += outputs.value[first + i] * clamped[i]
    return value


@addressed_kernel
def average(address, output):
    """Return Σ w z / Σ w over the members of an output.

    Args:
        address: Of a compiled system and its workspace, see ``fuzzy.kernels.address``.
        output: Number of the output.
    """
    workspace = workspace_at(address)
    gain = workspace.gain[output]
    start = rules_at(address).member_start[output]
    weight = 0.0
    moment = 0.0
    for n in range(start, start + workspace.member_count[output]):
        level = workspace.level[n]
        weight += gain * level
        moment += gain * level * term_value(address, output, workspace.member[n], level)
    return moment / weight if weight > 0.0 else math.nan


@addressed_kernel
def total(address, output):
    """Return Σ w z over the members of an output.

    Args:
        address: Of a compiled system and its workspace, see ``fuzzy.kernels.address``.
        output: Number of the output.
    """
    workspace = workspace_at(address)
    start = rules_at(address).member_start[output]
    moment = 0.0
    for n in range(start, start + workspace.member_count[output]):
        level = workspace.level[n]
        moment += level * term_value(address, output, workspace.member[n], level)
    return moment
