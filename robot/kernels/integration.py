"""One Runge-Kutta step of order 4 of the arm under held actuator forces."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fuzzy.kernels.jit import inlined_kernel, kernel
from robot.kernels import actuation, dynamics
from robot.kernels.dynamics import Array, Parameters, Workspace


class Stages(NamedTuple):
    """What a step writes on its way, (2N,) each."""

    q: Array
    """Position of a stage."""
    dq: Array
    """Velocity of a stage."""
    ddq: Array
    """Acceleration of a stage."""
    sum_dq: Array
    """Weighted sum of the stages' velocities."""
    sum_ddq: Array
    """Weighted sum of the stages' accelerations."""
    Q: Array
    """Generalized forces of a stage."""
    held: Array
    """Generalized forces that do not depend on the position."""


@kernel
def new_stages(size: int) -> Stages:
    """Return memory for the steps of an arm with ``size`` coordinates; allocate it once a run."""
    return Stages(
        np.empty(size), np.empty(size), np.empty(size), np.empty(size), np.empty(size), np.empty(size), np.empty(size)
    )


@inlined_kernel
def advance(
    plant: Parameters,
    reading: int,
    q: Array,
    dq: Array,
    tau: Array,
    external: Array,
    load: Array,
    step: float,
    substeps: int,
    work: Workspace,
    stages: Stages,
) -> None:
    """Move q and dq (2N,) in place by ``step`` seconds in ``substeps`` classical Runge-Kutta steps.

    Args:
        plant: Parameters.
        reading: Of the actuator forces; read as the paper does, they depend on the position of every stage.
        q: (2N,) position, in and out.
        dq: (2N,) velocity, in and out.
        tau: (2N,) actuator forces, held.
        external: (2N,) generalized forces, held.
        load: (N, 2) forces on the masses along n1 and n3, held.
        step: s.
        substeps: Number of Runge-Kutta steps.
        work: Overwritten.
        stages: Overwritten.
    """
    size = q.size
    h = step / substeps
    if reading == actuation.INTERNAL:
        actuation.generalized_force(plant, reading, q, tau, work, stages.held)
        for i in range(size):
            stages.held[i] += external[i]
    for _ in range(substeps):
        for i in range(size):
            stages.q[i] = q[i]
            stages.dq[i] = dq[i]
            stages.sum_dq[i] = 0.0
            stages.sum_ddq[i] = 0.0
        for stage in range(4):
            dynamics.directions(stages.q, work)
            if reading == actuation.INTERNAL:
                for i in range(size):
                    stages.Q[i] = stages.held[i]
            else:
                actuation.generalized_force(plant, reading, stages.q, tau, work, stages.Q)
                for i in range(size):
                    stages.Q[i] += external[i]
            dynamics.forward_dynamics(plant, stages.q, stages.dq, stages.Q, load, work, stages.ddq)
            weight = h / 6.0 if stage in (0, 3) else h / 3.0
            ahead = h if stage == 2 else 0.5 * h
            for i in range(size):
                velocity = stages.dq[i]
                stages.sum_dq[i] += weight * velocity
                stages.sum_ddq[i] += weight * stages.ddq[i]
                stages.q[i] = q[i] + ahead * velocity
                stages.dq[i] = dq[i] + ahead * stages.ddq[i]
        for i in range(size):
            q[i] += stages.sum_dq[i]
            dq[i] += stages.sum_ddq[i]
