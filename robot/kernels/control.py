"""One control step: reference, control law, actuator forces within their limits, conditional integral."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from fuzzy.kernels.jit import kernel
from robot.controllers.base import ACCELERATION, FORCE, Law
from robot.kernels import actuation, dynamics
from robot.kernels.dynamics import Array, Parameters, Workspace
from robot.kernels.jit import borrowing_kernel

STEP = 0
SINUS = 1
"""Kinds of reference."""


class ReferenceArrays(NamedTuple):
    """qd(t) = start + amplitude · f(t), with f = 1 or f = sin(rate · t)."""

    kind: int
    start: Array
    """(2N,) m and rad."""
    amplitude: Array
    """(2N,) m and rad."""
    rate: float
    """rad/s."""


class Signals(NamedTuple):
    """Everything a control step reads and writes, one entry a coordinate."""

    reference: Array
    """(2N,) qd."""
    dreference: Array
    """(2N,) d(qd)/dt."""
    ddreference: Array
    """(2N,)."""
    e: Array
    """(2N,) qd - q."""
    de: Array
    """(2N,)."""
    x: Array
    """(2N, 2) inputs of the fuzzy blocks."""
    block: Array
    """(1,) output of one block."""
    v: Array
    """(2N,) acceleration asked of the linearized arm."""
    Q: Array
    """(2N,) generalized force asked for."""
    wanted: Array
    """(2N,) actuator forces before the limits."""
    tau: Array
    """(2N,) actuator forces."""


@kernel
def new_signals(size: int) -> Signals:
    """Return memory for the control steps of an arm with ``size`` coordinates; allocate it once a run."""
    return Signals(
        np.zeros(size),
        np.zeros(size),
        np.zeros(size),
        np.zeros(size),
        np.zeros(size),
        np.zeros((size, 2)),
        np.zeros(1),
        np.zeros(size),
        np.zeros(size),
        np.zeros(size),
        np.zeros(size),
    )


@borrowing_kernel
def observe(reference: ReferenceArrays, time: float, q: Array, dq: Array, signals: Signals) -> None:
    """Write the reference at ``time`` (s) with its two derivatives, and the errors e and de."""
    value = 1.0
    first = 0.0
    second = 0.0
    if reference.kind == SINUS:
        angle = reference.rate * time
        value = math.sin(angle)
        first = reference.rate * math.cos(angle)
        second = -reference.rate * reference.rate * value
    for i in range(q.size):
        amplitude = reference.amplitude[i]
        signals.reference[i] = reference.start[i] + amplitude * value
        signals.dreference[i] = amplitude * first
        signals.ddreference[i] = amplitude * second
        signals.e[i] = signals.reference[i] - q[i]
        signals.de[i] = signals.dreference[i] - dq[i]


@borrowing_kernel
def control(
    law: Law,
    model: Parameters,
    q: Array,
    dq: Array,
    integral: Array,
    output: Array,
    work: Workspace,
    signals: Signals,
) -> None:
    """Write the generalized force Q of the law; see :class:`robot.controllers.base.Law` for the equations.

    Needs ``observe`` and ``directions(q, work)``.

    Args:
        law: Gains.
        model: The arm as the controller believes it to be.
        q: (2N,) position.
        dq: (2N,) velocity.
        integral: (2N,) ∫e dt.
        output: (2N,) outputs T of the fuzzy blocks for this error.
        work: Directions in, the rest overwritten.
        signals: Reference and errors in; v and Q out.
    """
    size = q.size
    if law.linearizing:
        for i in range(size):
            signals.v[i] = signals.ddreference[i] + _sum(law, ACCELERATION, i, signals, integral, output)
        dynamics.inverse_dynamics(model, q, dq, signals.v, work, signals.Q)
    else:
        for i in range(size):
            signals.Q[i] = 0.0
    for i in range(size):
        signals.Q[i] += _sum(law, FORCE, i, signals, integral, output)


@borrowing_kernel
def _sum(law: Law, level: int, i: int, signals: Signals, integral: Array, output: Array) -> float:
    total = law.Kp[level, i] * signals.e[i] + law.Kd[level, i] * signals.de[i] + law.Ki[level, i] * integral[i]
    if law.fuzzy:
        total += law.GU[level, i] * law.output_scale * output[i]
    return total


@borrowing_kernel
def actuate(
    model: Parameters, reading: int, lower: float, upper: float, q: Array, work: Workspace, signals: Signals
) -> None:
    """Write the actuator forces that give Q, cut off at the limits. Needs ``directions(q, work)``."""
    actuation.actuator_forces(model, reading, q, signals.Q, work, signals.wanted)
    for i in range(q.size):
        signals.tau[i] = min(max(signals.wanted[i], lower), upper)


@borrowing_kernel
def integrate_error(law: Law, step: float, signals: Signals, integral: Array) -> None:
    """Add the error to its integral, where the condition allows it.

    The integral of a coordinate stands still while its error is outside the law's band, or while an actuator of its
    module is saturated and the integral would drive it further.
    """
    n = integral.size // 2
    for i in range(integral.size):
        first = 2 * (i % n)
        saturated = signals.wanted[first] != signals.tau[first] or signals.wanted[first + 1] != signals.tau[first + 1]
        if abs(signals.e[i]) <= law.band[i] and not (saturated and signals.Q[i] * signals.e[i] > 0.0):
            integral[i] += step * signals.e[i]
