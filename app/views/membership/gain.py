"""The gain that stands before an input of the fuzzy blocks or behind their output: GE, GC, GU."""

from __future__ import annotations

from typing import Any, NamedTuple

import viser

from app import clean
from app.palette import MUTED
from app.state import AppState, SetupChanged
from app.store import Shown, Store
from app.views.membership.choice import chosen
from app.widgets import coordinate_label, div, number, on_input, put
from robot import controllers
from robot.controllers import Gain

_MOST = 5.0
_STEP = 0.05


class _Place(NamedTuple):
    """A gain, and what it does."""

    gain: Gain
    name: str
    does: str


_INPUTS = (
    _Place("ge", "GE", "scales the error"),
    _Place("gc", "GC", "scales the error's rate"),
)
_OUTPUT = _Place("gu", "GU", "is what the end of the range adds")


class GainView:
    """A slider for the factor of the chosen variable's gain; hidden where the control law has none."""

    def __init__(self, gui: viser.GuiApi, store: Store) -> None:
        self._store = store
        self._factor: Any = gui.add_slider("GE ×", 0.0, _MOST, _STEP, 1.0, hint="Times its default, as in Run")
        on_input(self._factor, store.dispatch, self._set)
        self._text = gui.add_html("")

    def shows(self, state: AppState) -> Shown:
        """Return the parts that are shown."""
        return state.document, state.variable, state.coordinate, state.setup, state.runs.current

    def render(self, state: AppState) -> None:
        """Show the factor, and what the gain is for the chosen coordinate."""
        place = _place(state)
        result = state.runs.current
        gains = {} if result is None else controllers.gains(result.run.controller)
        put(self._factor, visible=place is not None and place.gain in gains)
        if place is None or result is None or place.gain not in gains:
            self._text.content = ""
            return
        put(self._factor, label=f"{place.name} ×")
        self._factor.value = min(getattr(state.setup, place.gain), _MOST)
        value = gains[place.gain][state.coordinate]
        name = coordinate_label(result.run.arm.coordinates[state.coordinate])
        self._text.content = div(f"{place.name} = {number(value, 4)} for {name}: {place.does}", f"color:{MUTED}")

    def _set(self, value: object) -> SetupChanged | None:
        place = _place(self._store.state)
        factor = clean.number(value, 0.0, _MOST, "the gain's factor")
        if place is None or factor == getattr(self._store.state.setup, place.gain):
            return None
        return SetupChanged({place.gain: factor})


def _place(state: AppState) -> _Place | None:
    """Return the gain at the chosen variable; None for one of a system that is no block of the arm's controller."""
    variable = chosen(state)
    inputs = [entry.name for entry in state.document.inputs]
    if len(inputs) != 2 or len(state.document.outputs) != 1:
        return None
    return _INPUTS[inputs.index(variable.name)] if variable.name in inputs else _OUTPUT
