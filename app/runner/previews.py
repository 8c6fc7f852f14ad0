"""The whole scenario again after every change: a thread in which only the newest request matters."""

from __future__ import annotations

import logging
import math
import queue
import threading
import time
from collections.abc import Callable
from functools import partial

import numpy as np
from numpy.typing import NDArray

import fuzzy
from app import experiment
from app.experiment import Experiment
from app.runner.advice import advise
from app.runner.live import PATIENCE, LiveSimulation
from app.scene.landscape import landscape
from app.state import Advised, Event, Notice, Noticed, Result, RunFinished, Setup, SurfaceFound
from fuzzy import analysis
from fuzzy.errors import FuzzyError
from fuzzy.inference import Controller
from fuzzy.system import FuzzySystem
from robot.arm import Arm
from robot.errors import InvalidControllerError, RobotError
from robot.run import Run
from robot.scenario import Scenario
from robot.simulation import simulate

PICTURE_ROWS = 600
"""Rows of a run that a picture needs: more than a panel has pixels."""

SURFACE_POINTS = (41, 41)
"""Of the control surface, along each input."""

_PAUSE = 0.15
"""Wall time without a request after which the hand has paused, s."""
_SURFACE_PERIOD = 0.25
"""Least wall time between two control surfaces while a hand drags, s."""

Post = Callable[[Event], None]

_log = logging.getLogger(__name__)


class Previews:
    """A thread that compiles every new document and simulates its whole scenario; only the newest matters."""

    def __init__(self, post: Post, live: LiveSimulation, warm_up: Callable[[Post], None]) -> None:
        self._post = post
        self._live = live
        self._warm_up = warm_up
        self._wanted: queue.SimpleQueue[tuple[FuzzySystem, Setup] | None] = queue.SimpleQueue()
        self._controller: Controller | None = None
        self._drawn: FuzzySystem | None = None
        self._drawn_at = -math.inf
        self._pid: tuple[tuple[Arm, Scenario], Result] | None = None
        self._thread = threading.Thread(target=self._run, name="previews", daemon=True)
        self._thread.start()

    def request(self, document: FuzzySystem, setup: Setup) -> None:
        """Simulate this next, instead of anything that still waits."""
        self._wanted.put((document, setup))

    def stop(self) -> None:
        """End the thread."""
        self._wanted.put(None)
        self._thread.join(timeout=PATIENCE)

    def _run(self) -> None:
        try:
            self._warm_up(self._post)
        except Exception as error:  # what was not compiled now is compiled when it is called
            self._report("The kernels could not be made ready", error)
        finished: RunFinished | None = None
        while True:
            try:
                wanted = self._wanted.get(timeout=None if finished is None else _PAUSE)
            except queue.Empty:
                assert finished is not None
                self._try(partial(self._elaborate, finished))
                finished = None
                continue
            while not self._wanted.empty():
                wanted = self._wanted.get()
            if wanted is None:
                return
            finished = self._try(partial(self._preview, *wanted))

    def _try(self, work: Callable[[], RunFinished | None]) -> RunFinished | None:
        """Return the result of some work; a failure is said, and the thread and the last good controller go on."""
        try:
            return work()
        except (FuzzyError, RobotError) as error:
            self._post(Noticed(Notice(f"Cannot run this: {error}.", is_error=True)))
        except Exception as error:
            self._report("Cannot run this", error)
        return None

    def _report(self, what: str, error: Exception) -> None:
        """Say that the program made a mistake; the thread goes on, and so does what runs already."""
        _log.exception("%s", what)
        self._post(Noticed(Notice(f"{what}, an error of the program: {error!r}.", is_error=True)))

    def _preview(self, document: FuzzySystem, setup: Setup) -> RunFinished:
        """Simulate the scenario and post the result; the control surface too, if the last one is not too fresh."""
        controller = fuzzy.compile_system(document)
        wanted = experiment.prepare(setup, controller)
        result = result_of(wanted)
        self._live.use(wanted)  # only what can run; a few milliseconds later at the most
        conditions = (wanted.arm, wanted.scenario)
        if self._pid is None or self._pid[0] != conditions:
            self._pid = (conditions, result_of(experiment.prepare(setup, controller, law="pid")))
        finished = RunFinished(document, setup, result, self._pid[1], tuple(fuzzy.check(document)))
        self._post(finished)
        self._controller = controller
        if time.monotonic() - self._drawn_at > _SURFACE_PERIOD and self._wanted.empty():
            self._find_surface(controller)
        return finished

    def _elaborate(self, finished: RunFinished) -> None:
        """Do what has time until the hand pauses: the surface of the last edit, and the advice."""
        if self._controller is not None:
            self._find_surface(self._controller)
        advice = advise(finished.setup, finished.result, lambda: not self._wanted.empty())
        if advice is not None:
            self._post(Advised(finished.result, advice))

    def _find_surface(self, controller: Controller) -> None:
        """Post the control surface of a document that has another one than the last."""
        document = controller.system
        if document == self._drawn:
            return
        found = None
        if len(document.inputs) == 2:
            row, column = (variable.name for variable in document.inputs)
            found = landscape(document, analysis.surface(controller, column, row, SURFACE_POINTS))
        self._drawn, self._drawn_at = document, time.monotonic()
        self._post(SurfaceFound(document, found))


def result_of(wanted: Experiment) -> Result:
    """Return the whole run of an experiment, and what tables and charts need of it."""
    run = simulate(*wanted)
    drawn = run.thinned(PICTURE_ROWS)
    return Result(run, run.metrics(), drawn, _lyapunov(drawn))


def _lyapunov(run: Run) -> NDArray[np.float64] | None:
    try:
        return run.lyapunov()
    except InvalidControllerError:  # a law for which none is known
        return None
