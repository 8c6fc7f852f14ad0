"""The study of robustness in the page: progress, cancel, what is stale, and what fails is said."""

from __future__ import annotations

import queue
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import get_args

import numpy as np
import pytest

import fuzzy
from app import guard, studies
from app.state import AppState, Begun, Edit, Event, Noticed, SetupChanged, Undo, initial, update
from app.state.study import (
    FitChosen,
    FitOrdered,
    Fitted,
    Method,
    Outcome,
    StudyCancelled,
    StudyChosen,
    StudyFinished,
    StudyOrdered,
    StudyProgressed,
)
from app.studies import Studies
from fuzzy import edits
from fuzzy.formats import save
from fuzzy.system import NoFire
from robot.robustness import Spread
from tests.app.test_views import DIAGONAL, PILTAN, Screen

_PATIENCE = 300
"""s: a first use compiles kernels."""


def spread(*overshoots: float) -> Spread:
    values = np.array(overshoots)
    return Spread(values, values, values, values, np.isinf(values))


def after(state: AppState, *events: Event) -> AppState:
    for event in events:
        state = update(state, event)
    return state


@pytest.fixture
def posted() -> Iterator[tuple[Studies, queue.Queue[Event]]]:
    events: queue.Queue[Event] = queue.Queue()
    running = Studies(events.put)
    yield running, events
    running.stop()


def wait_for(events: queue.Queue[Event], kind: type[Event]) -> Event:
    while not isinstance(event := events.get(timeout=_PATIENCE), kind):
        pass
    return event


def test_the_outcome_comes_with_progress_and_both_laws(
    posted: tuple[Studies, queue.Queue[Event]], monkeypatch: pytest.MonkeyPatch
) -> None:
    running, events = posted
    monkeypatch.setattr(studies, "_TELL_SECONDS", 0.0)
    state = after(initial(DIAGONAL), SetupChanged({"duration": 0.6}), StudyChosen(6), StudyOrdered())
    running.render(state)
    shares = []
    while not isinstance(event := events.get(timeout=_PATIENCE), StudyFinished):
        assert isinstance(event, StudyProgressed)
        shares.append(event.done)
    assert shares == sorted(shares)
    assert 0.0 < shares[0] < shares[-1] == 1.0
    state = update(state, event)
    outcome = state.study.outcome
    assert outcome is not None
    assert (len(outcome.law.overshoot), len(outcome.pid.overshoot)) == (6, 6)
    assert not np.array_equal(outcome.law.overshoot, outcome.pid.overshoot)
    assert state.study.order is None


def test_a_cancelled_study_ends_soon_and_posts_no_result(
    posted: tuple[Studies, queue.Queue[Event]], monkeypatch: pytest.MonkeyPatch
) -> None:
    running, events = posted
    begun, go_on = threading.Event(), threading.Event()

    def endless(arms: object, law: object, scenario: object, *, progress: Callable[[int], None], workers: int) -> None:
        assert workers >= 1
        while True:
            begun.set()
            assert go_on.wait(timeout=_PATIENCE)
            progress(1)

    monkeypatch.setattr(studies, "study", endless)
    state = after(initial(DIAGONAL), StudyOrdered())
    running.render(state)
    assert begun.wait(timeout=_PATIENCE)
    running.render(update(state, StudyCancelled()))
    go_on.set()
    thread = running._thread
    assert thread is not None
    thread.join(timeout=_PATIENCE)
    assert not thread.is_alive()
    assert events.empty()


def test_what_cannot_be_studied_is_said_and_the_next_order_works(posted: tuple[Studies, queue.Queue[Event]]) -> None:
    running, events = posted
    three = edits.add_input(DIAGONAL, "x")
    state = after(initial(three), StudyChosen(2), StudyOrdered())
    running.render(state)
    said = wait_for(events, Noticed)
    assert isinstance(said, Noticed)
    assert said.notice is not None
    assert said.notice.text.startswith("Cannot study this: ")
    state = update(state, wait_for(events, StudyFinished))
    assert (state.study.order, state.study.outcome) == (None, None)
    again = after(initial(DIAGONAL), SetupChanged({"duration": 0.5}), StudyChosen(2), StudyOrdered(), StudyOrdered())
    running.render(again)
    finished = wait_for(events, StudyFinished)
    assert isinstance(finished, StudyFinished)
    assert finished.outcome is not None


def test_what_comes_from_an_order_that_was_given_up_changes_nothing() -> None:
    state = after(initial(DIAGONAL), StudyOrdered(), StudyProgressed(1, 0.5))
    assert state.study.done == 0.5
    order = state.study.order
    assert order is not None
    late = StudyFinished(1, Outcome(order, spread(1.0), spread(2.0)))
    for given_up in (update(state, StudyCancelled()), update(state, StudyOrdered())):
        assert after(given_up, late, StudyProgressed(1, 0.9)).study is given_up.study
    assert update(state, late).study.outcome is late.outcome
    failed = after(state, late, StudyOrdered(), StudyFinished(2, None))
    assert failed.study.outcome is late.outcome, "what was found before stays"


