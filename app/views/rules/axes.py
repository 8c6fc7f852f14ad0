"""Design › Rules, upper part: which two inputs the table shows, for which terms of the others, and which output."""

from __future__ import annotations

from functools import partial
from typing import Any

import viser

from app import clean
from app.state import AppState, DesignChanged, Event
from app.store import Shown, Store
from app.widgets import on_input
from fuzzy.edits import Grid
from fuzzy.system import FuzzySystem, Input, Is

_ANY = "(not named)"
"""The slice of rules that do not name an input."""


class AxesView:
    """Choices that a system with two inputs and one output does not need, and then does not show."""

    def __init__(self, gui: viser.GuiApi, store: Store) -> None:
        self._gui = gui
        self._store = store
        self._place = gui.add_folder(None)
        self._key: tuple[Any, ...] = ()
        self._parts: list[Any] = []
        self._axes: dict[str, Any] = {}
        self._slices: dict[str, Any] = {}

    def shows(self, state: AppState) -> Shown:
        """Return the parts that are shown."""
        return state.document, state.design

    def render(self, state: AppState) -> None:
        """Show the choices of the document's grid."""
        shown = state.design.grid
        if shown is None or not _is_needed(state.document):
            self._place.visible = False
            return
        self._place.visible = True
        self._ensure(state.document, shown)
        for axis, handle in self._axes.items():
            handle.value = getattr(shown, axis)
        said = {one.variable: one.term for one in shown.slice}
        for name, handle in self._slices.items():
            handle.value = said.get(name, _ANY)

    def _ensure(self, system: FuzzySystem, shown: Grid) -> None:
        """Make a dropdown for each axis and each other input."""
        others = [variable for variable in system.inputs if variable.name not in shown[:2]]
        inputs, outputs = (tuple(v.name for v in variables) for variables in (system.inputs, system.outputs))
        key = (inputs, outputs, tuple((v.name, tuple(term.name for term in v.terms)) for v in others))
        if key == self._key:
            return
        self._key = key
        for handle in self._parts:
            handle.remove()
        with self._place:
            self._axes = {
                axis: self._gui.add_dropdown(axis, options)
                for axis, options in (("rows", inputs), ("columns", inputs), ("output", outputs))
            }
            self._slices = {
                variable.name: self._gui.add_dropdown(
                    f"{variable.name} is", (_ANY, *(term.name for term in variable.terms if term.name != _ANY))
                )
                for variable in others
            }
        self._parts = [*self._axes.values(), *self._slices.values()]
        for axis, options in (("rows", inputs), ("columns", inputs), ("output", outputs)):
            on_input(self._axes[axis], self._store.dispatch, partial(self._choose_axis, axis, options))
        for variable in others:
            on_input(self._slices[variable.name], self._store.dispatch, partial(self._choose_slice, variable))

    def _choose_axis(self, axis: str, options: tuple[str, ...], value: object) -> Event:
        shown = self._present()
        name = clean.choice(value, options, f"the variable of the {axis}")
        changed = shown._replace(**{axis: name})
        if changed.rows == changed.columns:  # the two change places
            changed = changed._replace(**{"columns" if axis == "rows" else "rows": getattr(shown, axis)})
        kept = tuple(one for one in shown.slice if one.variable not in changed[:2])
        return DesignChanged({"grid": changed._replace(slice=kept), "marked": ()})

    def _choose_slice(self, variable: Input, value: object) -> Event:
        shown = self._present()
        term = clean.choice(value, (_ANY, *(term.name for term in variable.terms)), f"the term of {variable.name}")
        kept = tuple(one for one in shown.slice if one.variable != variable.name)
        said = () if term == _ANY else (Is(variable.name, term),)
        return DesignChanged({"grid": shown._replace(slice=(*kept, *said)), "marked": ()})

    def _present(self) -> Grid:
        if self._store.state.design.grid is None:
            raise clean.Refused("the table is no longer there; valid is a system with two inputs")
        return self._store.state.design.grid


def _is_needed(system: FuzzySystem) -> bool:
    return len(system.inputs) > 2 or len(system.outputs) > 1
