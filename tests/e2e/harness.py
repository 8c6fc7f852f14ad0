"""A workbench in a process of its own, and what to wait for in its page."""

from __future__ import annotations

import contextlib
import signal
import socket
import subprocess
import sys
import time
import urllib.error
import urllib.request
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import pytest
from playwright.sync_api import BrowserContext, Page

ROOT = Path(__file__).parents[2]
LOAD_TIMEOUT_MS = 60_000
"""The first frame: software rendering compiles its shaders for up to 15 s, and kernels may compile beside it."""

FLAGS = (
    "--no-sandbox",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-background-networking",
    "--disable-accelerated-2d-canvas",  # without it, uPlot draws 2 frames a second instead of 57
)

HIDE_SOFTWARE_RENDERER = """
for (const context of [WebGLRenderingContext, WebGL2RenderingContext]) {
  const real = context.prototype.getExtension;
  context.prototype.getExtension = function (name) {
    return name === "WEBGL_debug_renderer_info" ? null : real.call(this, name);
  };
}
"""
"""Keeps viser's notice about software rendering out of the pictures."""

SCENE_PAUSE_MS = 2000
SELDOM_DRAWN = (
    f"window.scenePause = {SCENE_PAUSE_MS};"
    + """
{
  const context = WebGL2RenderingContext.prototype;
  let last = -Infinity, drawing = true;
  const { clear } = context;
  context.clear = function (...parts) {
    const now = performance.now();
    drawing = now - last >= window.scenePause;
    if (drawing) {
      last = now;
      clear.apply(this, parts);
    }
  };
  for (const name of ["drawArrays", "drawArraysInstanced", "drawElements", "drawElementsInstanced"]) {
    const draw = context[name];
    context[name] = function (...parts) {
      if (drawing) draw.apply(this, parts);
    };
  }
}
"""
)
"""Draws the scene every two seconds instead of with every frame of the page, and else leaves its last picture.

Without a graphics card nearly all of a frame's time goes into the scene, and the panels wait for the page's frames:
5 in a second instead of 35. Viser clears once before it draws the scene.
"""

TOUR_SEEN = 'try { localStorage.setItem("fuzzy-workbench-tour", "seen"); } catch { /* a blank page has none */ }'
"""Makes a browser one that has been here before: the tour does not begin by itself."""


class Workbench(NamedTuple):
    """A running workbench.

    Attributes:
        url: Address of its page.
        folder: The folder of its rule bases, a copy of the shipped one.
        process: Its process.
        log: What it printed, both streams.
    """

    url: str
    folder: Path
    process: subprocess.Popen[bytes]
    log: Path


def free_port() -> int:
    """Return a port of 127.0.0.1 that nobody listens on."""
    with socket.create_server(("127.0.0.1", 0)) as probe:
        return probe.getsockname()[1]


@contextlib.contextmanager
def running_workbench(folder: Path, *options: str, port: int | None = None) -> Iterator[Workbench]:
    """Start the workbench on ``folder``/diagonal.yaml, wait until its page is served, and end it at the end.

    Args:
        folder: Of rule bases; beside it stands the log.
        options: For the command line.
        port: Where it listens; by default where nobody does.
    """
    port = port or free_port()
    log = folder.parent / f"workbench-{port}-{time.time_ns()}.log"
    command = [sys.executable, "-m", "app", "serve", str(folder / "diagonal.yaml"), "--port", str(port), *options]
    with log.open("wb") as output:
        process = subprocess.Popen(
            command,
            cwd=ROOT,
            stdin=subprocess.DEVNULL,
            stdout=output,
            stderr=subprocess.STDOUT,
            preexec_fn=hear_interrupts,
        )
    workbench = Workbench(f"http://127.0.0.1:{port}", folder, process, log)
    try:
        _wait_until_served(workbench)
        yield workbench
    finally:
        _end(process)


def hear_interrupts() -> None:
    """Let a new process hear SIGINT: a shell starts what runs in its background with that ignored, for all children."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


def _wait_until_served(workbench: Workbench) -> None:
    for _ in range(600):
        if workbench.process.poll() is not None:
            break
        try:
            with urllib.request.urlopen(workbench.url, timeout=5):
                return
        except urllib.error.HTTPError as error:
            if error.code == 403:  # it wants a token, so it is there
                return
        except OSError:
            pass
        with contextlib.suppress(subprocess.TimeoutExpired):
            workbench.process.wait(timeout=0.1)
    pytest.fail(f"the workbench did not start:\n{workbench.log.read_text(errors='replace')}")


def _end(process: subprocess.Popen[bytes]) -> None:
    if process.poll() is None:
        process.send_signal(signal.SIGTERM)
        try:
            process.wait(timeout=10)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()


def look_at(context: BrowserContext, url: str) -> Page:
    """Open an address in a window and wait until the workbench is there."""
    page = context.new_page()
    page.goto(url, wait_until="domcontentloaded", timeout=LOAD_TIMEOUT_MS)
    wait_until_ready(page)
    return page


def wait_until_ready(page: Page) -> None:
    """Wait until the scene is drawn and the panels hold something."""
    page.wait_for_selector("canvas", timeout=LOAD_TIMEOUT_MS)
    page.wait_for_selector("[role=tab], button, input", timeout=LOAD_TIMEOUT_MS)
    settle(page)


def settle(page: Page, frames: int = 3) -> None:
    """Wait until the page has painted ``frames`` times more, so that what was sent before is on the screen."""
    page.evaluate(
        """frames => new Promise(done => {
            const tick = () => (frames-- > 0 ? requestAnimationFrame(tick) : done());
            tick();
        })""",
        frames,
    )
