"""Twenty browsers edit and watch a workbench for ten minutes: ``make soak``.

The browsers are raw websockets that speak viser's protocol. One edits the rule table, undoes, saves and resets; one
reads everything, to measure; one goes and comes back all the time; two hardly read; the others only watch. Printed
are the server's memory, threads and open files, the frames a second, and the delay from an edit to the metrics of the
whole scenario simulated anew; also how long the arm stood, since random rules may let it diverge, and how long the
server's threads waited for a processor: on a machine with other work frames are late for want of one. The exit code
is 1 where memory, threads, files, frames or delays are not as they should be.
"""

from __future__ import annotations

import argparse
import asyncio
import contextlib
import math
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any, NamedTuple

import msgspec.msgpack
import viser
import zstandard
from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import WebSocketException
from websockets.typing import Subprotocol

from tests.e2e.harness import ROOT, free_port, hear_interrupts

BROWSERS = 20
SLOW = 2
WARM_UP = 0.2
"""Share of the time after which growth counts."""
MOST_GROWTH_MIB, LEAST_FRAMES, MOST_DELAY = 20.0, 29.0, 0.3
_EDIT_SECONDS = 0.5
_REPORT_SECONDS = 15.0
_TIME = re.compile(r"live simulation · .* · t = ")
"""Part of what the page says while the arm moves."""
_HEADER = 16
"""Bytes before a message's compressed part: its two sizes."""

CAMERA: dict[str, Any] = {
    "type": "ViewerCameraMessage",
    "wxyz": [1, 0, 0, 0],
    "position": [1, 1, 1],
    "fov": 1.0,
    "near": 0.1,
    "far": 10,
    "image_height": 900,
    "image_width": 1600,
    "look_at": [0, 0, 0],
    "up_direction": [0, 0, 1],
}


class Usage(NamedTuple):
    """What a process holds: memory in MiB, threads, open files; seconds for which its threads waited to run."""

    memory: float
    threads: int
    files: int
    waited: float


class Observer:
    """What the reading browser has seen.

    Attributes:
        buttons: Identifiers of buttons and commands, by their labels.
        frames: How many moments were shown: the time changes with each, while of an arm at rest nothing need be sent.
        delays: Seconds from an edit to the metrics of the new run.
        edited: When the last edit was sent that has not been answered yet.
        stood: Seconds for which the page has said that the arm's simulation was stopped.
    """

    def __init__(self) -> None:
        self.buttons: dict[str, str] = {}
        self.frames = 0
        self.delays: list[float] = []
        self.edited: float | None = None
        self.stood = 0.0
        self._stopped: float | None = None
        self._status = ""
        self._metrics: str | None = None

    def see(self, data: bytes) -> None:
        """Read one window of messages."""
        size = int.from_bytes(data[8:16], "little")
        window = msgspec.msgpack.decode(zstandard.ZstdDecompressor().decompress(data[_HEADER : _HEADER + size]))
        for message in window["messages"]:
            match message:
                case {"type": "GuiButtonMessage", "uuid": uuid, "props": {"label": label}}:
                    self.buttons[label] = uuid
                case {"type": "RegisterCommandMessage", "uuid": uuid, "props": {"label": label}}:
                    self.buttons[label] = uuid
                case {"type": "GuiUpdateMessage", "uuid": uuid, "updates": {"content": str() as content}}:
                    self._see_metrics(content)
                    self._see_status(uuid, content)
                case _:
                    pass

    def _see_metrics(self, content: str) -> None:
        if 'id="overshoot-now"' not in content or content == self._metrics:
            return
        self._metrics = content
        if self.edited is not None:
            self.delays.append(time.perf_counter() - self.edited)
            self.edited = None

    def _see_status(self, uuid: str, content: str) -> None:
        """Count the moments, and note for how long there is a reason for standing where otherwise the time is told."""
        is_time = _TIME.search(content) is not None
        self.frames += is_time
        self._status = uuid if is_time else self._status
        if uuid != self._status:
            return
        now = time.perf_counter()
        if self._stopped is not None:
            self.stood += now - self._stopped
        self._stopped = None if is_time else now


