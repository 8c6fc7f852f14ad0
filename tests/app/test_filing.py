"""What the page does with files: the event loop stays free, and every outcome is an event that says what happened."""

from __future__ import annotations

import asyncio
import shutil
import threading
from collections.abc import Coroutine
from functools import partial
from pathlib import Path
from typing import Any

import pytest

import fuzzy.formats
from app import filing
from app.filing import Filing
from app.state import AppState, Asked, Conflict, Edit, Event, Noticed, Opened, Saved, initial, update
from app.storage import Storage
from fuzzy import edits
from fuzzy.system import FuzzySystem

SHIPPED = Path(__file__).parents[2] / "rulebases" / "diagonal.yaml"


class Desk:
    """A state and its files, without a page."""

    def __init__(self, folder: Path) -> None:
        shutil.copy(SHIPPED, folder / "a.yaml")
        self.path = folder / "a.yaml"
        self.storage = Storage(folder)
        opened = self.storage.open("a.yaml")
        self.state: AppState = initial(opened.system, file="a.yaml", stamp=opened.stamp, files=self.storage.names())
        self.filing = Filing(self.storage, lambda: self.state)

    def edit(self, notes: str) -> None:
        self.dispatch(Edit("notes", partial(edits.set_notes, notes=notes)))

    def dispatch(self, event: Event) -> None:
        self.state = update(self.state, event)

    def do(self, action: Coroutine[Any, Any, Event]) -> Event:
        event = asyncio.run(action)
        self.dispatch(event)
        return event

    def theirs(self, notes: str) -> FuzzySystem:
        system = edits.set_notes(fuzzy.formats.load(self.path), notes)
        fuzzy.formats.save(system, self.path)
        return system


@pytest.fixture
def desk(tmp_path: Path) -> Desk:
    return Desk(tmp_path)


def test_saving_writes_the_document_and_says_so(desk: Desk) -> None:
    desk.edit("mine")
    assert desk.state.is_unsaved
    assert isinstance(desk.do(desk.filing.save()), Saved)
    assert not desk.state.is_unsaved
    assert fuzzy.formats.load(desk.path) == desk.state.document


def test_the_event_loop_goes_on_while_a_file_is_written(desk: Desk, monkeypatch: pytest.MonkeyPatch) -> None:
    """The disk answers only when the loop has done something else: a save on the loop would wait for ever."""
    loop_ran = threading.Event()
    real = desk.storage.save

    def slow(*arguments: Any) -> Any:
        assert loop_ran.wait(timeout=20)
        return real(*arguments)

    monkeypatch.setattr(desk.storage, "save", slow)

    async def save_and_live() -> Event:
        saving = asyncio.create_task(desk.filing.save())
        await asyncio.sleep(0.01)
        desk.edit("edited while it is saved")
        loop_ran.set()
        return await saving

    desk.edit("first")
    assert isinstance(desk.do(save_and_live()), Saved)
    assert fuzzy.formats.load(desk.path).notes == "first"
    assert desk.state.is_unsaved


def test_a_file_that_somebody_changed_is_a_question_with_three_answers(desk: Desk) -> None:
    theirs = desk.theirs("theirs")
    desk.edit("mine")
    asked = desk.do(desk.filing.save())
    assert isinstance(asked, Asked)
    assert isinstance(desk.state.question, Conflict)
    assert fuzzy.formats.load(desk.path) == theirs

    before = desk.state
    assert isinstance(desk.do(desk.filing.save_as("b.yaml")), Saved)
    assert fuzzy.formats.load(desk.path) == theirs
    assert (desk.state.file, desk.state.question) == ("b.yaml", None)

    desk.state = before
    opened = desk.do(desk.filing.open("a.yaml"))
    assert isinstance(opened, Opened)
    assert (desk.state.document, desk.state.question, desk.state.is_unsaved) == (theirs, None, False)
    assert desk.state.work.is_unsaved, "mine is still in the history"

    desk.state = before
    assert isinstance(desk.do(desk.filing.save_as("a.yaml", overwrite=True)), Saved)
    assert fuzzy.formats.load(desk.path).notes == "mine"
    assert desk.path.with_name("a.yaml.bak").read_text() == fuzzy.formats.dumps(theirs)


def test_a_change_is_noticed_without_saving_and_asked_about_once(desk: Desk, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(filing, "_WATCH_SECONDS", 0.005)
    heard: list[Event] = []

    def hear(event: Event) -> None:
        heard.append(event)
        desk.dispatch(event)
        desk.dispatch(Asked(None))  # "decide later"

    async def watch() -> None:
        watching = asyncio.create_task(desk.filing.watch(hear))
        await asyncio.sleep(0.05)
        assert heard == []
        for count in (1, 2):
            desk.theirs(f"theirs {count}")
            for _ in range(2000):
                if len(heard) == count:
                    break
                await asyncio.sleep(0.01)
            await asyncio.sleep(0.05)
            assert len(heard) == count
        watching.cancel()

    asyncio.run(watch())
    assert all(isinstance(event, Asked) for event in heard)


def test_a_folder_that_is_removed_is_a_message_and_no_loss(desk: Desk) -> None:
    desk.edit("mine")
    shutil.rmtree(desk.path.parent)
    for action in (desk.filing.save(), desk.filing.save_as("b.yaml"), desk.filing.open("a.yaml")):
        event = desk.do(action)
        assert isinstance(event, Noticed)
        assert event.notice is not None
        assert event.notice.is_error
        assert "No such file or directory" in event.notice.text
    assert desk.state.document.notes == "mine"
    assert desk.state.is_unsaved


def test_a_file_is_saved_though_the_folder_can_no_longer_be_listed(desk: Desk, monkeypatch: pytest.MonkeyPatch) -> None:
    def unreadable() -> tuple[str, ...]:
        raise filing.StorageError("the folder cannot be read")

    desk.edit("mine")
    real = desk.storage.save

    def save_then_fail(*arguments: Any) -> Any:
        stamp = real(*arguments)
        monkeypatch.setattr(desk.storage, "names", unreadable)
        return stamp

    monkeypatch.setattr(desk.storage, "save", save_then_fail)
    assert isinstance(desk.do(desk.filing.save()), Saved)
    assert (desk.state.files, desk.state.is_unsaved) == (("a.yaml",), False)
