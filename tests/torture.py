"""Kills a running editing session with SIGKILL, again and again, and looks at what is left: ``make torture``.

Every session edits, undoes and saves as fast as the workbench does, with its real store, storage and journal; each
takes over what the one before it left. After each kill must hold: the file is one that was being or had been saved,
whole; and what the next start finds is a state of the last second, with its history.
"""

from __future__ import annotations

import asyncio
import os
import random
import signal
import sys
import tempfile
import time
from functools import partial
from pathlib import Path
from typing import NamedTuple

from app.filing import Filing
from app.journal import Journal
from app.state import Asked, Edit, Event, Recovered, Redo, Saved, Undo, initial
from app.storage import Storage
from app.store import Store
from fuzzy import edits
from fuzzy.formats import load, save

SHIPPED = Path(__file__).parents[1] / "rulebases" / "diagonal.yaml"
NAME = "mine.yaml"
LEAST, MOST = 0.01, 1.3
"""Seconds that a session lives."""
LOST = 1.0
"""Seconds of edits that a crash may cost."""
HISTORY = 20
"""Steps after which a session no longer needs to have grown."""


class Life(NamedTuple):
    """What a session wrote down about itself.

    Attributes:
        states: Time and number of every state that it came to.
        saved: Number of the state that it saved last; -1 if it did not come to that.
        saving: Number of the state that it began to save last; -1 if it did not come to that.
    """

    states: list[tuple[float, int]]
    saved: int
    saving: int


def run(count: int, seed: int = 0) -> None:
    """Kill ``count`` sessions.

    Raises:
        AssertionError: Something was lost or damaged; with the number of the kill.
    """
    chance = random.Random(seed)
    with tempfile.TemporaryDirectory() as place:
        os.environ["XDG_STATE_HOME"] = f"{place}/state"
        folder = Path(place) / "rulebases"
        folder.mkdir()
        save(edits.set_notes(load(SHIPPED), "0"), folder / NAME)
        on_disk, highest = 0, 0
        for kill in range(1, count + 1):
            life, died = _live_and_die(folder, highest + 1, chance)
            life = life._replace(saved=on_disk if life.saved < 0 else life.saved)
            highest = max(highest, *(number for _, number in life.states)) + 1
            on_disk = _check(folder, life, died, f"kill {kill} of {count} (seed {seed})")
            if sys.stdout.isatty() and kill % 10 == 0:
                print(f"\r{kill} of {count}", end="", flush=True)
    print(f"\r{count} sessions killed: every file was whole, nothing older than {LOST:g} s was lost")


def _live_and_die(folder: Path, first: int, chance: random.Random) -> tuple[Life, float]:
    """Let a session live for a while; returns what it wrote down, and when it was killed."""
    seconds, seed = chance.uniform(LEAST, MOST), chance.random()
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            os.close(reading)
            asyncio.run(_session(folder, first, random.Random(seed), writing))
        finally:
            os._exit(1)
    os.close(writing)
    with os.fdopen(reading) as file:
        first_line = file.readline()  # a session that has not begun yet has nothing to lose
        time.sleep(seconds)
        died = time.monotonic()
        os.kill(child, signal.SIGKILL)
        _, status = os.waitpid(child, 0)
        text = first_line + file.read()
    assert os.WIFSIGNALED(status), f"the session ended by itself: {text[-300:]}"
    states, saved, saving = [], -1, -1
    for line in text.splitlines():
        what, number, when = line.split()
        match what:
            case "state":
                states.append((float(when), int(number)))
            case "saving":
                saving = int(number)
            case "saved":
                saved = int(number)
    return Life(states, saved, saving), died


async def _session(folder: Path, first: int, chance: random.Random, log: int) -> None:
    """Edit for ever, from number ``first`` on."""
    storage = Storage(folder)
    opened = storage.open(NAME)
    store = Store(initial(opened.system, file=NAME, stamp=opened.stamp, files=()), asyncio.get_running_loop())
    filing = Filing(storage, lambda: store.state)
    journal = Journal(folder, lambda sentence: os._exit(2))
    store.add(journal)

    def write(what: str) -> None:
        os.write(log, f"{what} {store.state.document.notes} {time.monotonic()}\n".encode())

    def dispatch(event: Event) -> None:
        store.dispatch(event)
        write("state")

    found = journal.found()
    if found is not None:
        journal.forget(found.journal)
        dispatch(Recovered(found.work))
    else:
        write("state")
    number = first
    while True:
        await asyncio.sleep(chance.uniform(0.0, 0.02))
        choice = chance.random()
        if choice < 0.1:
            dispatch(Undo())
            dispatch(Redo())
        elif choice < 0.2:
            write("saving")
            event = await filing.save()
            if isinstance(event, Asked):  # the session before saved, and died before its journal knew
                event = await filing.save_as(NAME, overwrite=True)
            assert isinstance(event, Saved), event
            store.dispatch(event)
            os.write(log, f"saved {event.document.notes} 0\n".encode())
        else:
            dispatch(Edit(f"edit {number}", partial(edits.set_notes, notes=str(number))))
            number += 1


def _check(folder: Path, life: Life, died: float, where: str) -> int:
    """Look at what a session left; returns the number of the state in the file."""
    in_file = int(load(folder / NAME).notes)
    assert in_file in (life.saved, life.saving), f"{where}: the file holds {in_file}, saved were {life[1:]}"
    backup = folder / f"{NAME}.bak"
    if backup.exists():
        load_copy = folder / ".copy.yaml"
        load_copy.write_bytes(backup.read_bytes())
        assert int(load(load_copy).notes) >= 0, where
        load_copy.unlink()

    journal = Journal(folder, lambda sentence: None)
    found = journal.found()
    journal.close()
    left = in_file if found is None else int(found.work.document.notes)
    before = [number for when, number in life.states if when < died - LOST][-1:]
    recent = [number for when, number in life.states if when >= died - LOST]
    unwritten = max(number for _, number in life.states) + 1
    valid = {*before, *recent, unwritten}
    # Where nothing was unsaved there is no journal: then the file holds the state itself.
    assert left in valid, f"{where}: {left} is left, and not one of the last second: {sorted(valid)[:3]} ..."
    if found is not None:
        steps = [int(step.document.notes) for step in found.work.past]
        assert steps == sorted(set(steps)), f"{where}: the history is out of order: {steps}"
        assert all(number < left for number in steps) or found.work.future, where
        assert len(steps) > 0 or left == life.states[0][1], f"{where}: the history is lost"
    return in_file


if __name__ == "__main__":
    run(int(sys.argv[1]) if len(sys.argv) > 1 else 500, int(sys.argv[2]) if len(sys.argv) > 2 else 0)
