"""The study of robustness: in a thread of its own, with progress, and given up when it is not wanted any more."""

from __future__ import annotations

import logging
import os
import threading
import time
from collections.abc import Callable

import fuzzy
from app import experiment
from app.state import AppState, Event, Notice, Noticed
from app.state.study import Order, Outcome, StudyFinished, StudyProgressed
from app.store import Shown
from fuzzy.errors import FuzzyError
from robot.errors import RobotError
from robot.robustness import Spread, random_arms, study

_TELL_SECONDS = 0.25
"""Least time between two reports of progress."""
_PATIENCE = 1.0
"""How long the end waits for the arms that are being simulated, s."""

Post = Callable[[Event], None]

_log = logging.getLogger(__name__)


class GivenUpError(Exception):
    """The study is not wanted any more."""


class Studies:
    """Carries out what is ordered, one study at a time; the views' peer in the store."""

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
            outcome = self._computed(order, is_unwanted)
        except GivenUpError:
            return
        except (FuzzyError, RobotError) as error:
            self._post(Noticed(Notice(f"Cannot study this: {error}.", is_error=True)))
        except Exception as error:
            _log.exception("the study of robustness failed")
            self._post(Noticed(Notice(f"The study failed, an error of the program: {error!r}.", is_error=True)))
        self._post(StudyFinished(order.number, outcome))

    def _computed(self, order: Order, is_unwanted: threading.Event) -> Outcome:
        controller = fuzzy.compile_system(order.document)
        wanted = experiment.prepare(order.setup, controller)
        pid = experiment.prepare(order.setup, controller, law="pid")
        arms = random_arms(wanted.arm, order.plants)
        # One core stays free for the live simulation and the page.
        workers = max(1, (os.cpu_count() or 1) - 1)
        told = time.monotonic()

        def found(one: experiment.Experiment, before: int) -> Spread:
            def progress(runs: int) -> None:
                nonlocal told
                if is_unwanted.is_set():
                    raise GivenUpError
                now = time.monotonic()
                if now - told > _TELL_SECONDS:
                    told = now
                    self._post(StudyProgressed(order.number, (before + runs) / (2 * order.plants)))

            return study(arms, one.law, one.scenario, progress=progress, workers=workers)

        return Outcome(order, found(wanted, 0), found(pid, order.plants))
