"""The journal: what was edited is found again, with its history; what cannot be written is said and tried again."""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

import msgspec
import pytest
from hypothesis import given, settings

from app import journal
from app.journal import Journal
from app.state import AppState, Edit, Opened, Redo, Source, Undo, Work, initial, update
from app.storage import Stamp
from fuzzy import edits
from fuzzy.formats import load
from fuzzy.system import FuzzySystem
from tests import strategies

DIAGONAL = load(Path(__file__).parents[2] / "rulebases" / "diagonal.yaml")
STAMP = Stamp(1, 2, "3")
PATIENCE = 20.0


@pytest.fixture(autouse=True)
def state_home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    return tmp_path / "state"


def edited(count: int, state: AppState | None = None) -> AppState:
    state = state or initial(DIAGONAL, file="diagonal.yaml", stamp=STAMP)
    for number in range(count):
        state = update(state, Edit(f"edit {number}", partial(edits.set_notes, notes=f"note {number}")))
    return state


def wait_until(holds: Callable[[], object], what: str) -> None:
    deadline = time.monotonic() + PATIENCE
    while not holds():
        assert time.monotonic() < deadline, f"waited for {what}"
        time.sleep(0.01)


def written(folder: Path) -> list[Path]:
    return sorted((folder / "fuzzy-workbench" / "journals").glob("[!.]*.journal"))


def crash(running: Journal) -> None:
    """Let go of what the system lets go of when a process is killed."""
    if running._lock_file is not None:
        running._lock_file.close()


def no_warning(sentence: str) -> None:
    raise AssertionError(sentence)


def test_what_a_crash_left_is_found_with_its_history(tmp_path: Path, state_home: Path) -> None:
    state = update(edited(5), Undo())
    first = Journal(tmp_path, no_warning)
    first.render(state)
    wait_until(lambda: written(state_home), "the journal")
    assert Journal(tmp_path, no_warning).found() is None, "it belongs to a running process"
    crash(first)
    second = Journal(tmp_path, no_warning)
    found = second.found()
    assert found is not None
    assert found.work == state.work
    assert abs(found.at - time.time()) < 60
    assert Journal(tmp_path / "other", no_warning).found() is None
    assert update(initial(found.work.document), Redo()).document == found.work.document


def test_the_newest_state_is_written_again_and_again_while_it_is_edited(tmp_path: Path, state_home: Path) -> None:
    running = Journal(tmp_path, no_warning)
    state = initial(DIAGONAL)
    begin = time.monotonic()
    shown: set[str] = set()
    while time.monotonic() < begin + 1.5:
        state = update(state, Edit("time", partial(edits.set_notes, notes=f"{time.monotonic()}")))
        running.render(state)
        if files := written(state_home):
            shown.add(journal.read(files[0]).work.document.notes)
        time.sleep(0.01)
    assert len(shown) >= 3
    assert running.close()
    assert journal.read(written(state_home)[0]).work == state.work


def test_without_unsaved_work_nothing_remains(tmp_path: Path, state_home: Path) -> None:
    running = Journal(tmp_path, no_warning)
    running.render(initial(DIAGONAL, file="diagonal.yaml", stamp=STAMP))
    running.render(edited(1))
    wait_until(lambda: written(state_home), "the journal")
    running.render(initial(DIAGONAL, file="diagonal.yaml", stamp=STAMP))
    assert not running.close()
    assert list((state_home / "fuzzy-workbench" / "journals").iterdir()) == []


def test_a_crash_after_saving_leaves_nothing_to_ask(tmp_path: Path, state_home: Path) -> None:
    running = Journal(tmp_path, no_warning)
    state = edited(2)
    running.render(state)
    source = Source(state.document, "diagonal.yaml", STAMP)
    running.render(msgspec.structs.replace(state, source=source))
    wait_until(lambda: written(state_home) and not journal.read(written(state_home)[0]).work.is_unsaved, "the saving")
    crash(running)
    assert Journal(tmp_path, no_warning).found() is None
    assert written(state_home) == []


