"""How much each rule that fires moved an output: Shapley values over the rules."""

import math

from fuzzy.kernels import defuzzify, firing, membership
from fuzzy.kernels.address import workspace_at
from fuzzy.kernels.jit import kernel


@kernel
def share_out(address, x, output, start, base, order, weight, value, rule, moved, total):
    """Share out every row's output among the rules that fire there.

    A player is one of the strongest rules, or all weaker ones together. Each gets the mean, over all orders in which
    the players may come, of how far the output moves when it comes; together they get output - base.

    Args:
        address: Of a compiled system and its workspace, see ``fuzzy.kernels.address``.
        x: (n, n_in) crisp inputs, one inference a row.
        output: Number of the output.
        start: (n_out,) what the outputs are when no rule fires.
        base: The same of this output, finite.
        order: (n_rules,) scratch, whole numbers.
        weight: (most + 2, most + 1) of a coalition, by the number of players and its size.
        value: (2 ** (most + 1),) scratch.
        rule: (n, most + 1) out: numbers of the strongest rules, -1 for none, -2 for all the others.
        moved: (n, most + 1) out: how far each moved the output.
        total: (n,) out: the output; NaN where an input is not finite, ``base`` where no rule fires.
    """
    workspace = workspace_at(address)
    most = rule.shape[1] - 1
    y = start.copy()
    for row in range(x.shape[0]):
        rule[row] = -1
        moved[row] = 0.0
        if not membership.fuzzify(address, x[row]):
            total[row] = math.nan
            continue
        count = firing.fire(address)
        for i in range(count):  # by strength, descending
            number = workspace.fired[i]
            k = i
            while k > 0 and workspace.strength[order[k - 1]] < workspace.strength[number]:
                order[k] = order[k - 1]
                k -= 1
            order[k] = number
        players = min(count, most + 1)
        for i in range(min(count, most)):
            rule[row, i] = order[i]
        if count > most:
            rule[row, most] = order[most] if count == most + 1 else -2
        for coalition in range(1 << players):
            n = 0
            for i in range(count):
                if coalition >> min(i, most) & 1:
                    workspace.fired[n] = order[i]
                    n += 1
            defuzzify.aggregate(address, n)
            y[:] = start
            defuzzify.defuzzify(address, y)
            value[coalition] = base if math.isnan(y[output]) else y[output]
        for i in range(count):  # as the next inference expects them
            workspace.fired[i] = order[i]
        for coalition in range(1 << players):
            size = 0
            for i in range(players):
                size += coalition >> i & 1
            for i in range(players):
                if not coalition >> i & 1:
                    gain = value[coalition | 1 << i] - value[coalition]
                    moved[row, i] += weight[players, size] * gain
        total[row] = value[(1 << players) - 1]
