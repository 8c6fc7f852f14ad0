"""What a simulation leaves behind: the rows of a run, and why it ended."""

from __future__ import annotations

from typing import Literal, NamedTuple, get_args

import numpy as np
from numpy.typing import NDArray

from robot import kinematics, lyapunov
from robot.arm import Arm
from robot.controllers import ControlLaw
from robot.kernels import closed_loop
from robot.metrics import Metrics, measure
from robot.scenario import Scenario, Step

Array = NDArray[np.float64]

Signal = Literal["fuzzy output", "control force", "position", "velocity", "fuzzy input"]

SIGNALS: tuple[Signal, ...] = get_args(Signal)
"""In the order of the codes of ``robot.kernels.closed_loop``."""


class Stop(NamedTuple):
    """Why a run ended early.

    Attributes:
        time: When, s: the last time with a finite state.
        signal: What was not finite; for a position also out of all reach, for a fuzzy input also rejected by its range.
        coordinate: Of which coordinate, such as ``theta2``.
    """

    time: float
    signal: Signal
    coordinate: str

    def __str__(self) -> str:
        """Return one sentence for people."""
        what = "is outside a range that rejects it" if self.signal == "fuzzy input" else "is not finite or ran away"
        return f"stopped at t = {self.time:.3f} s: the {self.signal} of {self.coordinate} {what}"


class Run(NamedTuple):
    """What happened, one row a control step: what the controller saw at t and what it did until the next row.

    Attributes:
        arm: The arm the controller knows; ``scenario.plant(arm)`` is the one that moved.
        controller: The control law at the end of the run.
        scenario: The experiment.
        start: (2N,) q0, the plant's equilibrium unless another start was given; references count from there.
        t: (n,) s.
        q: (n, 2N) position, m and rad.
        dq: (n, 2N) velocity.
        reference: (n, 2N) qd.
        dreference: (n, 2N) its rate.
        forces: (n, 2N) actuator forces F11, F21, F12, ... within their limits and behind their valves, N.
        control: (n, 2N) generalized force Q that the controller asked for, N and N m.
        disturbance: (n, 2N) generalized force of noise and pulses, N and N m; noise on measurement or reference is
            given as it is, m and rad.
        inputs: (n, 2N, 2) inputs (GE e, GC ė) of the fuzzy blocks before clamping; 0 for laws without fuzzy blocks.
        output: (n, 2N) their outputs T; 0 for laws without.
        learned: (n, 2N) |θ|² of the blocks that learn; 0 for laws without.
        activity: (2N, n_rules) largest firing strength of each rule in the run; (2N, 0) for laws without.
        clamped: (2N,) in how many control steps an input of the fuzzy block lay outside its range.
        undefined: (2N,) in how many no rule gave the fuzzy block's output, but the no-fire policy.
        stopped: None, or why the run ended before its time.
    """

    arm: Arm
    controller: ControlLaw
    scenario: Scenario
    start: Array
    t: Array
    q: Array
    dq: Array
    reference: Array
    dreference: Array
    forces: Array
    control: Array
    disturbance: Array
    inputs: Array
    output: Array
    learned: Array
    activity: Array
    clamped: NDArray[np.int64]
    undefined: NDArray[np.int64]
    stopped: Stop | None

    def shortest_actuator(self) -> Array:
        """Return the length (n,) of the shortest actuator, s - (l/2)|θ|, m."""
        return kinematics.shortest_actuator(self.arm, self.q)

    @property
    def is_physical(self) -> bool:
        """Whether every actuator kept a positive length: what else the model computes, no real arm can do."""
        return len(self.t) == 0 or float(self.shortest_actuator().min()) > 0.0

    def lyapunov(self) -> Array:
        """Return the law's Lyapunov function (n,) over time; see :mod:`robot.lyapunov`.

        Raises:
            InvalidControllerError: A law for which none is known.
        """
        return lyapunov.values(self.scenario.plant(self.arm), self.controller, self.reference, self.dreference, self)

    def thinned(self, rows: int) -> Run:
        """Return the run with every k-th row only, so many that at most ``rows`` + 1 remain: enough for a picture."""
        every = max(1, -(-(len(self.t) - 1) // rows))
        kept = {name: getattr(self, name)[::every] for name in ("t", *closed_loop.Log._fields)}
        return self._replace(**kept)

    def metrics(self) -> Metrics:
        """Return the figures of merit; see :class:`robot.metrics.Metrics`."""
        amplitude = self.scenario.amplitude(self.arm.n_modules)
        return measure(
            self.t,
            self.q,
            self.reference,
            self.forces,
            self.start,
            amplitude,
            self.scenario.scale(self.arm.n_modules),
            constant=isinstance(self.scenario.reference, Step),
            force_limits=self.scenario.force_limits,
        )


class Sample(NamedTuple):
    """One row of a run; shapes as in :class:`Run` without the first dimension."""

    t: float
    q: Array
    dq: Array
    reference: Array
    forces: Array
    control: Array
    inputs: Array
    output: Array
