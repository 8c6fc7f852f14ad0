"""Figures of merit from a ring of control steps, so that a run need not be kept.

Compiled as ``fuzzy.kernels.jit`` says; definitions as in :mod:`robot.metrics`.
"""

from __future__ import annotations

from typing import NamedTuple

from fuzzy.kernels.jit import inlined_kernel
from robot.kernels.dynamics import Array


class Tally(NamedTuple):
    """What is known of a run so far, (2N,) each."""

    peak: Array
    """Largest y = (q - q0) / A."""
    unsettled: Array
    """Number of the first control step after the last one with |y - 1| above the settling band."""
    final: Array
    """Sum of e / scale over the last part of the run."""
    square: Array
    """Sum of (e / scale)² by the trapezoidal rule."""
    force: Array
    """Largest |F| of every actuator, N."""


@inlined_kernel
def tally(
    q: Array,
    reference: Array,
    forces: Array,
    first: int,
    count: int,
    final: int,
    last: int,
    band: float,
    start: Array,
    amplitude: Array,
    scale: Array,
    totals: Tally,
) -> None:
    """Add control steps ``first`` to ``first + count`` to the totals.

    Args:
        q: (rows, 2N) ring of positions; step k is in row k modulo the number of rows.
        reference: (rows, 2N) qd, likewise.
        forces: (rows, 2N) actuator forces, likewise.
        first: Number of the first step.
        count: Number of steps, at most that of the rows.
        final: From which step on errors count as steady-state errors.
        last: Number of the run's last step.
        band: Of settling.
        start: (2N,) q0.
        amplitude: (2N,) A; coordinates with 0 have no y.
        scale: (2N,) what errors are divided by.
        totals: In and out.
    """
    rows = q.shape[0]
    for k in range(first, first + count):
        row = k % rows
        for i in range(start.size):
            e = (reference[row, i] - q[row, i]) / scale[i]
            totals.square[i] += (0.5 if k in (0, last) else 1.0) * e * e
            if k >= final:
                totals.final[i] += e
            totals.force[i] = max(totals.force[i], abs(forces[row, i]))
            if amplitude[i] != 0.0:
                y = (q[row, i] - start[i]) / amplitude[i]
                totals.peak[i] = max(totals.peak[i], y)
                if abs(y - 1.0) > band:
                    totals.unsettled[i] = k + 1.0
