"""The live simulation: a thread that lets simulated time follow wall time."""

from __future__ import annotations

import logging
import queue
import threading
import time
from collections.abc import Callable
from typing import NamedTuple

from app.experiment import Experiment
from app.runner.frames import TICKS_PER_SECOND
from app.state import Playback
from robot.arm import Arm
from robot.controllers import ControlLaw
from robot.errors import RobotError
from robot.pull import Pull
from robot.run import Sample
from robot.simulation import Simulation

PATIENCE = 1.0
"""Wall time that a thread is given to end, s; one that is compiling kernels ends with the process."""

_PACE = 1 / 60
"""Wall time between two advances of the live simulation, s."""
_MOST_BEHIND = 0.1
"""Wall time that is caught up after a delay, s; more is dropped, and the real-time factor shows it."""
_PULLED_TICKS = 4
"""Control steps between two looks at the spring of a hand that pulls."""


_log = logging.getLogger(__name__)


class Moment(NamedTuple):
    """The latest sample of the live simulation and what made it."""

    sample: Sample
    arm: Arm
    law: ControlLaw
    factor: float
    stopped: str | None
    pull: Pull | None = None


class Pulled(NamedTuple):
    """An order: this hand pulls from now on, or nobody."""

    pull: Pull | None


Order = Experiment | Playback | Pulled | None


class LiveSimulation:
    """A thread that lets simulated time follow wall time, and begins the scenario anew at its end.

    Args:
        report: Called from the thread with a sentence when an error of the program stops the simulation. The thread
            goes on, and begins anew with the next experiment or reset.

    Attributes:
        moment: The latest sample; replaced as a whole, so that any thread may read it.
    """

    def __init__(self, report: Callable[[str], None] = lambda _: None) -> None:
        self.moment: Moment | None = None
        self._report = report
        self._orders: queue.SimpleQueue[Order] = queue.SimpleQueue()
        self._thread = threading.Thread(target=self._run, name="live simulation", daemon=True)
        self._thread.start()

    def use(self, wanted: Experiment) -> None:
        """Go on with another experiment; only another arm, motion or duration interrupts the present one."""
        self._orders.put(wanted)

    def follow(self, playback: Playback) -> None:
        """Obey play, pause, speed, loop and reset."""
        self._orders.put(playback)

    def pull(self, pull: Pull | None) -> None:
        """Let a hand pull the arm, or let go."""
        self._orders.put(Pulled(pull))

    def stop(self) -> None:
        """End the thread."""
        self._orders.put(None)
        self._thread.join(timeout=PATIENCE)

    def _run(self) -> None:
        simulation: Simulation | None = None
        wanted: Experiment | None = None
        playback = Playback()
        pull: Pull | None = None
        owed = 0.0
        pace = _Pace()
        has_failed = False
        while True:
            started = time.perf_counter()
            for order in self._pending():
                match order:
                    case None:
                        return
                    case Playback():
                        if order.resets != playback.resets:
                            simulation, has_failed = None, False
                        playback = order
                    case Pulled():
                        pull = order.pull
                    case _:
                        simulation = None if has_failed else _continued(simulation, wanted, order)
                        wanted, has_failed = order, False
            if wanted is None or has_failed:
                time.sleep(_PACE)
                continue
            try:
                if simulation is None:
                    simulation = Simulation(*wanted, history=1.0)
                    owed = 0.0
                    simulation.advance(1)
                ended = simulation.time > wanted.scenario.duration
                moves = playback.is_playing and playback.source == "live" and not ended
                if moves:
                    owed = min(owed + pace.wall * playback.speed, _MOST_BEHIND * playback.speed)
                    owed -= _advance(simulation, int(owed * TICKS_PER_SECOND), pull) / TICKS_PER_SECOND
                self._publish(simulation, pace.measured(simulation.time if moves else None), pull)
                if simulation.time > wanted.scenario.duration and playback.loops:
                    simulation = None
            except Exception as error:
                simulation, has_failed = None, True
                self._fail(error)
            time.sleep(max(0.0, _PACE - (time.perf_counter() - started)))
            pace.wall = time.perf_counter() - started

    def _fail(self, error: Exception) -> None:
        """Say that the simulation stands still, and why."""
        _log.exception("the live simulation failed")
        sentence = f"The live simulation was stopped by an error of the program: {error!r}"
        if self.moment is not None:
            self.moment = self.moment._replace(factor=0.0, stopped=sentence)
        self._report(f"{sentence}; an edit or a reset starts it again")

    def _pending(self) -> list[Order]:
        orders = []
        while not self._orders.empty():
            orders.append(self._orders.get())
        return orders

    def _publish(self, simulation: Simulation, factor: float, pull: Pull | None) -> None:
        sample = simulation.sample()
        if sample is not None:
            stopped = None if simulation.stopped is None else str(simulation.stopped)
            self.moment = Moment(sample, simulation.arm, simulation.controller, factor, stopped, pull)


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


def _advance(simulation: Simulation, ticks: int, pull: Pull | None) -> int:
    """Advance by so many control steps, and return how many were made; a hand's force follows the arm meanwhile."""
    if pull is None:
        simulation.load[:] = 0.0
        return simulation.advance(ticks)
    made = 0
    while made < ticks and simulation.stopped is None:
        simulation.load[:] = pull.load(simulation.arm, simulation.q)
        made += simulation.advance(min(_PULLED_TICKS, ticks - made))
    return made


def _continued(simulation: Simulation | None, before: Experiment | None, wanted: Experiment) -> Simulation | None:
    """Return the simulation with the new law and conditions; None where another experiment must begin anew."""
    if simulation is None or before is None or simulation.stopped is not None or before.arm != wanted.arm:
        return None
    old, new = before.scenario, wanted.scenario
    if (old.name, old.reference, old.duration, old.prefilter) != (new.name, new.reference, new.duration, new.prefilter):
        return None
    try:
        if old != new:
            simulation.go_on(new)
        simulation.use(wanted.law)
    except RobotError:
        return None
    return simulation
