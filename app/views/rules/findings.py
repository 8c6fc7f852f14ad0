"""What the check says about the document, a sentence each; a click selects what it is about."""

from __future__ import annotations

from collections.abc import Iterator

import viser

from app import grid
from app.palette import BAD, ERROR, MUTED
from app.state import AppState, DesignChanged, Event, Notice, Noticed, Selected
from app.store import Shown, Store
from app.widgets import div, escape
from fuzzy.edits import Grid
from fuzzy.finding import Finding
from fuzzy.system import FuzzySystem

_MOST = 24
"""Findings that are shown; the rest are counted."""

_HEIGHT = 152
"""Pixels that the findings may take; the rest is reached by scrolling."""

_COLORS = {"error": ERROR, "warning": BAD, "hint": MUTED}


class FindingsView:
    """The findings as rows that can be clicked."""

    def __init__(self, gui: viser.GuiApi, store: Store) -> None:
        self._store = store
        self._rows = gui.add_html("")
        self._chosen = gui.add_html("")
        self._buttons = grid.HiddenButtons(gui, [f"finding {n + 1}" for n in range(_MOST)], self._choose)

    def shows(self, state: AppState) -> Shown:
        """Return the parts that are shown."""
        return state.findings, state.design.marked

    def render(self, state: AppState) -> None:
        """List the findings of the last run's document."""
        rows = [
            grid.row_html(
                target,
                f"finding{number}",
                f'<span style="color:{_COLORS[finding.level]}">▲</span> {escape(finding.message)}',
            )
            for number, (finding, target) in enumerate(zip(state.findings, self._buttons.ids, strict=False))
        ]
        if len(state.findings) > _MOST:
            rows.append(div(f"and {len(state.findings) - _MOST} more", f"color:{MUTED}"))
        self._rows.content = grid.rows_html(rows, height=_HEIGHT)
        marked = [
            n for n, finding in enumerate(state.findings) if finding.cells and finding.cells == state.design.marked
        ]
        self._chosen.content = grid.chosen_html(f"finding{marked[0]}") if marked else ""

    def _choose(self, number: int) -> None:
        if number < len(self._store.state.findings):
            for event in culprit_events(self._store.state.document, self._store.state.findings[number]):
                self._store.dispatch(event)


def culprit_events(document: FuzzySystem, finding: Finding) -> Iterator[Event]:
    """Return what selects the place that a finding is about: cells, a rule of the list, a variable or a term."""
    table = document.rules.table
    if finding.cells and table is not None:
        shown = Grid(table.rows, table.columns, table.output)
        yield DesignChanged({"grid": shown, "marked": finding.cells})
        return
    for number in range(len(document.rules.list)):
        if finding.path == f"rules.list[{number}]":
            yield DesignChanged({"rule": number, "rule_text": None, "page": number // grid.PAGE})
            return
    places = {
        **{f"inputs.{variable.name}": variable for variable in document.inputs},
        **{f"outputs.{variable.name}": variable for variable in document.outputs},
    }
    for path, variable in places.items():
        term = next((term.name for term in variable.terms if finding.path == f"{path}.terms.{term.name}"), None)
        if term is not None:
            yield Selected({"variable": variable.name, "term": term})
            yield Noticed(Notice(f"Chosen in Membership: {variable.name}, {term}."))
            return
    for path, variable in places.items():
        if finding.path in {path, f"{path}.terms", f"{path}.range"}:
            yield Selected({"variable": variable.name})
            yield Noticed(Notice(f"Chosen in Membership: {variable.name}."))
            return
