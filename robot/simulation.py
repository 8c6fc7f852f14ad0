"""The closed loop from Python: a whole scenario at once, or live, step by step; both give the same numbers."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from robot import controllers, disturbance, dynamics
from robot.arm import Arm, parameters, read_only
from robot.controllers import AdaptiveFuzzyFlc, AdaptiveFuzzyPid, ControlLaw
from robot.controllers.adaptive import basis_size
from robot.controllers.base import STEP
from robot.controllers.fuzzy import CLAMPED, UNDEFINED, Directory
from robot.errors import InvalidControllerError, RobotError
from robot.kernels import closed_loop
from robot.kernels import control as codes
from robot.reference import reference_arrays
from robot.run import SIGNALS, Run, Sample, Stop
from robot.scenario import Scenario

Array = NDArray[np.float64]

REACH = 10.0
"""A module longer than so many of the longest rest length, or bent by so many radians, has run away."""

STOP_RATIO = 100.0
"""Stiffness of the stops in units of the arm's stiffest spring."""

_NEVER = 1 << 62


class Simulation:
    """A closed loop that is advanced step by step, for as long as one likes.

    Only one thread at a time may call it; ``advance`` releases the interpreter lock. Memory does not grow.

    Attributes:
        arm: The arm the controller knows.
        scenario: The experiment; its duration does not end a live simulation.
        start: (2N,) q0.
        stopped: None, or why the simulation cannot go on.
        load: (N, 2) forces in N on the masses along n1 and n3; may be written between two advances.
    """

    def __init__(
        self,
        arm: Arm,
        controller: ControlLaw,
        scenario: Scenario,
        *,
        history: float = 20.0,
        q: ArrayLike | None = None,
        dq: ArrayLike | None = None,
    ) -> None:
        """Start a simulation at t = 0.

        Args:
            arm: The arm the controller knows; the scenario's mismatch makes the plant of it.
            controller: The control law.
            scenario: The experiment.
            history: How much of the past is kept, s.
            q: (2N,) start; the plant's equilibrium by default.
            dq: (2N,) velocity at the start; 0 by default.

        Raises:
            RobotError: Parts that do not fit each other, or an arm that cannot be at rest.
        """
        if not (math.isfinite(history) and STEP <= history <= 3600.0):
            raise RobotError(f"found {history!r}; valid: {STEP:g} to 3600 s", "history")
        self.arm = arm
        self.scenario = scenario
        self.stopped: Stop | None = None
        self._plant = scenario.plant(arm)
        self._size = 2 * arm.n_modules
        self.start = dynamics.equilibrium(self._plant) if q is None else _vector(q, self._size, "q")
        self.load = np.zeros((arm.n_modules, 2))
        self._tick = 0
        self._rows = 0
        self._state = closed_loop.State(
            q=self.start.copy(),
            dq=np.zeros(self._size) if dq is None else _vector(dq, self._size, "dq"),
            integral=np.zeros(self._size),
            output=np.zeros(self._size),
            activity=np.zeros((self._size, 0)),
            counts=np.zeros((self._size, 2), dtype=np.int64),
            weights=np.zeros((self._size, 0)),
            filtered=np.stack([self.start, np.zeros(self._size)]),
            applied=np.zeros(self._size),
        )
        self._log = _new_log(round(history / STEP), self._size)
        self._directory: Directory | None = None
        self._start_disturbance()
        self._reference = reference_arrays(self._plant, self.start, scenario)
        self.use(controller)

    def _start_disturbance(self) -> None:
        scenario = self.scenario
        self._first_sample = 0
        if scenario.disturbance is None:
            self._hold = _NEVER
            self._samples = iter(())
            self._noise = np.zeros((1, self._size))
            return
        self._hold = max(1, round(scenario.disturbance.hold_time / STEP))
        if scenario.disturbance.channel == "force":
            target = self.start + scenario.amplitude(self.arm.n_modules)
            signal = dynamics.gravity_vector(self._plant, target)
        else:
            signal = scenario.scale(self.arm.n_modules)
        self._samples = scenario.disturbance.samples(signal)
        self._noise = next(self._samples)

    def use(self, controller: ControlLaw) -> None:
        """Change the control law between two steps; the arm, the integral and the past stay as they are.

        Raises:
            InvalidControllerError: A law for another number of modules.
        """
        law = controller.law()
        if law.Kp.shape[1] != self._size:
            found = f"found gains for {law.Kp.shape[1]} coordinates; valid: {self._size}"
            raise InvalidControllerError(found, "controller")
        scenario = self.scenario
        self.controller = controller
        had_blocks, self._directory = self._directory is not None, None
        n_rules = 0
        inference = controllers.inference_of(controller)
        n_basis = 0
        if inference is not None:
            # The kernel holds addresses only: whoever has the directory keeps the arrays alive.
            self._directory = inference.directory()
            if isinstance(controller, AdaptiveFuzzyFlc | AdaptiveFuzzyPid):
                n_basis = basis_size(inference)
            n_rules = self._directory.workspace.strength.size
            if not had_blocks:
                self._state.output[:] = self._directory.workspace.output[0]
        else:
            self._state.output[:] = 0.0
        if self._state.activity.shape[1] != n_rules:
            self._state = self._state._replace(activity=np.zeros((self._size, n_rules)))
        if self._state.weights.shape[1] != n_basis:
            self._state = self._state._replace(weights=np.zeros((self._size, n_basis)))
        plant = parameters(self._plant)
        if scenario.stops:
            plant = plant._replace(stop_stiffness=STOP_RATIO * float(plant.stiffness.max()))
        noise = scenario.disturbance
        self._loop = closed_loop.Loop(
            plant=plant,
            model=parameters(controllers.model_of(controller) or self.arm),
            law=law,
            reference=self._reference,
            reading=dynamics.READINGS[scenario.reading],
            actuators=_actuators(scenario),
            channel=disturbance.CHANNELS["force" if noise is None else noise.channel],
            events=disturbance.events(scenario.pulses, scenario.pushes, self.arm.coordinates, STEP),
            step=STEP,
            substeps=dynamics.substeps(self._plant, STEP),
            hold=self._hold,
            reach=read_only(np.repeat([REACH * max(parameters(self._plant).rest_length), REACH], self._size // 2)),
            load=self.load,
        )

    def go_on(self, scenario: Scenario) -> None:
        """Change the conditions between two steps: the arm's position and speed, its start and the past stay.

        The reference counts from the old start, though another plant may rest elsewhere.

        Raises:
            RobotError: A scenario that does not fit the arm; the simulation then goes on as before.
        """
        plant = scenario.plant(self.arm)
        reference = reference_arrays(plant, self.start, scenario)
        before = self.scenario, self._plant, self._reference
        self.scenario, self._plant, self._reference = scenario, plant, reference
        try:
            self._start_disturbance()
            self.use(self.controller)
        except RobotError:
            self.scenario, self._plant, self._reference = before
            self._start_disturbance()
            self.use(self.controller)
            raise

    @property
    def tick(self) -> int:
        """Number of control steps so far."""
        return self._tick

    @property
    def time(self) -> float:
        """Simulated time, s."""
        return self._tick * STEP

    @property
    def q(self) -> Array:
        """(2N,) present position, a copy."""
        return self._state.q.copy()

    @property
    def dq(self) -> Array:
        """(2N,) present velocity, a copy."""
        return self._state.dq.copy()

    def advance(self, n_ticks: int) -> int:
        """Advance by ``n_ticks`` control steps, fewer if the run is stopped.

        Returns:
            How many control steps were made.
        """
        if n_ticks < 0:
            raise RobotError(f"found {n_ticks}; valid: 0 or more", "n_ticks")
        begin = self._tick
        end = begin + n_ticks
        while self._tick < end and self.stopped is None:
            known = (self._first_sample + len(self._noise)) * self._hold
            if self._tick >= known:
                self._first_sample += len(self._noise)
                self._noise = next(self._samples)
                continue
            rows, signal, coordinate = closed_loop.run(
                self._loop,
                0 if self._directory is None else self._directory.address,
                self._tick,
                min(end, known) - self._tick,
                self._noise,
                self._first_sample,
                self._state,
                self._log,
            )
            self._tick += rows
            if signal != closed_loop.RUNNING:
                name = self.arm.coordinates[coordinate]
                self.stopped = Stop((self._tick - 1) * STEP if rows else self.time, SIGNALS[signal], name)
        return self._tick - begin

    @property
    def log(self) -> closed_loop.Log:
        """The ring of the last control steps, not a copy: the next advance overwrites it."""
        return self._log

    def sample(self) -> Sample | None:
        """Return the last row, or None before the first step."""
        if self._tick == 0:
            return None
        log, row = self._log, (self._tick - 1) % len(self._log.q)
        return Sample(
            (self._tick - 1) * STEP,
            log.q[row].copy(),
            log.dq[row].copy(),
            log.reference[row].copy(),
            log.forces[row].copy(),
            log.control[row].copy(),
            log.inputs[row].copy(),
            log.output[row].copy(),
        )

    def run(self, last: float | None = None) -> Run:
        """Return the kept past, or only the ``last`` seconds of it, in a copy."""
        count = min(self._tick, len(self._log.q))
        if last is not None:
            count = max(0, min(count, round(last / STEP)))
        first = self._tick - count
        return self._as_run(first, closed_loop.Log(*(_rows(array, first, self._tick) for array in self._log)))

    def _as_run(self, first: int, log: closed_loop.Log) -> Run:
        return Run(
            arm=self.arm,
            controller=self.controller,
            scenario=self.scenario,
            start=self.start.copy(),
            t=np.arange(first, self._tick, dtype=np.float64) * STEP,
            activity=self._state.activity.copy(),
            clamped=self._state.counts[:, CLAMPED].copy(),
            undefined=self._state.counts[:, UNDEFINED].copy(),
            stopped=self.stopped,
            **log._asdict(),
        )


def simulate(arm: Arm, controller: ControlLaw, scenario: Scenario) -> Run:
    """Run a scenario from its start to its end.

    Args:
        arm: The arm the controller knows; the scenario's mismatch makes the plant of it.
        controller: The control law, such as :func:`robot.controllers.default` returns.
        scenario: The experiment.

    Returns:
        ``scenario.n_steps + 1`` rows, t = 0 and t = duration included; fewer if the run was stopped.

    Raises:
        RobotError: Parts that do not fit each other, or an arm that cannot be at rest.
    """
    rows = scenario.n_steps + 1
    simulation = Simulation(arm, controller, scenario, history=rows * STEP)
    made = simulation.advance(rows)
    return simulation._as_run(0, closed_loop.Log(*(array[:made] for array in simulation._log)))


def _actuators(scenario: Scenario) -> codes.Actuators:
    lower, upper = scenario.force_limits or (-math.inf, math.inf)
    if scenario.valve_time == 0.0:
        return codes.Actuators(lower, upper, 0.0, 0.0)
    steps = STEP / scenario.valve_time
    return codes.Actuators(lower, upper, math.exp(-steps), -math.expm1(-steps) / steps)


def _rows(ring: Array, first: int, end: int) -> Array:
    """Return a copy of the rows of steps ``first`` to ``end`` from a ring that still has them all."""
    begin = first % len(ring)
    return np.concatenate([ring[begin : begin + end - first], ring[: max(0, begin + end - first - len(ring))]])


def _new_log(rows: int, size: int) -> closed_loop.Log:
    shapes = {"inputs": (rows, size, 2)}
    return closed_loop.Log(**{name: np.zeros(shapes.get(name, (rows, size))) for name in closed_loop.Log._fields})


def _vector(values: ArrayLike, size: int, name: str) -> Array:
    vector = np.array(values, dtype=np.float64, order="C")
    if vector.shape != (size,) or not np.isfinite(vector).all():
        raise RobotError(f"found {vector.tolist()}; valid: {size} finite numbers, s before theta", name)
    return vector
