"""Aggregation and defuzzification: from firing strengths to crisp outputs."""

from fuzzy.kernels import exact, membership, norms, quadrature
from fuzzy.kernels import tables as codes
from fuzzy.kernels.address import tables_at, workspace_at
from fuzzy.kernels.jit import kernel

_IMPLICATION = codes.IMPLICATION
_AGGREGATION = codes.AGGREGATION
_SAMPLES = codes.SAMPLES
_SAMPLING = codes.SAMPLING


@kernel
def aggregate(address, fired):
    """Write the aggregated strength of every output term into ``workspace.height``.

    The largest strength under max aggregation, since a norm is monotone; the sum under sum aggregation, where only
    the product's set depends on it alone.
    """
    tables = tables_at(address)
    workspace = workspace_at(address)
    workspace.height[:] = 0.0
    sums = tables.options[_AGGREGATION] == norms.SUM
    for i in range(fired):
        rule = workspace.fired[i]
        strength = workspace.strength[rule]
        for c in range(tables.consequent_start[rule], tables.consequent_start[rule + 1]):
            k = tables.consequent_term[c]
            if sums:
                workspace.height[k] += strength
            elif strength > workspace.height[k]:
                workspace.height[k] = strength


@kernel
def aggregated_degree(address, fired, output, u):
    """Return the degree of the aggregated output set at ``u`` (paper eqs. (31), (32)); above 1 possible for sums."""
    tables = tables_at(address)
    workspace = workspace_at(address)
    if tables.options[_AGGREGATION] != norms.SUM:
        return quadrature.leading(address, output, u)[0]
    total = 0.0
    for i in range(fired):
        rule = workspace.fired[i]
        for c in range(tables.consequent_start[rule], tables.consequent_start[rule + 1]):
            k = tables.consequent_term[c]
            if tables.output_start[output] <= k < tables.output_start[output + 1]:
                degree = membership.degree(tables.output_shape[k], tables.output_parameter[k], u)
                total += norms.t_norm(tables.options[_IMPLICATION], workspace.strength[rule], degree)
    return total


@kernel
def _sampled_moments(address, fired, output):
    """Add Σ μ and Σ u μ over the samples (paper eq. (34)), u about the middle of the range."""
    tables = tables_at(address)
    workspace = workspace_at(address)
    low = tables.output_range[output, 0]
    high = tables.output_range[output, 1]
    n = tables.options[_SAMPLES]
    origin = 0.5 * (low + high)
    for i in range(n):
        if tables.options[_SAMPLING] == codes.ENDPOINTS:
            u = low + i * (high - low) / (n - 1)
        else:
            u = low + (i + 0.5) * (high - low) / n
        degree = aggregated_degree(address, fired, output, u)
        workspace.moments[0] += degree
        workspace.moments[1] += degree * (u - origin)


@kernel
def output_moments(address, fired, output):
    """Write area and first moment, about the middle of the range, of one aggregated set into ``workspace.moments``."""
    tables = tables_at(address)
    workspace = workspace_at(address)
    moments = workspace.moments
    moments[:] = 0.0
    method = tables.method[output]
    if method == codes.CLIPPED:
        exact.clipped_moments(address, output)
    elif method == codes.SEPARATE:
        exact.separate_moments(address, fired, output)
    elif method == codes.ENVELOPE:
        exact.envelope_moments(address, output)
    elif method == codes.QUADRATURE:
        quadrature.curved_moments(address, output)
    else:
        _sampled_moments(address, fired, output)


@kernel
def defuzzify(address, fired, y):
    """Write the centroid of every output's aggregated set.

    Args:
        address: Of a compiled system and its workspace, see ``fuzzy.kernels.address``.
        fired: How many rules fire.
        y: (n_out,) in: the last outputs, kept by the hold policy; out: crisp outputs in their units.

    References:
        Paper eq. (34), there called COA; IEC 61131-7:2000, CoG.
    """
    tables = tables_at(address)
    workspace = workspace_at(address)
    for output in range(y.size):
        any_fired = False
        for k in range(tables.output_start[output], tables.output_start[output + 1]):
            any_fired = any_fired or workspace.height[k] > 0.0
        if any_fired:
            output_moments(address, fired, output)
            area = workspace.moments[0]
            if area > 0.0:
                low = tables.output_range[output, 0]
                high = tables.output_range[output, 1]
                centre = 0.5 * (low + high) + workspace.moments[1] / area
                y[output] = min(max(centre, low), high)
                continue
        if tables.no_fire[output] != codes.HOLD:
            y[output] = tables.no_fire_value[output]


@kernel
def output_set(address, fired, output, u, degree):
    """Write the degrees of an aggregated output set at the places ``u`` (n,) into ``degree`` (n,).

    Args:
        address: Of a compiled system and its workspace, see ``fuzzy.kernels.address``.
        fired: How many rules fired in that inference.
        output: Number of the output.
        u: (n,) places in the universe.
        degree: (n,) out.
    """
    for i in range(u.size):
        degree[i] = aggregated_degree(address, fired, output, u[i])
