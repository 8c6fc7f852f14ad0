"""From a drag in the page to the last message of its redraw, in a real Chromium, while the arm moves live.

A hand drags a membership point for ten seconds. Three figures follow: from the edit's arrival at the server to the end
of its redraw, whole scenario included; how long the event loop was kept from its other work; and what the browser
sees, which on a machine without a graphics card is dominated by software rendering. A browser that draws in software
wants all processors: for how much of the time the event loop waited for one is printed too.
"""

from __future__ import annotations

import asyncio
import shutil
import tempfile
import threading
import time
from pathlib import Path
from typing import Any

import numpy as np
from playwright.sync_api import Page, sync_playwright

from app import store
from app.runner import Frame
from app.state import AppState, Edit, Event
from app.store import Shown
from app.workbench import Workbench
from fuzzy.system import FuzzySystem
from robot import controllers
from tests.e2e.browser import MISSING, find_chromium
from tests.e2e.harness import FLAGS, LOAD_TIMEOUT_MS, wait_until_ready

SECONDS = 10.0
"""How long the hand drags."""

_SETTLING = 12.0
"""Wait after loading, s: the browser compiles its shaders."""
_PROBE = 0.002
_ROOT = Path(__file__).parents[1]
_FRAMES = """seconds => new Promise(done => {
    let count = 0; const begin = performance.now();
    const tick = now => {
        count += 1;
        if (now - begin < 1000 * seconds) requestAnimationFrame(tick); else done(count / seconds);
    };
    requestAnimationFrame(tick);
})"""
_SEEN = """() => {
    window.__seen = [];
    const watch = new MutationObserver(() => {
        const cell = document.querySelector("#settling_time-now");
        const text = cell ? cell.textContent : "";
        const last = window.__seen[window.__seen.length - 1];
        if (!last || last[1] !== text) window.__seen.push([Date.now(), text]);
    });
    watch.observe(document.body, {childList: true, subtree: true, characterData: true});
}"""


class _Watch:
    """Notes when edits reach the state, and, as the last view of the store, when the redraws that answer them end."""

    def __init__(self, workbench: Workbench) -> None:
        self._waiting: list[tuple[float, FuzzySystem]] = []
        self._run: object = None
        self._begin = 0.0
        self.latencies: list[float] = []
        self.arrivals: list[float] = []
        self.dispatches: list[float] = []
        self.lags: list[float] = []
        self.frames = 0
        self.thread = 0
        self.is_on = False
        self._update = store.update
        store.update = self._updated
        workbench._live_views.append(self)

    def _updated(self, state: AppState, event: Event) -> AppState:
        self._begin = time.perf_counter()
        changed = self._update(state, event)
        if self.is_on and isinstance(event, Edit):
            self._waiting.append((self._begin, changed.document))
            self.arrivals.append(time.time())
        return changed

    def shows(self, state: AppState) -> Shown:
        """Return all, to be the last view of every event."""
        return (state,)

    def render(self, state: AppState) -> None:
        """Note the end of a dispatch, and which edits a new run answers: its own and, newest wins, those before."""
        end = time.perf_counter()
        if self.is_on:
            self.dispatches.append(end - self._begin)
        if state.runs.current is self._run or state.runs.current is None:
            return
        self._run = state.runs.current
        controller = controllers.inference_of(state.runs.current.run.controller)
        ran = None if controller is None else controller.system
        place = next((n for n, (_, document) in enumerate(self._waiting) if document == ran), -1)
        self.latencies += [end - arrived for arrived, _ in self._waiting[: place + 1]]
        del self._waiting[: place + 1]

    def show(self, frame: Frame) -> None:  # noqa: ARG002
        """Count a frame."""
        self.frames += self.is_on

    async def begin(self, workbench: Workbench) -> None:
        """Become the last view, and measure from now on by how much the event loop is late."""
        workbench.store.add(self)
        self.thread = threading.get_native_id()
        while True:
            begin = time.perf_counter()
            await asyncio.sleep(_PROBE)
            if self.is_on:
                self.lags.append(time.perf_counter() - begin - _PROBE)


