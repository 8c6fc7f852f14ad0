"""One control step: reference, control law, actuator forces within their limits, conditional integral."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fuzzy.kernels.jit import inlined_kernel, kernel
from robot.controllers.base import ACCELERATION, FORCE, GRAVITY, LINEARIZING, MODEL_FREE, SCALING, Law
from robot.kernels import actuation, dynamics
from robot.kernels.dynamics import Array, Parameters, Workspace

STEP = 0
SINUS = 1
TABLE = 2
"""Kinds of reference."""

ON_FORCE = 0
ON_MEASUREMENT = 1
ON_REFERENCE = 2
"""What a disturbance acts on: the generalized forces, the positions that the controller sees, or its target."""


class ReferenceArrays(NamedTuple):
    """The target: start + amplitude · f(t), with f = 1 or f = sin(rate · t), or rows of a table one after another."""

    kind: int
    start: Array
    """(2N,) m and rad."""
    amplitude: Array
    """(2N,) m and rad."""
    rate: float
    """rad/s."""
    table: Array
    """(rows, 3, 2N) target with its two derivatives; m and rad, s."""
    dwell: int
    """Control steps for which a row of the table holds."""
    cyclic: int
    """1 if the first row follows the last one, 0 if the last one stays."""
    prefilter: float
    """Natural frequency of the second-order prefilter with damping ratio 1, rad/s; 0 for none."""


class Signals(NamedTuple):
    """Everything a control step reads and writes, one entry a coordinate."""

    seen: Array
    """(2N,) position as the controller measures it."""
    speed: Array
    """(2N,) velocity for the controller's model: the measured one, or 0."""
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
    command: Array
    """(2N,) actuator forces within the limits."""
    tau: Array
    """(2N,) actuator forces behind the valves."""
    external: Array
    """(2N,) generalized forces from outside."""
    load: Array
    """(N, 2) forces on the masses from outside."""