def test_what_was_recovered_is_deleted_only_when_it_has_been_written_again(tmp_path: Path, state_home: Path) -> None:
    first = Journal(tmp_path, no_warning)
    first.render(edited(3))
    wait_until(lambda: written(state_home), "the journal")
    crash(first)
    (old,) = written(state_home)
    second = Journal(tmp_path, no_warning)
    found = second.found()
    assert found is not None
    second.render(initial(DIAGONAL))
    second.forget(found.journal)
    time.sleep(0.05)
    assert old.exists()
    second.render(edited(3))
    wait_until(lambda: not old.exists(), "the deletion")
    (new,) = written(state_home)
    assert journal.read(new).work == found.work
    second.discard(str(new))
    assert written(state_home) == []


def test_a_journal_that_cannot_be_written_is_said_once_and_written_when_it_can(
    tmp_path: Path, state_home: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    warnings: list[str] = []
    monkeypatch.setattr(journal, "_RETRY_SECONDS", 0.02)
    real = os.fsync

    def full(_: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    running = Journal(tmp_path, warnings.append)
    running.render(edited(1))
    wait_until(lambda: warnings, "a warning")
    time.sleep(0.1)
    state = edited(2)
    running.render(state)
    monkeypatch.setattr(os, "fsync", real)
    wait_until(lambda: written(state_home), "the journal")
    wait_until(lambda: journal.read(written(state_home)[0]).work == state.work, "the newest state")
    assert len(warnings) == 1
    assert "No space left on device" in warnings[0]


def test_a_damaged_journal_is_left_and_the_others_are_offered(tmp_path: Path, state_home: Path) -> None:
    running = Journal(tmp_path, no_warning)
    running.render(edited(1))
    wait_until(lambda: written(state_home), "the journal")
    crash(running)
    (good,) = written(state_home)
    prefix = good.name.partition("-")[0]
    for number, content in enumerate((b"", b"nonsense", good.read_bytes()[:-9])):
        (good.parent / f"{prefix}-{number}.journal").write_bytes(content)
    found = Journal(tmp_path, no_warning).found()
    assert found is not None
    assert found.journal == str(good)
    assert len(written(state_home)) == 4


def test_a_history_that_is_no_longer_understood_still_gives_the_document(tmp_path: Path) -> None:
    path = tmp_path / "old.journal"
    content = journal.encode(edited(2).work, 5.0)
    envelope = msgspec.msgpack.decode(journal.zlib.decompress(content), type=journal.Envelope)
    other = msgspec.structs.replace(envelope, work=b"\x81\xa1x\x01")
    path.write_bytes(journal.zlib.compress(msgspec.msgpack.encode(other)))
    found = journal.read(path)
    assert found.work.document == edited(2).document
    assert found.work.is_unsaved
    assert found.work.source.file is None


def test_a_long_history_loses_its_oldest_steps(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    state = edited(40)
    monkeypatch.setattr(journal, "_MOST_BYTES", 60_000)
    path = tmp_path / "long.journal"
    path.write_bytes(journal.encode(state.work, 1.0))
    found = journal.read(path).work
    assert found.document == state.document
    assert 3 < len(found.past) < 40
    assert found.past == state.past[-len(found.past) :]


@given(strategies.systems(), strategies.systems())
@settings(max_examples=25)
def test_any_work_is_read_as_it_was_written(one: FuzzySystem, other: FuzzySystem) -> None:
    state = update(initial(one, file="a.yaml", stamp=STAMP), Opened(other, "b.yaml", STAMP, ()))
    work = update(state, Undo()).work
    envelope = msgspec.msgpack.decode(journal.zlib.decompress(journal.encode(work, 0.0)), type=journal.Envelope)
    assert msgspec.msgpack.decode(envelope.work, type=Work) == work
