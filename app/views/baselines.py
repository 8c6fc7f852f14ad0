"""Run: runs that are kept to compare with, their names and colours."""

from __future__ import annotations

from functools import partial
from typing import Any

import viser

from app import clean
from app.palette import KEPT, MUTED, css
from app.state import MAX_KEPT, AppState, Edit, KeptRemoved, KeptRenamed, RunKept
from app.store import Shown, Store
from app.widgets import div, escape, number, on_input, put


class BaselinesView:
    """A button that keeps the present run, and one row for each that is kept."""

    def __init__(self, gui: viser.GuiApi, store: Store) -> None:
        self._store = store
        self._list = gui.add_html("")
        keep = gui.add_button("Keep as baseline", hint="Its arm, curves and figures stay beside the present run")
        on_input(keep, store.dispatch, lambda _: RunKept())
        self._names: list[Any] = []
        for slot in range(MAX_KEPT):
            name = gui.add_text(f"name {slot + 1}", "", visible=False)
            on_input(name, store.dispatch, partial(_rename, slot))
            self._names.append(name)
        self._use = gui.add_button_group("use again", ("–",), visible=False, hint="Take back that baseline's rules")
        on_input(self._use, store.dispatch, self._take_back)
        self._remove = gui.add_button_group("remove", ("–",), visible=False)
        on_input(self._remove, store.dispatch, lambda value: KeptRemoved(self._slot(value)))

    def shows(self, state: AppState) -> Shown:
        """Return the parts that are shown."""
        return (state.runs.kept,)

    def render(self, state: AppState) -> None:
        """Show what is kept."""
        kept = state.runs.kept
        by_slot = {one.slot: one for one in kept}
        for slot, handle in enumerate(self._names):
            put(handle, visible=slot in by_slot)
            handle.value = by_slot[slot].name if slot in by_slot else ""
        options = tuple(str(one.slot + 1) for one in kept) or ("–",)
        for handle in (self._use, self._remove):
            put(handle, visible=bool(kept), options=options)
        lines = [
            f'<span style="color:{css(KEPT[one.slot])}">━ {one.slot + 1}</span> {escape(one.name)} '
            f'<span style="color:{MUTED}">{escape(one.setup.scenario)}, {escape(one.setup.arm)} · overshoot '
            f"{number(one.result.metrics.overshoot['worst'])} %</span>"
            for one in kept
        ]
        text = "<br>".join(lines) or "Nothing is kept. Up to four runs stay beside the present one."
        self._list.content = div(text, "" if kept else f"color:{MUTED}")

    def _slot(self, value: object) -> int:
        slots = {str(one.slot + 1): one.slot for one in self._store.state.runs.kept}
        return slots[clean.choice(value, slots, "the baseline")]

    def _take_back(self, value: object) -> Edit:
        slot = self._slot(value)
        one = next(one for one in self._store.state.runs.kept if one.slot == slot)
        return Edit(f"rules of baseline '{one.name}'", lambda _: one.document)


def _rename(slot: int, value: object) -> KeptRenamed:
    return KeptRenamed(slot, clean.name(value, "the name"))
