"""From an edit to the last message of its redraw, in a real workbench without a browser."""

from __future__ import annotations

import asyncio
import shutil
import statistics
import tempfile
import threading
import time
from functools import partial
from pathlib import Path

from app.state import AppState, Edit, Result
from app.store import Shown
from app.workbench import Workbench
from fuzzy import edits

EDITS = 60
"""Edits that are measured, after as many that are not."""

_ROOT = Path(__file__).parents[1]
_TIMEOUT = 120.0


class _Redraws:
    """A view that says when another run has been rendered; the last one in the store, so that all others are done."""

    def __init__(self) -> None:
        self._last: Result | None = None
        self.seen = threading.Event()

    def shows(self, state: AppState) -> Shown:
        return (state.runs.current,)

    def render(self, state: AppState) -> None:
        if state.runs.current is not self._last:
            self._last = state.runs.current
            self.seen.set()


def main() -> None:
    """Print how long an edit takes until everything is drawn again, 3 s of simulation included."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(shutil.copy(_ROOT / "rulebases" / "diagonal.yaml", folder))
        workbench = Workbench(path, port=0)
        try:
            _measure(workbench)
        finally:
            workbench.stop()


def _measure(workbench: Workbench) -> None:
    redraws = _Redraws()
    loop = workbench.server.get_event_loop()

    async def watch() -> None:
        workbench.store.add(redraws)

    asyncio.run_coroutine_threadsafe(watch(), loop).result()
    if not redraws.seen.wait(_TIMEOUT):
        raise TimeoutError(f"no first run within {_TIMEOUT:g} s")
    times = []
    for number in range(2 * EDITS):
        redraws.seen.clear()
        consequent = ("MR", "SR")[number % 2]  # the table has SR there
        edit = Edit("paint", partial(edits.set_cell, row="PS", column="Z", consequent=consequent))
        started = time.perf_counter()
        workbench.store.post(edit)
        if not redraws.seen.wait(_TIMEOUT):
            raise TimeoutError(f"an edit was not redrawn within {_TIMEOUT:g} s")
        times.append(time.perf_counter() - started)
    measured = sorted(times[EDITS:])
    duration = workbench.store.state.runs.current.run.scenario.duration if workbench.store.state.runs.current else 0.0
    median, late = statistics.median(measured), measured[int(0.99 * len(measured))]
    print(f"edit to redraw, {duration:g} s scenario: median {1e3 * median:.1f} ms, 99th percentile {1e3 * late:.1f} ms")
    print(f"  that is {duration / median:.0f} times faster than the scenario itself")
