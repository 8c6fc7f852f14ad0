"""One inference: fuzzify, fire, aggregate, defuzzify. Control, pictures and exports all call ``evaluate``."""

import math

from fuzzy.kernels import defuzzify, firing, membership
from fuzzy.kernels.address import workspace_at
from fuzzy.kernels.jit import borrowing_kernel, locking_kernel


@borrowing_kernel
def evaluate(address, x, y):
    """Run one inference.

    Args:
        address: Of a compiled system and its workspace, see ``fuzzy.kernels.address``.
        x: (n_in,) crisp inputs in their units; those outside their range count as its nearest end, also where
            ``Controller`` would refuse them.
        y: (n_out,) in: the last outputs (for the hold policy); out: the crisp outputs. NaN where an input is not
            finite: a wrong number never becomes a plausible output.

    Returns:
        How many rules fired; -1 where an input was not finite.
    """
    if not membership.fuzzify(address, x):
        y[:] = math.nan
        return -1
    fired = firing.fire(address)
    defuzzify.aggregate(address, fired)
    defuzzify.defuzzify(address, y)
    return fired


@locking_kernel
def call(address, x, y):
    """Run ``evaluate`` from Python."""
    return evaluate(address, x, y)


@locking_kernel
def call_two(address: int, first: float, second: float) -> float:
    """Run one inference of a system with two inputs and one output, without an array among the arguments.

    Args:
        address: Of a compiled system and its workspace; the workspace keeps the last output for the hold policy.
        first: First crisp input.
        second: Second crisp input.

    Returns:
        The crisp output; NaN where an input is not finite, and then the last output is kept.
    """
    workspace = workspace_at(address)
    last = workspace.output[0]
    workspace.input[0] = first
    workspace.input[1] = second
    fired = evaluate(address, workspace.input, workspace.output)
    if fired < 0:
        workspace.output[0] = last
        return math.nan
    return workspace.output[0]


@borrowing_kernel
def evaluate_rows(address, x, y, first, end):
    """Run independent inferences.

    Args:
        address: Of a compiled system and its workspace.
        x: (n, n_in) crisp inputs, one inference a row.
        y: (n, n_out) in: the last outputs of every row, for the hold policy; out: crisp outputs.
        first: First row to evaluate.
        end: The row after the last one.
    """
    for i in range(first, end):
        evaluate(address, x[i], y[i])
