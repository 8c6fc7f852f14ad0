"""One inference: fuzzify, fire, aggregate, defuzzify. Control, pictures and exports all call ``evaluate``."""

import functools
import math

from fuzzy.kernels import defuzzify, firing, membership
from fuzzy.kernels.address import at, workspace_at
from fuzzy.kernels.jit import Kernel, borrowing_kernel, compiled_for, inlined_kernel, locking_kernel


@borrowing_kernel
def evaluate(address, x, y):
    """Run one inference.

    Args:
        address: Of a compiled system and its workspace, see ``fuzzy.kernels.address``.
        x: (n_in,) crisp inputs in their units; those outside their range count as its nearest end, unless it rejects
            them.
        y: (n_out,) in: the last outputs (for the hold policy); out: the crisp outputs. NaN where an input is not
            finite or is rejected: a wrong number never becomes a plausible output.

    Returns:
        How many rules fired; -1 where an input was not finite or was rejected.
    """
    return _evaluate(address, x, y)


@inlined_kernel
def _evaluate(address, x, y):
    if not membership.fuzzify(address, x):
        y[:] = math.nan
        return -1
    fired = firing.fire(address)
    defuzzify.aggregate(address, fired)
    defuzzify.defuzzify(address, y)
    return fired


@locking_kernel
def call(address, inputs):
    """Run one inference from Python, without an array among the arguments.

    Args:
        address: Of a compiled system and its workspace, which keeps the outputs for the hold policy.
        inputs: Tuple of the n_in crisp inputs.

    Returns:
        The first crisp output; all of them stand in ``workspace.output``. NaN where an input is not finite, and then
        the last outputs are kept.
    """
    workspace = workspace_at(address)
    for i in range(len(inputs)):
        if not math.isfinite(inputs[i]):
            return math.nan
        workspace.input[i] = inputs[i]
    evaluate(address, workspace.input, workspace.output)
    return workspace.output[0]


@functools.cache
def compiled_call(n_inputs: int) -> Kernel:
    """Return ``call`` compiled for this number of inputs."""
    return compiled_for(call, 0, (0.0,) * n_inputs)


@borrowing_kernel
def evaluate_rows(address, x, y, first, end):
    """Run independent inferences.

    Args:
        address: Of a compiled system and its workspace.
        x: (n, n_in) crisp inputs, one inference a row.
        y: (n, n_out) in: the last outputs of every row, for the hold policy; out: crisp outputs.
        first: First row to evaluate.
        end: The row after the last one.

    Returns:
        A row of which an input is not finite or is rejected, -1 for none.
    """
    refused = -1
    for i in range(first, end):
        if _evaluate(address, x[at(i)], y[at(i)]) < 0:
            refused = i
    return refused