@kernel
def new_signals(size: int) -> Signals:
    """Return memory for the control steps of an arm with ``size`` coordinates; allocate it once a run."""
    return Signals(
        np.zeros(size),
        np.zeros(size),
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
        np.zeros(size),
        np.zeros(size),
        np.zeros((size // 2, 2)),
    )


@inlined_kernel
def observe(
    reference: ReferenceArrays,
    k: int,
    step: float,
    channel: int,
    noise: Array,
    q: Array,
    dq: Array,
    filtered: Array,
    signals: Signals,
) -> None:
    """Write what the controller sees in control step ``k``: position, reference with two derivatives, errors.

    The noise is added to the position or to the target if it acts there; a prefilter takes the target as input.

    Args:
        reference: The target's motion.
        k: Number of the control step.
        step: Control step, s.
        channel: What the noise acts on.
        noise: (2N,) its present sample.
        q: (2N,) position.
        dq: (2N,) velocity.
        filtered: (2, 2N) output of the prefilter and its rate, in and out: out for the next step.
        signals: Out.
    """
    value = 1.0
    first = 0.0
    second = 0.0
    row = 0
    if reference.kind == SINUS:
        angle = reference.rate * (k * step)
        value = math.sin(angle)
        first = reference.rate * math.cos(angle)
        second = -reference.rate * reference.rate * value
    elif reference.kind == TABLE:
        row = k // reference.dwell
        rows = reference.table.shape[0]
        row = row % rows if reference.cyclic else min(row, rows - 1)
    for i in range(q.size):
        amplitude = reference.amplitude[i]
        signals.seen[i] = q[i]
        if reference.kind == TABLE:
            signals.reference[i] = reference.table[row, 0, i]
            signals.dreference[i] = reference.table[row, 1, i]
            signals.ddreference[i] = reference.table[row, 2, i]
        else:
            signals.reference[i] = reference.start[i] + amplitude * value
            signals.dreference[i] = amplitude * first
            signals.ddreference[i] = amplitude * second
    if channel == ON_MEASUREMENT:
        for i in range(q.size):
            signals.seen[i] += noise[i]
    elif channel == ON_REFERENCE:
        for i in range(q.size):
            signals.reference[i] += noise[i]
    if reference.prefilter > 0.0:
        _prefilter(reference.prefilter, step, filtered, signals)
    for i in range(q.size):
        signals.e[i] = signals.reference[i] - signals.seen[i]
        signals.de[i] = signals.dreference[i] - dq[i]


@inlined_kernel
def _prefilter(rate: float, step: float, filtered: Array, signals: Signals) -> None:
    """Put r̈ = ω² (target - r) - 2 ω ṙ in the target's place, and advance r exactly for a target that holds."""
    decay = math.exp(-rate * step)
    for i in range(filtered.shape[1]):
        target = signals.reference[i]
        distance = filtered[0, i] - target
        speed = filtered[1, i]
        signals.reference[i] = filtered[0, i]
        signals.dreference[i] = speed
        signals.ddreference[i] = -rate * rate * distance - 2.0 * rate * speed
        slope = speed + rate * distance
        filtered[0, i] = target + (distance + slope * step) * decay
        filtered[1, i] = (speed - rate * slope * step) * decay


@inlined_kernel
def control(
    law: Law,
    model: Parameters,
    dq: Array,
    integral: Array,
    output: Array,
    work: Workspace,
    signals: Signals,
) -> None:
    """Write the generalized force Q of the law; see :class:`robot.controllers.base.Law` for the equations.

    Needs ``observe`` and ``directions(signals.seen, work)``.

    Args:
        law: Gains.
        model: The arm as the controller believes it to be.
        dq: (2N,) velocity.
        integral: (2N,) ∫e dt.
        output: (2N,) outputs T of the fuzzy blocks for this error.
        work: Directions in, the rest overwritten.
        signals: Reference and errors in; v and Q out.
    """
    size = dq.size
    for i in range(size):
        signals.Q[i] = 0.0
        signals.speed[i] = 0.0
        signals.v[i] = 0.0
    if law.model == LINEARIZING:
        for i in range(size):
            signals.v[i] = signals.ddreference[i] + _sum(law, ACCELERATION, i, signals, integral, output)
            signals.speed[i] = dq[i]
    if law.model != MODEL_FREE:
        dynamics.inverse_dynamics(model, signals.seen, signals.speed, signals.v, work, signals.Q)
    if law.model == GRAVITY and model.has_friction:
        dynamics.add_friction(model, dq, 1.0, signals.Q)
    for i in range(size):
        signals.Q[i] += _sum(law, FORCE, i, signals, integral, output)


@inlined_kernel
def _sum(law: Law, level: int, i: int, signals: Signals, integral: Array, output: Array) -> float:
    total = law.Kp[level, i] * signals.e[i] + law.Kd[level, i] * signals.de[i] + law.Ki[level, i] * integral[i]
    if law.fuzzy == SCALING:
        total *= 1.0 + law.GU[level, i] * law.output_scale * abs(output[i])
    elif law.fuzzy:
        total += law.GU[level, i] * law.output_scale * output[i]
    return total


class Actuators(NamedTuple):
    """Limits and valves of the actuators."""

    lower: float
    """Least force, N; may be -inf."""
    upper: float
    """Greatest force, N; may be inf."""
    lag: float
    """exp(-step / valve's time constant); 0 for none."""
    lag_mean: float
    """Mean of exp(-t / time constant) over a step; 0 for none."""


@inlined_kernel
def actuate(
    model: Parameters, reading: int, actuators: Actuators, applied: Array, work: Workspace, signals: Signals
) -> None:
    """Write the actuator forces that give Q: cut off at the limits, then behind first-order valves.

    The forces are held for the step; behind a valve it is the mean over the step of the force that approaches the
    command exponentially. Needs ``directions(signals.seen, work)``.

    Args:
        model: The arm as the controller believes it to be.
        reading: Of the actuator forces.
        actuators: Limits and valves.
        applied: (2N,) forces behind the valves now, in and out: out at the step's end.
        work: Directions.
        signals: Q in; wanted, command and tau out.
    """
    actuation.actuator_forces(model, reading, signals.seen, signals.Q, work, signals.wanted)
    for i in range(applied.size):
        command = min(max(signals.wanted[i], actuators.lower), actuators.upper)
        signals.command[i] = command
        signals.tau[i] = command + actuators.lag_mean * (applied[i] - command)
        applied[i] = command + actuators.lag * (applied[i] - command)


class Events(NamedTuple):
    """Forces from outside that last for some control steps, one a row."""

    ticks: NDArray[np.int64]
    """(n, 2) first control step, and the one after the last."""
    force: Array
    """(n, 2N) generalized forces, N and N m."""
    load: Array
    """(n, N, 2) forces on the masses along n1 and n3, N."""


@inlined_kernel
def disturb(k: int, channel: int, noise: Array, events: Events, load: Array, signals: Signals) -> None:
    """Write the forces from outside in control step ``k``: noise, events, and a load (N, 2) by hand."""
    for i in range(noise.size):
        signals.external[i] = noise[i] if channel == ON_FORCE else 0.0
    for i in range(load.shape[0]):
        signals.load[i, 0] = load[i, 0]
        signals.load[i, 1] = load[i, 1]
    for event in range(events.ticks.shape[0]):
        if events.ticks[event, 0] <= k < events.ticks[event, 1]:
            for i in range(noise.size):
                signals.external[i] += events.force[event, i]
            for i in range(load.shape[0]):
                signals.load[i, 0] += events.load[event, i, 0]
                signals.load[i, 1] += events.load[event, i, 1]


@inlined_kernel
def integrate_error(law: Law, step: float, signals: Signals, integral: Array) -> None:
    """Add the error to its integral, where the condition allows it.

    The integral of a coordinate stands still while its error is outside the law's band, or while an actuator of its
    module is saturated and the integral would drive it further.
    """
    n = integral.size // 2
    for i in range(integral.size):
        first = 2 * (i % n)
        saturated = (
            signals.wanted[first] != signals.command[first] or signals.wanted[first + 1] != signals.command[first + 1]
        )
        if abs(signals.e[i]) <= law.band[i] and not (saturated and signals.Q[i] * signals.e[i] > 0.0):
            integral[i] += step * signals.e[i]
