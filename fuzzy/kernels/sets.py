"""The aggregated output set, point by point."""

from fuzzy.kernels import membership
from fuzzy.kernels.address import outputs_at, rules_at, workspace_at
from fuzzy.kernels.jit import borrowing_kernel
from fuzzy.kernels.norms import MIN, SUM


@borrowing_kernel
def implied(address, member, u, scale):
    """Return the degree at ``u`` of one member's implied set, times ``scale``."""
    outputs = outputs_at(address)
    workspace = workspace_at(address)
    k = workspace.member[member]
    degree = membership.degree(outputs.shape[k], outputs.parameter[k], u)
    level = workspace.level[member]
    # A level may be so small that the product of the two underflows: the scale comes first.
    return scale * min(level, degree) if outputs.implication[0] == MIN else scale * level * degree


@borrowing_kernel
def aggregated_degree(address, output, u, scale):
    """Return the degree at ``u`` of the aggregated set (paper eqs. (31), (32)), times ``scale``."""
    outputs = outputs_at(address)
    rules = rules_at(address)
    workspace = workspace_at(address)
    start = rules.member_start[output]
    total = 0.0
    for n in range(start, start + workspace.member_count[output]):
        degree = implied(address, n, u, scale)
        total = total + degree if outputs.aggregation[0] == SUM else max(total, degree)
    return total
