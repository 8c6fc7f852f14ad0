"""A whole workbench without a browser: it starts with any valid document, and ends."""

from __future__ import annotations

import contextlib
import gc
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import msgspec
import pytest

from app.state import AppState, Opened, Setup
from app.storage import Stamp
from app.workbench import Workbench
from fuzzy.formats import load, save
from fuzzy.system import FuzzySystem, Input, RuleBase

RULEBASES = Path(__file__).parents[2] / "rulebases"
DIAGONAL = load(RULEBASES / "diagonal.yaml")
PATIENCE = 120.0
"""Seconds for what takes a tenth of one, unless kernels have to be compiled."""


@contextlib.contextmanager
def started(folder: Path, document: FuzzySystem) -> Iterator[Workbench]:
    save(document, folder / "mine.yaml")
    workbench = Workbench(folder / "mine.yaml", port=0)
    try:
        yield workbench
    finally:
        workbench.stop()
        gc.unfreeze()


def state_where(workbench: Workbench, holds: Callable[[AppState], bool], what: str) -> AppState:
    deadline = time.monotonic() + PATIENCE
    while time.monotonic() < deadline:
        state = workbench.store.state
        if holds(state):
            return state
        time.sleep(0.01)
    pytest.fail(f"waited for {what}, found {workbench.store.state.progress!r}, {workbench.store.state.notice!r}")


def test_it_simulates_the_document_that_it_opens_and_ends_all_its_threads(tmp_path: Path) -> None:
    before = set(threading.enumerate())
    with started(tmp_path, DIAGONAL) as workbench:
        state = state_where(workbench, lambda state: state.runs.current is not None, "the first run")
        assert state.document == DIAGONAL
        assert (state.file, state.files) == ("mine.yaml", ("mine.yaml",))
        assert state.progress is None
        assert gc.get_freeze_count() > 10_000, "what stays for good is looked through again and again"
        mine = [
            thread for thread in set(threading.enumerate()) - before if thread.name in {"previews", "live simulation"}
        ]
        assert len(mine) == 2
    assert not any(thread.is_alive() for thread in mine)


THIRD = Input("x", 0.0, 1.0, DIAGONAL.inputs[0].terms)


@pytest.mark.parametrize("inputs", [(*DIAGONAL.inputs, THIRD), DIAGONAL.inputs[:1]], ids=["three inputs", "one input"])
def test_a_document_that_cannot_control_the_arm_is_opened_and_said_so(
    tmp_path: Path, inputs: tuple[Input, ...]
) -> None:
    with started(tmp_path, msgspec.structs.replace(DIAGONAL, inputs=inputs, rules=RuleBase())) as workbench:
        state = state_where(workbench, lambda state: state.notice is not None, "a notice")
        assert state.notice is not None
        assert state.notice.is_error
        assert "two inputs" in state.notice.text
        assert state.progress is None
        workbench.store.post(Opened(DIAGONAL, "mine.yaml", Stamp(1, 2, "3"), ("mine.yaml",)))
        state = state_where(workbench, lambda state: state.runs.current is not None, "a run of the next document")
        assert state.setup == Setup()
