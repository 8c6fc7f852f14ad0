"""The closed loop: controller, actuators and arm, many control steps in one call, without allocating in a step."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fuzzy.kernels.jit import inlined_kernel, kernel
from robot.controllers.base import ADAPTED_SETS, Law
from robot.controllers.fuzzy import adaptive_blocks, fuzzy_blocks
from robot.kernels import control, dynamics, integration
from robot.kernels.control import Actuators, Events, ReferenceArrays, Signals
from robot.kernels.dynamics import Array, Parameters, Workspace
from robot.kernels.integration import Stages

RUNNING = -1
FUZZY_OUTPUT = 0
FORCE = 1
POSITION = 2
VELOCITY = 3
FUZZY_INPUT = 4
"""What a run is stopped by: which signal is not finite, has run away, or is rejected by its range."""


class Loop(NamedTuple):
    """Everything that does not change while the loop runs."""

    plant: Parameters
    model: Parameters
    law: Law
    reference: ReferenceArrays
    reading: int
    actuators: Actuators
    channel: int
    """What the disturbance acts on."""
    events: Events
    step: float
    """Control step, s."""
    substeps: int
    """Runge-Kutta steps in a control step."""
    hold: int
    """Control steps for which a disturbance sample holds."""
    reach: Array
    """(2N,) m and rad; a coordinate whose size exceeds it has run away."""
    load: Array
    """(N, 2) forces on the masses along n1 and n3, N."""


class State(NamedTuple):
    """Everything that changes, (2N,) each."""

    q: Array
    dq: Array
    integral: Array
    """∫e dt of the controller."""
    output: Array
    """Last outputs of the fuzzy blocks."""
    activity: Array
    """(2N, n_rules) largest firing strength of every rule so far."""
    counts: NDArray[np.int64]
    """(2N, 2) control steps so far in which a fuzzy block clamped an input, and in which no rule gave its output."""
    weights: Array
    """(2N, n_basis) θ of the adapted blocks."""
    filtered: Array
    """(2, 2N) output of the prefilter and its rate."""
    applied: Array
    """Actuator forces behind the valves."""


class Following(NamedTuple):
    """The state after the present step, until it is known to be finite and within reach; (2N,) each."""

    q: Array
    dq: Array


class Log(NamedTuple):
    """A ring of the last control steps; step number k is in row k modulo the number of rows."""

    q: Array
    """(rows, 2N) position."""
    dq: Array
    """(rows, 2N) velocity."""
    reference: Array
    """(rows, 2N) qd."""
    dreference: Array
    """(rows, 2N) d(qd)/dt."""
    forces: Array
    """(rows, 2N) actuator forces, after the limits."""
    control: Array
    """(rows, 2N) generalized force the controller asks for."""
    disturbance: Array
    """(rows, 2N) generalized force of the disturbance."""
    inputs: Array
    """(rows, 2N, 2) inputs of the fuzzy blocks; 0 without any."""
    output: Array
    """(rows, 2N) outputs T of the fuzzy blocks; 0 without any."""
    learned: Array
    """(rows, 2N) |θ|² of the adapted blocks; 0 without any."""


@kernel
def run(
    loop: Loop, address: int, first: int, count: int, noise: Array, first_sample: int, state: State, log: Log
) -> tuple[int, int, int]:
    """Advance the loop by up to ``count`` control steps.

    Row k holds what the controller saw at t = k · step and what it did, which then holds until the next row. A run
    that is stopped keeps its last finite state; the row in which a force or a fuzzy output is not finite is not kept.

    Args:
        loop: Plant, controller, reference and limits.
        address: Of the compiled fuzzy system and its workspace; 0 for laws without one.
        first: Number of the first step.
        count: Number of steps.
        noise: (samples, 2N) disturbance; N and N m on forces, m and rad on measurement or reference.
        first_sample: Number of the first row of ``noise`` among all samples.
        state: In and out.
        log: In and out.

    Returns:
        How many rows were written, and by which signal and which coordinate the run was stopped (RUNNING, 0).
    """
    size = state.q.size
    work = dynamics.new_workspace(size // 2)
    stages = integration.new_stages(size)
    signals = control.new_signals(size)
    following = Following(np.empty(size), np.empty(size))
    basis = np.zeros(2 * state.weights.shape[1] + 1)
    learned = np.zeros(size)
    return _run(
        loop, address, first, count, noise, first_sample, state, log, work, stages, signals, following, basis, learned
    )


@inlined_kernel
def _run(
    loop: Loop,
    address: int,
    first: int,
    count: int,
    noise: Array,
    first_sample: int,
    state: State,
    log: Log,
    work: Workspace,
    stages: Stages,
    signals: Signals,
    following: Following,
    basis: Array,
    learned: Array,
) -> tuple[int, int, int]:
    """Do what ``run`` says, with all memory given."""
    for k in range(first, first + count):
        noise_now = noise[k // loop.hold - first_sample]
        control.observe(
            loop.reference, k, loop.step, loop.channel, noise_now, state.q, state.dq, state.filtered, signals
        )
        refused = -1
        if loop.law.fuzzy >= ADAPTED_SETS:
            refused = adaptive_blocks(
                address,
                loop.law,
                loop.step,
                signals.e,
                signals.de,
                signals.x,
                basis,
                state.weights,
                learned,
                state.output,
                state.activity,
                state.counts,
            )
        elif loop.law.fuzzy:
            refused = fuzzy_blocks(
                address,
                loop.law.scale,
                signals.e,
                signals.de,
                signals.x,
                signals.block,
                state.output,
                state.activity,
                state.counts,
            )
        if refused >= 0:
            return k - first, FUZZY_INPUT, refused
        dynamics.directions(signals.seen, work)
        control.control(loop.law, loop.model, state.dq, state.integral, state.output, work, signals)
        for i in range(state.q.size):
            if not math.isfinite(state.output[i]):
                return k - first, FUZZY_OUTPUT, i
            if not math.isfinite(signals.Q[i]):
                return k - first, FORCE, i
        control.actuate(loop.model, loop.reading, loop.actuators, state.applied, work, signals)
        control.disturb(k, loop.channel, noise_now, loop.events, loop.load, signals)
        _write(
            k % log.q.shape[0],
            state,
            signals,
            signals.external if loop.channel == control.ON_FORCE else noise_now,
            learned,
            log,
        )
        control.integrate_error(loop.law, loop.step, signals, state.integral)
        for i in range(state.q.size):
            following.q[i] = state.q[i]
            following.dq[i] = state.dq[i]
        integration.advance(
            loop.plant,
            loop.reading,
            following.q,
            following.dq,
            signals.tau,
            signals.external,
            signals.load,
            loop.step,
            loop.substeps,
            work,
            stages,
        )
        for i in range(state.q.size):
            if not abs(following.q[i]) <= loop.reach[i]:
                return k - first + 1, POSITION, i
            if not math.isfinite(following.dq[i]):
                return k - first + 1, VELOCITY, i
        for i in range(state.q.size):
            state.q[i] = following.q[i]
            state.dq[i] = following.dq[i]
    return count, RUNNING, 0


@inlined_kernel
def _write(row: int, state: State, signals: Signals, disturbance: Array, learned: Array, log: Log) -> None:
    for i in range(state.q.size):
        log.q[row, i] = state.q[i]
        log.dq[row, i] = state.dq[i]
        log.reference[row, i] = signals.reference[i]
        log.dreference[row, i] = signals.dreference[i]
        log.forces[row, i] = signals.tau[i]
        log.control[row, i] = signals.Q[i]
        log.disturbance[row, i] = disturbance[i]
        log.inputs[row, i, 0] = signals.x[i, 0]
        log.inputs[row, i, 1] = signals.x[i, 1]
        log.output[row, i] = state.output[i]
        log.learned[row, i] = learned[i]