def main() -> None:
    """Print latencies of edits, lags of the event loop, and frame rates."""
    executable = find_chromium()
    if executable is None:
        print(MISSING)
        return
    with tempfile.TemporaryDirectory() as folder:
        path = Path(shutil.copy(_ROOT / "rulebases" / "diagonal.yaml", folder))
        workbench = Workbench(path, port=0)
        try:
            watch = _Watch(workbench)
            probe = asyncio.run_coroutine_threadsafe(watch.begin(workbench), workbench.server.get_event_loop())
            with sync_playwright() as playwright:
                browser = playwright.chromium.launch(executable_path=executable, args=list(FLAGS))
                page = browser.new_page(viewport={"width": 1600, "height": 900})
                page.set_default_timeout(LOAD_TIMEOUT_MS)
                page.goto(f"http://127.0.0.1:{workbench.server.get_port()}", wait_until="domcontentloaded")
                _drag(page, watch)
                browser.close()
            probe.cancel()
        finally:
            workbench.stop()


def _drag(page: Page, watch: _Watch) -> None:
    wait_until_ready(page)
    page.get_by_role("tab", name="Membership", exact=True).click()
    page.get_by_role("tab", name="Metrics", exact=True).click()
    page.wait_for_selector("#settling_time-now")
    threading.Event().wait(_SETTLING)
    idle = page.evaluate(_FRAMES, 3.0)
    page.evaluate(_SEEN)
    box = page.locator(".multi-slider-thumb").nth(4).bounding_box()
    assert box is not None
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    watch.is_on, begin, step, waited = True, time.perf_counter(), 0, _waited(watch.thread)
    while time.perf_counter() - begin < SECONDS:
        step += 1
        page.mouse.move(x - 25 - 20 * np.sin(step / 6), y)
        threading.Event().wait(0.02)
    watch.is_on = False
    wall = time.perf_counter() - begin
    share = (_waited(watch.thread) - waited) / wall
    page.mouse.up()
    seen: list[list[Any]] = page.evaluate("window.__seen")
    _print(watch, wall, idle, seen, share)


def _waited(thread: int) -> float:
    """Return for how long a thread of this process has been ready to run without a processor, s; 0 if not known."""
    statistics = Path(f"/proc/self/task/{thread}/schedstat")
    return int(statistics.read_text().split()[1]) / 1e9 if statistics.exists() else 0.0


def _print(watch: _Watch, wall: float, idle: float, seen: list[list[Any]], waited: float) -> None:
    def shown(seconds: list[float]) -> str:
        if not seconds:
            return "nothing measured"
        half, late = np.percentile(seconds, [50, 99])
        return f"median {1e3 * half:.1f} ms, 99th percentile {1e3 * late:.1f} ms, most {1e3 * max(seconds):.1f} ms"

    times = [moment / 1e3 for moment, _ in seen]
    # From each arrival to the next change of a figure in the page; the same clock, since it is the same machine.
    later = [next((t - arrival for t in times if t >= arrival), None) for arrival in watch.arrivals]
    in_page = [value for value in later if value is not None]
    print(f"a membership point dragged for {wall:.1f} s: {len(watch.arrivals)} edits, live view at 30 Hz meanwhile")
    print(f"  edit's arrival to the end of its redraw: {shown(watch.latencies)}")
    print(f"  edit's arrival to new figures in the page: {shown(in_page)} (software rendering)")
    print(f"  the event loop was late by: {shown(watch.lags)}; one dispatch: {shown(watch.dispatches)}")
    print(f"  the event loop waited for a processor: {100 * waited:.0f} % of the time")
    print(f"  frames sent: {watch.frames / wall:.1f} a second; frames painted before the drag: {idle:.1f} a second")
