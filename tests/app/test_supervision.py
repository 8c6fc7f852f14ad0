"""A mistake of the program stops what it must and nothing more: threads go on, the page is told, the log has it all."""

from __future__ import annotations

import asyncio
import logging
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, cast

import pytest

from app import experiment
from app.runner import previews as previews_module
from app.runner.live import LiveSimulation
from app.runner.previews import Previews
from app.state import AppState, Edit, Event, Noticed, Playback, RunFinished, Setup, initial
from app.store import Store
from app.widgets import on_input
from fuzzy.formats import load
from fuzzy.inference import compile_system
from robot.simulation import Simulation

DIAGONAL = load(Path(__file__).parents[2] / "rulebases" / "diagonal.yaml")
PATIENCE = 60.0


class MistakeError(Exception):
    """Something that no code expects."""


def wait_until(holds: Callable[[], object], what: str) -> None:
    deadline = time.monotonic() + PATIENCE
    while not holds():
        assert time.monotonic() < deadline, f"waited for {what}"
        time.sleep(0.005)


@pytest.fixture
def sentences() -> list[str]:
    return []


@pytest.fixture
def live(sentences: list[str]) -> Iterator[LiveSimulation]:
    started = LiveSimulation(sentences.append)
    yield started
    started.stop()


@pytest.mark.parametrize("restart", ["another experiment", "reset"])
def test_the_live_simulation_stops_with_a_message_and_starts_again(
    live: LiveSimulation, sentences: list[str], monkeypatch: pytest.MonkeyPatch, restart: str
) -> None:
    wanted = experiment.prepare(Setup(), compile_system(DIAGONAL))
    live.use(wanted)
    wait_until(lambda: live.moment is not None, "the first moment")

    def fail(*_: object) -> int:
        raise MistakeError("out of luck")

    with monkeypatch.context() as broken:
        broken.setattr(Simulation, "advance", fail)
        wait_until(lambda: sentences, "the message")
        moment = live.moment
        assert moment is not None
        assert moment.stopped is not None
        assert "out of luck" in moment.stopped
    time.sleep(0.1)
    assert len(sentences) == 1
    assert live.moment is moment
    if restart == "reset":
        live.follow(Playback(resets=1))
    else:
        live.use(wanted)
    wait_until(lambda: live.moment is not None and live.moment.stopped is None, "the motion")


def test_a_preview_that_fails_is_said_and_the_next_one_is_made(monkeypatch: pytest.MonkeyPatch) -> None:
    posted: list[Event] = []
    live = LiveSimulation()

    def fail(*_: object) -> None:
        raise MistakeError("out of luck")

    real = previews_module.simulate
    monkeypatch.setattr(previews_module, "simulate", fail)
    previews = Previews(posted.append, live, cast("Any", fail))
    try:
        previews.request(DIAGONAL, Setup())
        wait_until(lambda: len(posted) == 2, "two messages")
        texts = [event.notice.text for event in posted if isinstance(event, Noticed) and event.notice]
        assert len(texts) == 2
        assert all("out of luck" in text for text in texts)
        monkeypatch.setattr(previews_module, "simulate", real)
        previews.request(DIAGONAL, Setup())
        wait_until(lambda: any(isinstance(event, RunFinished) for event in posted), "a run")
    finally:
        previews.stop()
        live.stop()


def broken_change(_: object) -> Any:
    raise MistakeError("out of luck")


def test_an_event_that_cannot_be_applied_changes_nothing_but_the_notice(caplog: pytest.LogCaptureFixture) -> None:
    store = Store(initial(DIAGONAL), asyncio.new_event_loop())
    rendered: list[AppState] = []

    class View:
        def shows(self, state: AppState) -> tuple[object, ...]:
            return ()

        def render(self, state: AppState) -> None:
            rendered.append(state)

    store.add(View())
    before = store.state
    with caplog.at_level(logging.ERROR):
        store.dispatch(Edit("bad", broken_change))
    assert store.state.work == before.work
    assert store.state.notice is not None
    assert "out of luck" in store.state.notice.text
    assert rendered[-1] is store.state
    assert "Traceback" in caplog.text
    store._loop.close()


def test_a_callback_that_fails_is_said(caplog: pytest.LogCaptureFixture) -> None:
    heard: list[Event] = []
    callbacks: list[Any] = []

    class Handle:
        value = 1

        def on_update(self, callback: Any) -> None:
            callbacks.append(callback)

    class Click:
        client = object()
        target = Handle()

    on_input(Handle(), heard.append, broken_change)
    asyncio.run(callbacks[0](Click()))
    assert isinstance(heard[0], Noticed)
    assert heard[0].notice is not None
    assert "out of luck" in heard[0].notice.text
    assert "Traceback" in caplog.text
