"""One moment of the moving arm, as the views that follow it see it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from app.state import Kept
from fuzzy.inference import Controller
from robot.arm import Arm, parameters
from robot.pull import Pull
from robot.run import Run, Sample

TICKS_PER_SECOND = 1000
"""Control steps in a simulated second."""

Array = NDArray[np.float64]


class Ghost(NamedTuple):
    """A kept run's arm at the same time: its colour's number and its (2N,) position."""

    slot: int
    q: Array


class Frame(NamedTuple):
    """One moment of the moving arm; never part of the state.

    Attributes:
        arm: The arm.
        t: Time in the scenario, s.
        q: (2N,) position.
        target: (2N,) reference.
        forces: (2N,) actuator forces F11, F21, F12, ..., N.
        inputs: (2,) inputs of the chosen coordinate's fuzzy block, before clamping.
        inference: The compiled system of that block; None for a law without fuzzy blocks.
        strength: (n_rules,) its firing strengths; None without one.
        factor: Simulated over wall time, as measured; 0 when nothing is simulated.
        stopped: Why the simulation cannot go on; None when it can.
        blocks: (2N, 2) inputs of all fuzzy blocks.
        outputs: (2N,) their outputs T.
        pull: The hand that pulls the arm; None for none.
        ghosts: Kept runs at this time.
    """

    arm: Arm
    t: float
    q: Array
    target: Array
    forces: Array
    inputs: Array
    inference: Controller | None
    strength: Array | None
    factor: float
    stopped: str | None
    blocks: Array
    outputs: Array
    pull: Pull | None = None
    ghosts: tuple[Ghost, ...] = ()


def resting_frame(arm: Arm) -> Frame:
    """Return an arm that hangs with unloaded springs: what there is to see before the kernels are ready."""
    size = 2 * arm.n_modules
    q = np.array([*parameters(arm).rest_length, *np.zeros(arm.n_modules)])
    nothing = np.zeros(size)
    return Frame(arm, 0.0, q, q, nothing, np.zeros(2), None, None, 0.0, None, np.zeros((size, 2)), nothing)


def frame_of(run: Run, time: float) -> Frame:
    """Return a moment of a run without its inference: what a picture of the arm needs."""
    sample = sample_at(run, time)
    return Frame(
        run.arm, sample.t, sample.q, sample.reference, sample.forces, sample.inputs[0], None, None, 0.0, None,
        sample.inputs, sample.output,
    )  # fmt: skip


def row_at(run: Run, time: float) -> int:
    """Return the row of a run at a time, the last one before it, within the run."""
    return min(max(int(time * TICKS_PER_SECOND + 0.5), 0), len(run.t) - 1)


def sample_at(run: Run, time: float) -> Sample:
    """Return the row of a run at a time, the last one before it."""
    row = row_at(run, time)
    return Sample(
        float(run.t[row]),
        run.q[row],
        run.dq[row],
        run.reference[row],
        run.forces[row],
        run.control[row],
        run.inputs[row],
        run.output[row],
    )


def ghosts(kept: tuple[Kept, ...], arm: Arm, time: float) -> tuple[Ghost, ...]:
    """Return the arms of kept runs at a time; those with another number of modules cannot be drawn beside it."""
    fitting = [one for one in kept if one.result.run.arm.n_modules == arm.n_modules and len(one.result.run.t)]
    return tuple(Ghost(one.slot, one.result.run.q[row_at(one.result.run, time)]) for one in fitting)