async def soak(minutes: float) -> bool:
    """Run the workbench and the browsers; returns whether all figures are as they should be."""
    with tempfile.TemporaryDirectory() as place:
        folder = Path(shutil.copytree(ROOT / "rulebases", Path(place) / "rulebases"))
        port = free_port()
        log = Path(place) / "log.txt"
        surroundings = os.environ | {"XDG_STATE_HOME": place}
        command = [sys.executable, "-m", "app", "serve", str(folder / "diagonal.yaml"), "--port", str(port)]
        with log.open("wb") as output:
            process = subprocess.Popen(  # noqa: ASYNC220 - takes a millisecond
                command, cwd=ROOT, env=surroundings, stdout=output, stderr=subprocess.STDOUT, preexec_fn=hear_interrupts
            )
        try:
            is_good = await _watch(process.pid, f"ws://127.0.0.1:{port}", minutes * 60)
            begin = time.perf_counter()
            process.send_signal(signal.SIGINT)
            code = await asyncio.to_thread(process.wait, 20)
            print(f"ended {time.perf_counter() - begin:.2f} s after Ctrl+C, exit code {code}")
            text = log.read_text(errors="replace")
            if "Traceback" in text:
                print(text[-5000:])
            return is_good and code == 0 and "Traceback" not in text
        finally:
            if process.poll() is None:
                process.kill()


async def _watch(pid: int, url: str, seconds: float) -> bool:
    observer = Observer()
    tasks = [asyncio.create_task(_read(url, observer))]
    await _until(lambda: "Save" in observer.buttons and observer.frames > 0)
    tasks += [asyncio.create_task(_read(url, None, pause=1.0 if n < SLOW else 0.0)) for n in range(BROWSERS - 3)]
    tasks += [asyncio.create_task(_come_and_go(url)), asyncio.create_task(_edit(url, observer))]
    begin = time.perf_counter()
    base: Usage | None = None
    last_frames, last_time, last_waited, rates = observer.frames, begin, _usage(pid).waited, []
    last_stood = observer.stood
    print(
        f"{'s':>6}{'MiB':>9}{'threads':>9}{'files':>7}{'frames/s':>10}{'stood s':>9}{'waits %':>9}{'edits':>7}"
        f"{'median ms':>11}{'p99 ms':>8}"
    )
    try:
        while (now := time.perf_counter()) < begin + seconds:
            await asyncio.sleep(min(_REPORT_SECONDS, seconds / 4))
            for task in tasks:
                if task.done():
                    task.result()
            now = time.perf_counter()
            usage = _usage(pid)
            moved = now - last_time - (observer.stood - last_stood)
            rate = (observer.frames - last_frames) / moved if moved > 0.0 else math.nan
            waits = 100 * (usage.waited - last_waited) / (now - last_time)
            last_frames, last_time, last_waited = observer.frames, now, usage.waited
            last_stood = observer.stood
            if now > begin + WARM_UP * seconds:
                rates.append(rate)
                base = base or usage
            print(
                f"{now - begin:6.0f}{usage.memory:9.1f}{usage.threads:9}{usage.files:7}{rate:10.1f}"
                f"{observer.stood:9.1f}{waits:9.0f}{len(observer.delays):7}{_quantile(observer.delays, 0.5):11.0f}"
                f"{_quantile(observer.delays, 0.99):8.0f}",
                flush=True,
            )
        assert base is not None
        return _judge(base, _usage(pid), rates, observer.delays)
    finally:
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)


def _judge(base: Usage, end: Usage, rates: list[float], delays: list[float]) -> bool:
    moving = [rate for rate in rates if not math.isnan(rate)]
    rate = sum(moving) / len(moving) if moving else 0.0
    p99 = _quantile(delays, 0.99)
    figures = [
        (
            "memory growth after warm-up",
            f"{end.memory - base.memory:+.1f} MiB",
            end.memory - base.memory <= MOST_GROWTH_MIB,
        ),
        ("threads", f"{base.threads} to {end.threads}", end.threads <= base.threads + 2),  # a pool may still fill
        ("open files", f"{base.files} to {end.files}", end.files <= base.files + 2),  # one comes and goes
        ("frames a second while the simulation runs", f"{rate:.1f}", rate >= LEAST_FRAMES),
        ("p99 from edit to metrics", f"{p99:.0f} ms of {len(delays)} edits", p99 <= 1000 * MOST_DELAY),
    ]
    for what, found, is_good in figures:
        print(f"{'ok ' if is_good else 'BAD'} {what}: {found}")
    return all(is_good for _, _, is_good in figures)


