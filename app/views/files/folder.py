"""Design › Files: open and save rule bases, and the history of edits."""

from __future__ import annotations

import time
from functools import partial
from typing import Any

import viser

from app import clean
from app.filing import Filing
from app.palette import BAD
from app.state import AppState, Begun, Edit, Event, Selected
from app.store import Shown, Store, View
from app.views.files.exchange import ExchangeView, file_stem
from app.views.files.fitting import FittingView
from app.views.files.history import HistoryView
from app.widgets import div, escape, on_input, put
from fuzzy import edits

_MOST_NOTES = 20_000
_ACTIONS = ("save", "duplicate", "reload")
_NEW = {f"{count} × {count}": count for count in (3, 5, 7, 9)}
"""Empty tables to begin with, and how many terms their variables have."""


class FilesView:
    """The rulebases folder and the document's name, notes and history.

    Attributes:
        views: This and those inside.
    """

    def __init__(self, gui: viser.GuiApi, store: Store, filing: Filing) -> None:
        self._filing = filing
        self._store = store
        self._current = gui.add_html("")
        self._file: Any = gui.add_dropdown("open", ("",), hint="Opens at once; undo brings back what was open before.")
        actions = gui.add_button_group("file", _ACTIONS)
        new = gui.add_button_group(
            "new", tuple(_NEW), hint="An empty table T(e, de) with so many terms; undo goes back"
        )
        self._name = gui.add_text("new name", "")
        save_as = gui.add_button("Save under the new name", icon=viser.Icon.DEVICE_FLOPPY)
        exchange = ExchangeView(gui, store)
        self._title = gui.add_text("title", "")
        self._notes = gui.add_text("notes", "", multiline=True)
        fitting = FittingView(gui, store)
        self.views: tuple[View, ...] = (self, exchange, fitting, HistoryView(gui, store))
        on_input(self._file, store.dispatch, self._open)
        on_input(actions, store.dispatch, self._act)
        on_input(new, store.dispatch, _begun)
        on_input(self._name, store.dispatch, lambda name: Selected({"new_name": clean.text(name, clean.MAX_NAME)}))
        on_input(save_as, store.dispatch, lambda _: self._save_as())
        on_input(self._title, store.dispatch, _titled)
        on_input(self._notes, store.dispatch, _noted)

    def shows(self, state: AppState) -> Shown:
        """Return the parts that are shown."""
        return state.document, state.source, state.files, state.new_name

    def render(self, state: AppState) -> None:
        """Show which file is open, and whether it is saved."""
        mark = f' <b style="color:{BAD}">● not saved</b>' if state.is_unsaved else ""
        title = escape(state.document.name)
        self._current.content = div(f"<b>{title}</b> in {escape(state.file or 'no file')}{mark}")
        files = state.files if state.file in state.files else (state.file or "", *state.files)
        put(self._file, options=files)
        self._file.value = state.file or ""
        self._name.value = state.new_name
        self._notes.value = state.document.notes
        self._title.value = state.document.name

    async def _act(self, value: object) -> Event:
        state = self._store.state
        match clean.choice(value, _ACTIONS, "the action"):
            case "save":
                return await self._filing.save()
            case "duplicate":
                return await self._filing.save_as(_free_name(file_stem(state), state.files))
            case _:
                return await self._filing.open(state.file)

    async def _save_as(self) -> Event:
        text = self._store.state.new_name.strip()
        return await self._filing.save_as(clean.file_name(text if text.endswith(".yaml") else f"{text}.yaml"))

    async def _open(self, value: object) -> Event:
        return await self._filing.open(clean.choice(value, self._store.state.files, "the file"))


def _free_name(stem: str, taken: tuple[str, ...]) -> str:
    """Return a name for a copy that no file has."""
    names = (f"{stem[: clean.MAX_NAME - 16]}-copy{number}.yaml" for number in ("", *range(2, len(taken) + 3)))
    return next(name for name in names if name not in taken)


def _begun(value: object) -> Begun:
    return Begun(edits.empty_table(_NEW[clean.choice(value, _NEW, "the size")]))


def _titled(value: object) -> Edit:
    name = clean.name(value, "the title")
    return Edit(f"title {name}", partial(edits.set_name, name=name), "title", time.monotonic())


def _noted(value: object) -> Edit:
    notes = clean.text(value, _MOST_NOTES, "the notes")
    return Edit("notes", partial(edits.set_notes, notes=notes), gesture="notes", at=time.monotonic())
