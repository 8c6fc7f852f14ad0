"""One inference: fuzzify, fire, aggregate, defuzzify. Control, pictures and exports all call ``evaluate``."""

import math

import numba

from fuzzy.kernels import defuzzify, firing, membership
from fuzzy.kernels.address import workspace_at
from fuzzy.kernels.jit import kernel, locking_kernel, parallel_kernel


@kernel
def evaluate(address, x, y):
    """Run one inference.

    Args:
        address: Of a compiled system and its workspace, see ``fuzzy.kernels.address``.
        x: (n_in,) crisp inputs in their units.
        y: (n_out,) in: the last outputs (for the hold policy); out: the crisp outputs. NaN where an input is not
            finite: a wrong number never becomes a plausible output.

    Returns:
        How many rules fired.
    """
    for i in range(x.size):
        if not math.isfinite(x[i]):
            y[:] = math.nan
            return 0
    membership.fuzzify(address, x)
    fired = firing.fire(address)
    defuzzify.aggregate(address, fired)
    defuzzify.defuzzify(address, fired, y)
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
        The crisp output.
    """
    workspace = workspace_at(address)
    workspace.input[0] = first
    workspace.input[1] = second
    evaluate(address, workspace.input, workspace.output)
    return workspace.output[0]


@parallel_kernel
def evaluate_batch(addresses, x, y):
    """Run independent inferences in parallel.

    Args:
        addresses: (n_parts,) of the compiled system with a workspace for each of as many parts of the rows.
        x: (n, n_in) crisp inputs, one inference a row.
        y: (n, n_out) in: the last outputs of every row, for the hold policy; out: crisp outputs.
    """
    n = x.shape[0]
    parts = addresses.size
    for part in numba.prange(parts):
        for i in range(part * n // parts, (part + 1) * n // parts):
            evaluate(addresses[part], x[i], y[i])
