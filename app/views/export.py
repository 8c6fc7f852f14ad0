"""Run: the run as a file for the browser that asks for it."""

from __future__ import annotations

import asyncio
import re
from collections.abc import Callable
from typing import Any

import viser

from app import clean, exports
from app.clean import Refused
from app.palette import KEPT, PID
from app.state import AppState, Event, Notice, Noticed
from app.store import Store
from app.widgets import div

_FORMATS = {"CSV": "csv", "NPZ": "npz", "PNG": "png", "HTML": "html"}
"""What stands on the buttons, and the suffix of the file."""


class ExportView:
    """Buttons for every format; the files are made off the event loop, one at a time."""

    def __init__(self, gui: viser.GuiApi, store: Store) -> None:
        self._store = store
        self._is_busy = False
        buttons = gui.add_button_group("save run as", tuple(_FORMATS))
        buttons.on_click(self._save)
        text = (
            "CSV and NPZ hold every row, PNG the curves beside the baselines, HTML the moving arm as a page of its own."
        )
        gui.add_html(div(text, "opacity:.6"))

    async def _save(self, event: viser.GuiEvent[Any]) -> None:
        if event.client is None:
            return
        try:
            suffix = _FORMATS[clean.choice(event.target.value, _FORMATS, "the format")]
        except Refused as refusal:
            self._store.dispatch(_failed(f"Refused: {refusal}."))
            return
        if self._is_busy:
            self._store.dispatch(_failed("A file is being made already."))
            return
        self._is_busy = True
        try:
            self._store.dispatch(await self._made(event.client, self._store.state, suffix))
        finally:
            self._is_busy = False

    async def _made(self, client: viser.ClientHandle, state: AppState, suffix: str) -> Event:
        current = state.runs.current
        if current is None or not len(current.run.t):
            return _failed("There is no run to save yet.")
        name = f"{_file_name(state)}.{suffix}"
        try:
            content = await asyncio.to_thread(maker(state, suffix))
        except Exception as error:  # whatever a file's maker meets, the page goes on and says so
            return _failed(f"{name} was not made: {error}.")
        client.send_file_download(name, content, save_immediately=True)
        return Noticed(Notice(f"Made {name}."))


def maker(state: AppState, suffix: str) -> Callable[[], bytes]:
    """Return a function that makes the file of the present run.

    Args:
        state: Present state; it has a run.
        suffix: Of the file, without a dot.
    """
    assert state.runs.current is not None
    run = state.runs.current.run
    match suffix:
        case "csv":
            return lambda: exports.csv(run)
        case "npz":
            return lambda: exports.npz(run)
        case "png":
            others = [(one.name, _hex(KEPT[one.slot]), one.result.run) for one in state.runs.kept]
            if state.runs.pid is not None:
                others.append(("PID", PID, state.runs.pid.run))
            title = f"{state.document.name}: {state.setup.controller}, {state.setup.arm} arm, {state.setup.scenario}"
            return lambda: exports.picture(run, title, others)
        case _:
            return lambda: exports.replay_html(run).encode()


def _file_name(state: AppState) -> str:
    plain = re.sub(r"[^A-Za-z0-9_-]+", "_", state.document.name)[:40].strip("_") or "run"
    return f"{plain}-{state.setup.controller}-{state.setup.scenario}"


def _hex(color: tuple[int, int, int]) -> str:
    return "#{:02x}{:02x}{:02x}".format(*color)


def _failed(text: str) -> Event:
    return Noticed(Notice(text, is_error=True))
