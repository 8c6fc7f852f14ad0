"""The aggregated output set, point by point."""

from fuzzy.kernels import membership, norms
from fuzzy.kernels.address import at, outputs_at, rules_at, workspace_at
from fuzzy.kernels.jit import borrowing_kernel, inlined_kernel
from fuzzy.kernels.norms import LEAST, MAX, MIN, PRODUCT, SUM


@inlined_kernel
def implied(address, member, u, scale):
    """Return the degree at ``u`` of one member's implied set, times ``scale``."""
    outputs = outputs_at(address)
    workspace = workspace_at(address)
    k = workspace.member[at(member)]
    degree = membership.degree(outputs.shape[at(k)], outputs.parameter[at(k)], outputs.value, u)
    level = workspace.level[at(member)]
    code = outputs.implication[0]
    return imply(code, level, degree, scale)


@borrowing_kernel
def imply(code, level, degree, scale):
    """Return what a rule of strength ``level`` makes of a degree of its consequent's set, times ``scale``."""
    # A level may be so small that the product of the two underflows: the scale comes first.
    if code == MIN:
        return scale * min(level, degree)
    if code == PRODUCT:
        return scale * level * degree
    return scale * norms.implication(code, level, degree)


@borrowing_kernel
def aggregated_degree(address, output, u, scale):
    """Return the degree at ``u`` of the aggregated set (paper eqs. (31), (32)), times ``scale``.

    The scale must be 1 unless the aggregation is max, sum or the minimum.
    """
    rules = rules_at(address)
    workspace = workspace_at(address)
    start = rules.member_start[output]
    return joined(address, start, start + workspace.member_count[output], u, scale)


@borrowing_kernel
def joined(address, start, end, u, scale):
    """Return the degree at ``u`` of the aggregate of the members ``start`` to ``end``, times ``scale``."""
    code = outputs_at(address).aggregation[0]
    if end <= start:
        return 0.0
    total = implied(address, start, u, scale)
    for n in range(start + 1, end):
        total = join(code, total, implied(address, n, u, scale))
    return total


@borrowing_kernel
def join(code, total, degree):
    """Return the aggregate of two degrees."""
    if code == MAX:
        return max(total, degree)
    if code == SUM:
        return total + degree
    if code == LEAST:
        return min(total, degree)
    return norms.aggregation(code, total, degree)
