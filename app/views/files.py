"""Design › Files: open and save rule bases, and the history of edits."""

from __future__ import annotations

from functools import partial
from typing import Any

import viser

from app import clean
from app.filing import Filing
from app.palette import BAD, MUTED
from app.state import AppState, Edit, Event, Redo, Selected, Undo
from app.store import Dispatch
from app.widgets import div, escape, on_input
from fuzzy import edits

_STEPS = 12
"""Steps of the history that are shown."""
_MOST_NOTES = 20_000
_ACTIONS = ("save", "reload")
_STEPPING = ("undo", "redo")


class FilesView:
    """The rulebases folder and the document's name, notes and history."""

    def __init__(self, gui: viser.GuiApi, dispatch: Dispatch, filing: Filing) -> None:
        self._filing = filing
        self._state: AppState | None = None
        self._current = gui.add_html("")
        self._file: Any = gui.add_dropdown("open", ("",), hint="Opens at once; undo brings back what was open before.")
        actions = gui.add_button_group("file", _ACTIONS)
        self._name = gui.add_text("new name", "")
        save_as = gui.add_button("Save under the new name", icon=viser.Icon.DEVICE_FLOPPY)
        self._notes = gui.add_text("notes", "", multiline=True)
        history = gui.add_button_group("history", _STEPPING)
        self._steps = gui.add_html("")
        on_input(self._file, dispatch, self._open)
        on_input(actions, dispatch, self._act)
        on_input(self._name, dispatch, lambda name: Selected({"new_name": clean.text(name, clean.MAX_NAME)}))
        on_input(save_as, dispatch, lambda _: self._save_as())
        on_input(self._notes, dispatch, _noted)
        on_input(history, dispatch, lambda which: Undo() if clean.choice(which, _STEPPING) == "undo" else Redo())

    def render(self, state: AppState) -> None:
        """Show which file is open, whether it is saved, and the steps that can be undone."""
        self._state = state
        mark = f' <b style="color:{BAD}">● not saved</b>' if state.is_unsaved else ""
        title = escape(state.document.name)
        self._current.content = div(f"<b>{title}</b> in {escape(state.file or 'no file')}{mark}")
        files = state.files if state.file in state.files else (state.file or "", *state.files)
        if tuple(self._file.options) != files:
            self._file.options = files
        self._file.value = state.file or ""
        self._name.value = state.new_name
        self._notes.value = state.document.notes
        undone = [f'<li style="opacity:.5">{escape(step.label)}</li>' for step in reversed(state.future[:3])]
        done = [f"<li>{escape(step.label)}</li>" for step in reversed(state.past[-_STEPS:])]
        head = f"{len(state.past)} to undo, {len(state.future)} to redo"
        steps = f'<ul style="margin:0.3em 0;padding-left:1.3em">{"".join((*undone, *done))}</ul>'
        self._steps.content = div(head + steps, f"color:{MUTED}")

    async def _act(self, value: object) -> Event:
        if clean.choice(value, _ACTIONS, "the action") == "save":
            return await self._filing.save()
        return await self._filing.open(self._present().file)

    async def _save_as(self) -> Event:
        text = self._present().new_name.strip()
        return await self._filing.save_as(clean.file_name(text if text.endswith(".yaml") else f"{text}.yaml"))

    async def _open(self, value: object) -> Event:
        return await self._filing.open(clean.choice(value, self._present().files, "the file"))

    def _present(self) -> AppState:
        assert self._state is not None, "rendered before any callback"
        return self._state


def _noted(value: object) -> Edit:
    notes = clean.text(value, _MOST_NOTES, "the notes")
    return Edit("notes", partial(edits.set_notes, notes=notes), gesture="notes")
