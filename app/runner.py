"""Background work: the live simulation, paced, and the whole scenario again after every change.

Nothing here touches the state. Two threads compute; what they find goes out as events (:meth:`Store.post`) or waits
as the latest sample for the 30 Hz stream. Both threads run kernels that release the interpreter lock.
"""

from __future__ import annotations

import queue
import threading
import time
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

import fuzzy
from app import experiment
from app.experiment import Experiment
from app.state import AppState, Event, Notice, Noticed, Playback, Result, RunFinished, Setup
from fuzzy.errors import FuzzyError
from fuzzy.inference import Controller
from fuzzy.kernels.address import Directory
from fuzzy.kernels.inference import call
from fuzzy.system import FuzzySystem
from robot import controllers
from robot.arm import Arm, parameters
from robot.controllers import ControlLaw
from robot.errors import RobotError
from robot.simulation import Run, Sample, Simulation, simulate

TICKS_PER_SECOND = 1000
"""Control steps in a simulated second."""

_PACE = 1 / 60
"""Wall time between two advances of the live simulation, s."""
_PATIENCE = 1.0
"""Wall time that a thread is given to end, s; one that is compiling kernels ends with the process."""
_MOST_BEHIND = 0.1
"""Wall time that is caught up after a delay, s; more is dropped, and the real-time factor shows it."""

Array = NDArray[np.float64]
Post = Callable[[Event], None]


class Frame(NamedTuple):
    """One moment of the moving arm, for the views that follow it; never part of the state.

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


class Moment(NamedTuple):
    """The latest sample of the live simulation and what made it."""

    sample: Sample
    arm: Arm
    law: ControlLaw
    factor: float
    stopped: str | None


class LiveSimulation:
    """A thread that lets simulated time follow wall time, and begins the scenario anew at its end.

    Attributes:
        moment: The latest sample; replaced as a whole, so that any thread may read it.
    """

    def __init__(self) -> None:
        self.moment: Moment | None = None
        self._orders: queue.SimpleQueue[Experiment | Playback | None] = queue.SimpleQueue()
        self._thread = threading.Thread(target=self._run, name="live simulation", daemon=True)
        self._thread.start()

    def use(self, wanted: Experiment) -> None:
        """Go on with another experiment: only a new law does not interrupt the motion."""
        self._orders.put(wanted)

    def follow(self, playback: Playback) -> None:
        """Obey play, pause, speed and reset."""
        self._orders.put(playback)

    def stop(self) -> None:
        """End the thread."""
        self._orders.put(None)
        self._thread.join(timeout=_PATIENCE)

    def _run(self) -> None:
        simulation: Simulation | None = None
        wanted: Experiment | None = None
        playback = Playback()
        owed = 0.0
        pace = _Pace()
        while True:
            started = time.perf_counter()
            for order in self._pending():
                if order is None:
                    return
                if isinstance(order, Playback):
                    if order.resets != playback.resets:
                        simulation = None
                    playback = order
                else:
                    simulation = _continued(simulation, wanted, order)
                    wanted = order
            if wanted is not None:
                if simulation is None:
                    simulation = Simulation(*wanted, history=1.0)
                    owed = 0.0
                    simulation.advance(1)
                moves = playback.is_playing and playback.source == "live"
                if moves:
                    owed = min(owed + pace.wall * playback.speed, _MOST_BEHIND * playback.speed)
                    owed -= simulation.advance(int(owed * TICKS_PER_SECOND)) / TICKS_PER_SECOND
                self._publish(simulation, pace.measured(simulation.time if moves else None))
                if simulation.time > wanted.scenario.duration:
                    simulation = None
            time.sleep(max(0.0, _PACE - (time.perf_counter() - started)))
            pace.wall = time.perf_counter() - started

    def _pending(self) -> list[Experiment | Playback | None]:
        orders = []
        while not self._orders.empty():
            orders.append(self._orders.get())
        return orders

    def _publish(self, simulation: Simulation, factor: float) -> None:
        sample = simulation.sample()
        if sample is not None:
            stopped = None if simulation.stopped is None else str(simulation.stopped)
            self.moment = Moment(sample, simulation.arm, simulation.controller, factor, stopped)


class _Pace:
    """Measures simulated over wall time, smoothed over about a second."""

    def __init__(self) -> None:
        self.wall = 0.0
        self._factor = 0.0
        self._last: tuple[float, float] | None = None

    def measured(self, simulated: float | None) -> float:
        """Return the factor; ``simulated`` is the simulation's time, None while it stands still."""
        now = time.perf_counter()
        if simulated is None:
            self._factor = 0.0
        elif self._last is not None and simulated >= self._last[1] and now > self._last[0]:
            current = (simulated - self._last[1]) / (now - self._last[0])
            share = min(1.0, now - self._last[0])
            self._factor = current if self._factor == 0.0 else self._factor + share * (current - self._factor)
        self._last = None if simulated is None else (now, simulated)
        return self._factor


def _continued(simulation: Simulation | None, before: Experiment | None, wanted: Experiment) -> Simulation | None:
    """Return the simulation with the new law; None where another experiment must begin anew."""
    if simulation is None or before is None or simulation.stopped is not None:
        return None
    if (before.arm, before.scenario) != (wanted.arm, wanted.scenario):
        return None
    simulation.use(wanted.law)
    return simulation


