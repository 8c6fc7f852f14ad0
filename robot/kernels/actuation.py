"""From actuator forces to generalized forces and back, in the two readings of the paper's force matrix.

The forces are tau = [F11, F21, F12, F22, ...] (N): first digit the actuator, second the module; positive forces push
the module longer. Both readings are invertible in every configuration (det = product of l), here by recursion from
the tip. Compiled with numba, as all kernels are (``fuzzy.kernels.jit``).
"""

from __future__ import annotations

from fuzzy.kernels.jit import inlined_kernel
from robot.kernels.dynamics import Array, Parameters, Workspace

INTERNAL = 0
"""A force on rod i reacts on rod i-1: Q is the sum of force times the rate of the actuator's length."""

PAPER = 1
"""A force on rod i reacts on the ground, equation (14)."""


@inlined_kernel
def generalized_force(arm: Parameters, reading: int, q: Array, tau: Array, work: Workspace, Q: Array) -> None:
    """Write Q (2N,) = F_coeff(q) tau. Needs ``directions(q, work)``."""
    n = arm.mass.size
    if reading == INTERNAL:
        for k in range(n):
            Q[k] = tau[2 * k] + tau[2 * k + 1]
            Q[n + k] = arm.half_rod[k] * (tau[2 * k] - tau[2 * k + 1])
        return
    # The tail's pushes add up to one force vector f; its moment about each link's start turns every joint before it.
    f1 = 0.0
    f3 = 0.0
    moment = 0.0
    for k in range(n - 1, -1, -1):
        sine = work.sine[k]
        cosine = work.cosine[k]
        moment += arm.half_rod[k] * (tau[2 * k] - tau[2 * k + 1])
        Q[n + k] = moment
        push = tau[2 * k] + tau[2 * k + 1]
        f1 += push * sine
        f3 += push * cosine
        Q[k] = f1 * sine + f3 * cosine
        moment += q[k] * (f1 * cosine - f3 * sine)


@inlined_kernel
def actuator_forces(arm: Parameters, reading: int, q: Array, Q: Array, work: Workspace, tau: Array) -> None:
    """Write the tau (2N,) that gives F_coeff(q) tau = Q. Needs ``directions(q, work)``."""
    n = arm.mass.size
    f1 = 0.0
    f3 = 0.0
    moment = 0.0
    for k in range(n - 1, -1, -1):
        push = Q[k]
        torque = Q[n + k]
        if reading == PAPER:
            sine = work.sine[k]
            cosine = work.cosine[k]
            torque -= moment
            push -= f1 * sine + f3 * cosine
            f1 += push * sine
            f3 += push * cosine
            moment += torque + q[k] * (f1 * cosine - f3 * sine)
        half = 0.5 * torque / arm.half_rod[k]
        tau[2 * k] = 0.5 * push + half
        tau[2 * k + 1] = 0.5 * push - half
