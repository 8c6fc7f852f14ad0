"""How much the rules take part over many inputs, read from the workspace after each inference."""

from fuzzy.kernels.address import workspace_at
from fuzzy.kernels.inference import evaluate
from fuzzy.kernels.jit import kernel


@kernel
def observe(address, x, y, concludes, greatest, total, count, speaks):
    """Run many inferences and sum up the firing strengths.

    Args:
        address: Of a compiled system and its workspace, see ``fuzzy.kernels.address``.
        x: (n, n_in) crisp inputs, finite, one inference a row.
        y: (n_out,) scratch for the crisp outputs.
        concludes: (n_rules, n_out) whether a rule has a consequent on an output.
        greatest: (n_rules,) in: zeros; out: greatest firing strength.
        total: (n_rules,) in: zeros; out: sum of the firing strengths.
        count: (n_rules,) in: zeros; out: in how many rows the rule fires.
        speaks: (n, n_out) in: False; out: whether a rule that fires in the row concludes on the output.
    """
    for i in range(x.shape[0]):
        evaluate(address, x[i], y)
        strength = workspace_at(address).strength
        for rule in range(strength.size):
            if strength[rule] > 0.0:
                greatest[rule] = max(greatest[rule], strength[rule])
                total[rule] += strength[rule]
                count[rule] += 1
                for output in range(concludes.shape[1]):
                    if concludes[rule, output]:
                        speaks[i, output] = True


@kernel
def strengths(address, x, y, out):
    """Run many inferences and keep the firing strengths.

    Args:
        address: Of a compiled system and its workspace.
        x: (n, n_in) crisp inputs, finite, one inference a row.
        y: (n_out,) scratch for the crisp outputs.
        out: (n, n_rules) out: firing strengths.
    """
    for i in range(x.shape[0]):
        evaluate(address, x[i], y)
        out[i] = workspace_at(address).strength
