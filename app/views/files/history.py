"""The history of edits: a click leads to any of its steps, back or forth."""

from __future__ import annotations

import viser

from app import clean, grid
from app.palette import MUTED
from app.state import AppState, JumpedTo, Redo, Undo
from app.store import Shown, Store
from app.widgets import div, escape, on_input

_PAST, _FUTURE = 12, 6
"""Steps that are shown: those that were done last, and those that were taken back last."""
_STEPPING = ("undo", "redo")


class HistoryView:
    """The steps, the newest first; what was taken back stands above the present one, pale."""

    def __init__(self, gui: viser.GuiApi, store: Store) -> None:
        self._store = store
        self._jumps: list[int] = []
        stepping = gui.add_button_group("history", _STEPPING)
        on_input(stepping, store.dispatch, lambda which: Undo() if clean.choice(which, _STEPPING) == "undo" else Redo())
        self._rows = gui.add_html("")
        count = _PAST + _FUTURE + 1
        self._buttons = grid.HiddenButtons(gui, [f"step {n + 1} of the history" for n in range(count)], self._jump)

    def shows(self, state: AppState) -> Shown:
        """Return the parts that are shown."""
        return state.past, state.future

    def render(self, state: AppState) -> None:
        """List the steps."""
        future = list(enumerate((step.label for step in state.future[:_FUTURE]), start=1))
        shown = state.past[-_PAST:]
        past = [(number + 1 - len(shown), step.label) for number, step in enumerate(shown)]
        start = "as it was opened" if len(shown) == len(state.past) else "…"
        entries = [*reversed(future), *reversed(past), (-len(shown), start)]
        self._jumps = [jump for jump, _ in entries]
        rows = (
            grid.row_html(target, f"step{number}", _label(jump, label))
            for number, ((jump, label), target) in enumerate(zip(entries, self._buttons.ids, strict=False))
        )
        head = div(f"{len(state.past)} to undo, {len(state.future)} to redo; a click goes there", f"color:{MUTED}")
        self._rows.content = head + grid.rows_html(list(rows)) + grid.chosen_html(f"step{len(future)}")

    def _jump(self, number: int) -> None:
        if number < len(self._jumps) and self._jumps[number]:
            self._store.dispatch(JumpedTo(self._jumps[number]))


def _label(jump: int, label: str) -> str:
    return f'<span style="opacity:.5">{escape(label)}</span>' if jump > 0 else escape(label)
