"""Aggregation and defuzzification: from firing strengths to crisp outputs."""

import math

from fuzzy.kernels import codes, curves, envelope, exact, linear, sampled, sets, weighted
from fuzzy.kernels.address import at, call_at, defuzzifier_at, outputs_at, rules_at, workspace_at
from fuzzy.kernels.jit import borrowing_kernel
from fuzzy.kernels.norms import MAX, PRODUCT, SUM

DEFUZZIFIERS = {
    codes.CLIPPED: exact.clipped_centroid,
    codes.SEPARATE: exact.separate_centroid,
    codes.ENVELOPE: exact.envelope_centroid,
    codes.QUADRATURE: envelope.centroid,
    codes.SAMPLED: sampled.centroid,
    codes.WEIGHTED_AVERAGE: weighted.average,
    codes.WEIGHTED_SUM: weighted.total,
    codes.LINEAR_CENTROID: linear.centroid,
    codes.LINEAR_BISECTOR: linear.bisector,
    codes.LINEAR_MAXIMA: linear.maximum,
    codes.CURVED_BISECTOR: curves.bisector,
    codes.CURVED_MAXIMA: curves.maximum,
    codes.SAMPLED_BISECTOR: sampled.bisector,
    codes.SAMPLED_MAXIMA: sampled.maximum,
    codes.POLYGON_CENTROID: sampled.polygon_centroid,
    codes.POLYGON_BISECTOR: sampled.polygon_bisector,
    codes.POLYGON_MAXIMA: sampled.polygon_maximum,
}
"""The kernel of each method: f(address, output) -> crisp output, NaN where it is undefined."""

TINY = 2.0**-500
"""Largest level below which an aggregated set is computed larger than it is."""
_GAIN = 2.0**450


@borrowing_kernel
def aggregate(address, fired):
    """Write the members of every output's aggregated set, and the level of every output term.

    Max aggregation needs the largest strength of each term only, since a norm is monotone; the sum of scaled sets
    needs the sum of strengths. Otherwise, as in the sum of clipped sets, every consequent of every rule that fires is
    a member of its own.

    Args:
        address: Of a compiled system and its workspace, see ``fuzzy.kernels.address``.
        fired: How many rules fire.
    """
    rules = rules_at(address)
    outputs = outputs_at(address)
    workspace = workspace_at(address)
    height = workspace.height
    member = workspace.member
    level = workspace.level
    n_members = workspace.member_count
    sums = outputs.aggregation[0] == SUM
    separate = outputs.grouping[0] == codes.EVERY_CONSEQUENT
    scalable = (sums or outputs.aggregation[0] == MAX) and outputs.implication[0] <= PRODUCT
    for output in range(n_members.size):
        start = rules.member_start[at(output)]
        for n in range(start, start + n_members[at(output)]):
            height[at(member[at(n)])] = 0.0
        n_members[at(output)] = 0
    for i in range(fired):
        rule = workspace.fired[at(i)]
        strength = workspace.strength[at(rule)]
        for c in range(rules.consequent_start[at(rule)], rules.consequent_start[at(rule + 1)]):
            k = rules.consequent_term[at(c)]
            before = height[at(k)]
            height[at(k)] = before + strength if sums else max(before, strength)
            if before == 0.0 or separate:
                output = rules.consequent_output[at(c)]
                n = rules.member_start[at(output)] + n_members[at(output)]
                # In the order of the terms: no sum over members depends on the order of the rules.
                while not separate and n > rules.member_start[at(output)] and member[at(n - 1)] > k:
                    member[at(n)] = member[at(n - 1)]
                    n -= 1
                member[at(n)] = k
                level[at(n)] = strength
                n_members[at(output)] += 1
    for output in range(n_members.size):
        largest = 0.0
        start = rules.member_start[at(output)]
        for n in range(start, start + n_members[at(output)]):
            if not separate:
                level[at(n)] = height[at(member[at(n)])]
            largest = max(largest, level[at(n)])
        workspace.gain[at(output)] = 1.0 if largest >= TINY or not scalable else _GAIN


@borrowing_kernel
def defuzzify(address, y):
    """Write every output's crisp value.

    Args:
        address: Of a compiled system and its workspace, see ``fuzzy.kernels.address``.
        y: (n_out,) in: the last outputs, kept by the hold policy; out: crisp outputs in their units.
    """
    outputs = outputs_at(address)
    workspace = workspace_at(address)
    for output in range(outputs.method.size):
        value = math.nan
        if workspace.member_count[at(output)] > 0:
            value = call_at(defuzzifier_at(address, output), address, output)
        workspace.undefined[at(output)] = int(math.isnan(value))
        if math.isnan(value):
            if outputs.no_fire[at(output)] != codes.HOLD:
                y[at(output)] = outputs.no_fire_value[at(output)]
        elif outputs.method[at(output)] == codes.WEIGHTED_AVERAGE or outputs.method[at(output)] == codes.WEIGHTED_SUM:
            y[at(output)] = value  # a Sugeno system's outputs may lie outside the range, as in other engines
        else:
            y[at(output)] = min(max(value, outputs.range[at(output), 0]), outputs.range[at(output), 1])


@borrowing_kernel
def output_set(address, output, u, degree):
    """Write the degrees of an aggregated output set.

    Args:
        address: Of a compiled system and its workspace, see ``fuzzy.kernels.address``.
        output: Number of the output.
        u: (n,) places in the universe.
        degree: (n,) out; above 1 possible where the sets are summed.
    """
    for i in range(u.size):
        degree[i] = sets.aggregated_degree(address, output, u[i], 1.0)