class Previews:
    """A thread that compiles every new document and simulates its whole scenario; only the newest matters."""

    def __init__(self, post: Post, live: LiveSimulation, warm_up: Callable[[Post], None]) -> None:
        self._post = post
        self._live = live
        self._warm_up = warm_up
        self._wanted: queue.SimpleQueue[tuple[FuzzySystem, Setup] | None] = queue.SimpleQueue()
        self._pid: tuple[Setup, Result] | None = None
        self._thread = threading.Thread(target=self._run, name="previews", daemon=True)
        self._thread.start()

    def request(self, document: FuzzySystem, setup: Setup) -> None:
        """Simulate this next, instead of anything that still waits."""
        self._wanted.put((document, setup))

    def stop(self) -> None:
        """End the thread."""
        self._wanted.put(None)
        self._thread.join(timeout=_PATIENCE)

    def _run(self) -> None:
        self._warm_up(self._post)
        while True:
            wanted = self._wanted.get()
            while not self._wanted.empty():
                wanted = self._wanted.get()
            if wanted is None:
                return
            try:
                self._post(self._preview(*wanted))
            except (FuzzyError, RobotError) as error:
                # The last good controller goes on.
                self._post(Noticed(Notice(f"Cannot run this: {error}.", is_error=True)))

    def _preview(self, document: FuzzySystem, setup: Setup) -> RunFinished:
        controller = fuzzy.compile_system(document)
        wanted = experiment.prepare(setup, controller)
        result = _result(wanted)
        self._live.use(wanted)  # only what can run; a few milliseconds later at the most
        if self._pid is None or self._pid[0] != setup:
            self._pid = (setup, _result(experiment.prepare(setup, controller, law="pid")))
        return RunFinished(document, setup, result, self._pid[1], tuple(fuzzy.check(document)))


def _result(wanted: Experiment) -> Result:
    run = simulate(*wanted)
    return Result(run, run.metrics())


class Runner:
    """Keeps the background work in step with the state, and gives the latest frame."""

    def __init__(self, post: Post, warm_up: Callable[[Post], None]) -> None:
        self._live = LiveSimulation()
        self._previews = Previews(post, self._live, warm_up)
        self._requested: tuple[FuzzySystem, Setup] | None = None
        self._playback: Playback | None = None
        self._replay_time = 0.0
        self._blocks: tuple[Controller, Directory] | None = None

    def render(self, state: AppState) -> None:
        """Order what a changed state needs."""
        if self._requested is None or self._requested[0] is not state.document or self._requested[1] != state.setup:
            self._requested = (state.document, state.setup)
            self._previews.request(state.document, state.setup)
        if state.playback != self._playback:
            before, self._playback = self._playback, state.playback
            self._live.follow(state.playback)
            if before is None or (before.time, before.resets) != (state.playback.time, state.playback.resets):
                self._replay_time = state.playback.time

    def frame(self, state: AppState, elapsed: float) -> Frame:
        """Return the present frame.

        Args:
            state: Tells what is shown.
            elapsed: Wall time since the last call, s; a replay goes on by it.
        """
        if state.playback.source == "live" or state.runs.current is None:
            moment = self._live.moment
            if moment is None:
                return _resting_frame(Arm.preset(state.setup.arm))
            sample = moment.sample
            return self._frame(moment.arm, moment.law, sample, state.coordinate, moment.factor, moment.stopped)
        run = state.runs.current.run
        if state.playback.is_playing:
            self._replay_time += elapsed * state.playback.speed
            if self._replay_time > run.t[-1]:
                self._replay_time = 0.0
        sample = sample_at(run, self._replay_time)
        return self._frame(run.arm, run.controller, sample, state.coordinate, 0.0, None)

    def stop(self) -> None:
        """End the threads."""
        self._previews.stop()
        self._live.stop()

    def _frame(
        self, arm: Arm, law: ControlLaw, sample: Sample, coordinate: int, factor: float, stopped: str | None
    ) -> Frame:
        inputs = sample.inputs[coordinate]
        inference = controllers.inference_of(law)
        strength = None if inference is None else self._strength(inference, inputs)
        return Frame(
            arm, sample.t, sample.q, sample.reference, sample.forces, inputs, inference, strength, factor, stopped
        )

    def _strength(self, controller: Controller, inputs: Array) -> Array | None:
        """Return the firing strengths by the kernel that controls; None where the inputs are not finite."""
        if not np.isfinite(inputs).all():
            return None
        if self._blocks is None or self._blocks[0] is not controller:
            self._blocks = (controller, controller.directory())
        directory = self._blocks[1]
        call(directory.address, inputs, directory.workspace.output)
        return directory.workspace.strength.copy()


def _resting_frame(arm: Arm) -> Frame:
    """Return an arm that hangs with unloaded springs: what there is to see before the kernels are ready."""
    q = np.array([*parameters(arm).rest_length, *np.zeros(arm.n_modules)])
    return Frame(arm, 0.0, q, q, np.zeros(2 * arm.n_modules), np.zeros(2), None, None, 0.0, None)


def sample_at(run: Run, time_: float) -> Sample:
    """Return the row of a run at a time, the last one before it."""
    row = min(max(int(time_ * TICKS_PER_SECOND + 0.5), 0), len(run.t) - 1)
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
