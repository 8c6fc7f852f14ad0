"""Studies of robustness and fits: in a thread of their own, with progress, and given up when not wanted any more."""

from __future__ import annotations

import logging
import os
import threading
import time
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

import fuzzy
from app import experiment
from app.state import AppState, Event, Notice, Noticed
from app.state.study import Fitted, Order, Outcome, StudyFinished, StudyProgressed
from app.store import Shown
from fuzzy import approximation, edits
from fuzzy.errors import FuzzyError
from robot.errors import RobotError
from robot.robustness import Spread, random_arms, study

_TELL_SECONDS = 0.25
"""Least time between two reports of progress."""
_MINIMAX_SAMPLES = 1024
"""Places at which the greatest error is made small: a linear programme of twice as many rows."""
_PATIENCE = 1.0
"""How long the end waits for the arms that are being simulated, s."""

Post = Callable[[Event], None]

_log = logging.getLogger(__name__)


class GivenUpError(Exception):
    """What was ordered is not wanted any more."""


class Studies:
    """Carries out what is ordered, one order at a time; the views' peer in the store."""

    def __init__(self, post: Post) -> None:
        self._post = post
        self._order: Order | None = None
        self._is_unwanted = threading.Event()
        self._thread: threading.Thread | None = None

    def shows(self, state: AppState) -> Shown:
        """Return the parts that are acted on."""
        return (state.study,)

    def render(self, state: AppState) -> None:
        """Begin what was ordered; give up what no longer is."""
        order = state.study.order
        if order is self._order:
            return
        self._is_unwanted.set()
        self._order = order
        if order is not None:
            self._is_unwanted = threading.Event()
            arguments = (order, self._is_unwanted)
            self._thread = threading.Thread(target=self._carry_out, args=arguments, name="study", daemon=True)
            self._thread.start()

    def stop(self) -> None:
        """Give up what runs."""
        self._is_unwanted.set()
        if self._thread is not None:
            self._thread.join(timeout=_PATIENCE)

    def _carry_out(self, order: Order, is_unwanted: threading.Event) -> None:
        outcome = None
        try:
            outcome = self._studied(order, is_unwanted) if order.method is None else self._fitted(order, is_unwanted)
        except GivenUpError:
            return
        except (FuzzyError, RobotError) as error:
            what = "study" if order.method is None else "fit"
            self._post(Noticed(Notice(f"Cannot {what} this: {error}.", is_error=True)))
        except Exception as error:
            _log.exception("a study or fit failed")
            self._post(Noticed(Notice(f"The study or fit failed, an error of the program: {error!r}.", is_error=True)))
        if not is_unwanted.is_set():
            self._post(StudyFinished(order.number, outcome))

    def _studied(self, order: Order, is_unwanted: threading.Event) -> Outcome:
        controller = fuzzy.compile_system(order.document)
        wanted = experiment.prepare(order.setup, controller)
        pid = experiment.prepare(order.setup, controller, law="pid")
        arms = random_arms(wanted.arm, order.plants)
        # One core stays free for the live simulation and the page.
        workers = max(1, (os.cpu_count() or 1) - 1)
        tell = self._teller(order, is_unwanted)

        def found(one: experiment.Experiment, before: int) -> Spread:
            def progress(runs: int) -> None:
                tell((before + runs) / (2 * order.plants))

            return study(arms, one.law, one.scenario, progress=progress, workers=workers)

        return Outcome(order, found(wanted, 0), found(pid, order.plants))

    def _fitted(self, order: Order, is_unwanted: threading.Event) -> Fitted:
        tell = self._teller(order, is_unwanted)
        document, method = order.document, order.method
        controller = fuzzy.compile_system(document)

        def target(x: NDArray[np.float64]) -> NDArray[np.float64]:
            tell(0.0)
            return controller.batch(x)[:, 0]

        match method:
            case "Gaussians of their own":
                found = approximation.fit_gaussians(document, target, progress=tell)
            case "least greatest error":
                found = approximation.fit(document, target, criterion="minimax", samples=_MINIMAX_SAMPLES)
            case _:
                found = approximation.fit(document, target)
        # The arm takes an output for what it is by its range, and rules are read by its name.
        output = document.outputs[0]
        system = edits.set_range(found.system, found.system.outputs[0].name, output.low, output.high)
        system = edits.rename_variable(system, found.system.outputs[0].name, output.name)
        return Fitted(order, edits.set_unit(system, output.name, output.unit), found.rms, found.largest)

    def _teller(self, order: Order, is_unwanted: threading.Event) -> Callable[[float], None]:
        """Return what tells the share that is done, now and then, and ends an order that is not wanted any more."""
        told = time.monotonic()

        def tell(share: float) -> None:
            nonlocal told
            if is_unwanted.is_set():
                raise GivenUpError
            now = time.monotonic()
            if now - told > _TELL_SECONDS:
                told = now
                self._post(StudyProgressed(order.number, share))

        return tell