def test_the_page_shows_progress_then_figures_and_says_when_they_are_stale(tmp_path: Path) -> None:
    save(DIAGONAL, tmp_path / "mine.yaml")
    server = guard.start_server(port=0)
    try:
        screen = Screen(server, tmp_path, DIAGONAL)
        start, cancel = screen.find("Study robustness"), screen.find("Cancel the study")
        assert screen.send(screen.find("arms"), "50").study.plants == 50
        assert screen.send(screen.find("arms"), "5000000").study.plants == 50
        state = screen.send(start, True)
        assert (start.visible, cancel.visible) == (False, True)
        state = screen.send(cancel, True)
        assert state.study.order is None
        assert (start.visible, cancel.visible) == (True, False)

        order = screen.send(start, True).study.order
        assert order is not None
        screen.dispatch(StudyFinished(order.number, Outcome(order, spread(1.0, 2.5), spread(3.0, float("inf")))))
        shown = screen.html()
        assert "2.5" in shown
        assert "never" in shown
        assert "study again" not in shown
        screen.open(PILTAN)
        assert "study again" in screen.html()
        screen.open(DIAGONAL)
        assert "study again" not in screen.html()
    finally:
        server.stop()


@pytest.mark.parametrize("method", get_args(Method))
def test_a_fitted_system_does_nearly_the_same_in_the_same_place(
    posted: tuple[Studies, queue.Queue[Event]], method: Method
) -> None:
    running, events = posted
    state = after(initial(DIAGONAL), FitChosen(method), FitOrdered())
    running.render(state)
    state = update(state, wait_for(events, StudyFinished))
    fitted = state.study.fitted
    assert fitted is not None
    assert (state.study.order, state.study.outcome) == (None, None)
    (before,), (output,) = DIAGONAL.outputs, fitted.document.outputs
    assert (output.name, output.low, output.high, output.unit) == (before.name, before.low, before.high, before.unit)
    rows = np.random.default_rng(1).uniform([-1, -6], [1, 6], (500, 2))
    error = fuzzy.compile_system(fitted.document).batch(rows) - fuzzy.compile_system(DIAGONAL).batch(rows)
    assert np.abs(error).max() <= fitted.largest * 1.5
    assert fitted.largest < 0.2 * (before.high - before.low)
    assert np.sqrt((error**2).mean()) < 2 * fitted.rms
    opened = update(state, Begun(fitted.document))
    assert opened.document == fitted.document
    assert update(opened, Undo()).document == DIAGONAL


def test_a_fit_is_cancelled_while_it_searches(
    posted: tuple[Studies, queue.Queue[Event]], monkeypatch: pytest.MonkeyPatch
) -> None:
    running, events = posted
    monkeypatch.setattr(studies, "_TELL_SECONDS", 0.0)
    state = after(initial(DIAGONAL), FitChosen("Gaussians of their own"), FitOrdered())
    running.render(state)
    wait_for(events, StudyProgressed)
    running.render(update(state, StudyCancelled()))
    thread = running._thread
    assert thread is not None
    thread.join(timeout=_PATIENCE)
    while not events.empty():
        assert isinstance(events.get(), StudyProgressed)


def test_what_cannot_be_fitted_is_said(posted: tuple[Studies, queue.Queue[Event]]) -> None:
    running, events = posted
    silent = edits.set_no_fire(edits.clear_table(DIAGONAL), "T", NoFire("nan"))
    state = after(initial(silent), FitOrdered())
    running.render(state)
    said = wait_for(events, Noticed)
    assert isinstance(said, Noticed)
    assert said.notice is not None
    assert said.notice.text.startswith("Cannot fit this: ")
    state = update(state, wait_for(events, StudyFinished))
    assert (state.study.order, state.study.fitted) == (None, None)


def test_the_fit_is_ordered_cancelled_and_opened_in_the_page(tmp_path: Path) -> None:
    save(DIAGONAL, tmp_path / "mine.yaml")
    server = guard.start_server(port=0)
    try:
        screen = Screen(server, tmp_path, DIAGONAL)
        assert screen.send(screen.find("fit by"), "minimax").study.method == "least greatest error"
        assert screen.send(screen.find("fit by"), "magic").study.method == "least greatest error"
        start, cancel, take = (screen.find(label) for label in ("Fit", "Cancel the fit", "Open the approximation"))
        assert (start.visible, cancel.visible, take.visible) == (True, False, False)
        state = screen.send(start, True)
        assert (start.visible, cancel.visible) == (False, True)
        assert screen.find("Study robustness").visible, "a fit is no study of robustness"
        order = state.study.order
        assert order is not None
        assert screen.send(cancel, True).study.order is None
        order = screen.send(start, True).study.order
        assert order is not None
        screen.dispatch(StudyFinished(order.number, Fitted(order, PILTAN, 0.5, 2.0)))
        assert (start.visible, cancel.visible, take.visible) == (True, False, True)
        assert "RMS error 0.5" in screen.html()
        assert "fit again" not in screen.html()
        assert screen.send(take, True).document == PILTAN
        assert "fit again" not in screen.html(), "what was fitted is open"
        screen.dispatch(Edit("clear", edits.clear_table))
        assert "fit again" in screen.html()
    finally:
        server.stop()