def _quantile(delays: list[float], share: float) -> float:
    """Return a quantile in milliseconds; NaN of nothing."""
    ordered = sorted(delays)
    return 1000 * ordered[min(int(share * len(ordered)), len(ordered) - 1)] if ordered else float("nan")


def _usage(pid: int) -> Usage:
    status = dict(line.split(":", 1) for line in Path(f"/proc/{pid}/status").read_text().splitlines())
    files = len(list(Path(f"/proc/{pid}/fd").iterdir()))
    # Each thread's schedstat: nanoseconds that it ran, nanoseconds that it waited to run, how often it ran.
    times = (path.read_text().split() for path in Path(f"/proc/{pid}/task").glob("*/schedstat"))
    waited = sum(int(one[1]) for one in times) / 1e9
    return Usage(int(status["VmRSS"].split()[0]) / 1024, int(status["Threads"]), files, waited)


def _open(url: str) -> connect:
    version = Subprotocol(f"viser-v{viser.__version__}")
    return connect(url, subprotocols=[version], compression=None, max_size=None, open_timeout=30, ping_interval=None)


async def _send(websocket: ClientConnection, message: dict[str, Any]) -> None:
    await websocket.send(msgspec.msgpack.encode(message))


async def _read(url: str, observer: Observer | None, pause: float = 0.0) -> None:
    """Be a browser that reads for ever, and rests after each message."""
    while True:
        with contextlib.suppress(OSError, WebSocketException):  # it has not started yet
            async with _open(url) as websocket:
                await _send(websocket, CAMERA)
                async for data in websocket:
                    if observer is not None and isinstance(data, bytes):
                        observer.see(data)
                    await asyncio.sleep(pause)
        await asyncio.sleep(0.5)


async def _come_and_go(url: str) -> None:
    chance = random.Random(1)
    while True:
        async with _open(url) as websocket:
            await _send(websocket, CAMERA)
            with contextlib.suppress(TimeoutError):
                async with asyncio.timeout(chance.uniform(0.5, 4.0)):
                    async for _ in websocket:
                        pass


async def _edit(url: str, observer: Observer) -> None:
    """Paint cells, undo, save and reset, each edit when the one before was answered."""
    chance = random.Random(2)
    cells = [label for label in observer.buttons if label.count(", ") == 1 and not label.startswith("brush")]
    brushes = [label for label in observer.buttons if label.startswith("brush")]
    assert cells
    assert brushes
    async with _open(url) as websocket:
        await _send(websocket, CAMERA)
        reader = asyncio.create_task(_drain(websocket))

        async def press(label: str) -> None:
            await _send(
                websocket, {"type": "GuiUpdateMessage", "uuid": observer.buttons[label], "updates": {"value": True}}
            )

        async def command(label: str) -> None:
            await _send(websocket, {"type": "CommandTriggerMessage", "uuid": observer.buttons[label]})

        try:
            while True:
                await press(chance.choice(brushes))
                await asyncio.sleep(_EDIT_SECONDS * chance.uniform(0.5, 1.5))
                observer.edited = time.perf_counter()
                await press(chance.choice(cells))
                with contextlib.suppress(TimeoutError):  # the cell held that term already, or the figures stayed
                    await _until(lambda: observer.edited is None, seconds=1.5)
                observer.edited = None
                if chance.random() < 0.2:
                    await command(chance.choice(["Undo", "Undo", "Redo", "Save", "Reset"]))
        finally:
            reader.cancel()


async def _drain(websocket: ClientConnection) -> None:
    async for _ in websocket:
        pass


async def _until(holds: Any, seconds: float = 300.0) -> None:
    async with asyncio.timeout(seconds):
        while not holds():  # noqa: ASYNC110 - what is waited for knows nothing of events
            await asyncio.sleep(0.002)


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("minutes", type=float, nargs="?", default=10.0)
    sys.exit(0 if asyncio.run(soak(parser.parse_args().minutes)) else 1)
