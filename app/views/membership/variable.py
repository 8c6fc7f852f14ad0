"""The chosen variable as a whole: its name, unit and range, and the number of its terms."""

from __future__ import annotations

import time
from functools import partial

import viser

from app import clean
from app.numbers import MOST_VALUE
from app.state import AppState, DesignChanged, Edit, Event, Selected
from app.store import Shown, Store
from app.views.membership.choice import chosen, digits, is_shown_as
from app.widgets import on_input, put
from fuzzy import edits
from fuzzy.limits import MAX_TERMS
from fuzzy.system import Variable

_SPACED = ("triangle", "trapezoid", "gaussian", "singleton")
"""Shapes of evenly spaced terms."""


_CHANGES = _RENAME, _REMOVE = ("rename variable", "remove variable")
_ADDITIONS = {"add input": edits.add_input, "add output": edits.add_output}


class VariableView:
    """Editors of one variable."""

    def __init__(self, gui: viser.GuiApi, store: Store) -> None:
        self._store = store
        self._range = gui.add_vector2("range", (0.0, 1.0), step=0.001)
        on_input(self._range, store.dispatch, self._set_range)
        self._stretch = gui.add_checkbox(
            "stretch terms", initial_value=False, hint="Whether the terms are stretched along when the range changes"
        )
        on_input(self._stretch, store.dispatch, lambda value: DesignChanged({"stretches": clean.flag(value)}))
        self._unit = gui.add_text("unit", "")
        on_input(self._unit, store.dispatch, self._set_unit)
        self._count = gui.add_number("even terms", 7, min=1, max=MAX_TERMS, step=1)
        on_input(self._count, store.dispatch, _counted)
        spaced = gui.add_button_group("space them as", _SPACED, hint="Rules follow to the nearest term")
        on_input(spaced, store.dispatch, self._space)
        self._name = gui.add_text("variable name", "")
        on_input(
            self._name, store.dispatch, lambda t: DesignChanged({"variable_name": clean.text(t, 4 * clean.MAX_NAME)})
        )
        hint = "A removed variable's rules go with it; Ctrl+Z brings all back"
        changes = gui.add_button_group("", _CHANGES, hint=hint)
        on_input(changes, store.dispatch, self._change)
        additions = gui.add_button_group("", tuple(_ADDITIONS), hint="Under the name above, or the first free one")
        on_input(additions, store.dispatch, self._add)

    def shows(self, state: AppState) -> Shown:
        """Return the parts that are shown."""
        return state.document, state.variable, state.design

    def render(self, state: AppState) -> None:
        """Show the chosen variable."""
        variable, design = chosen(state), state.design
        decimals = digits(variable)
        put(self._range, precision=decimals, step=10.0**-decimals)
        self._range.value = (float(variable.low), float(variable.high))
        self._stretch.value = design.stretches
        self._unit.value = variable.unit
        self._count.value = len(variable.terms) if design.count is None else design.count
        self._name.value = variable.name if design.variable_name is None else design.variable_name

    def _set_range(self, value: object) -> Edit | None:
        state, variable = self._present()
        if not isinstance(value, tuple) or len(value) != 2:
            raise clean.Refused("the range is no pair; valid are two numbers")
        low, high = (
            present if is_shown_as(sent, present, digits(variable)) else sent
            for sent, present in zip(
                (clean.number(end, -MOST_VALUE, MOST_VALUE, "the range") for end in value),
                (variable.low, variable.high),
                strict=True,
            )
        )
        if (low, high) == (variable.low, variable.high):
            return None
        change = partial(
            edits.set_range, variable=variable.name, low=low, high=high, scales_terms=state.design.stretches
        )
        label = f"{variable.name}: range {low:g} to {high:g}"
        return Edit(label, change, f"range {variable.name}", time.monotonic())

    def _set_unit(self, value: object) -> Edit:
        _, variable = self._present()
        unit = clean.text(value, clean.MAX_NAME, "the unit")
        change = partial(edits.set_unit, variable=variable.name, unit=unit)
        return Edit(f"{variable.name}: unit {unit}", change, f"unit {variable.name}", time.monotonic())

    def _space(self, value: object) -> Edit:
        state, variable = self._present()
        kind = clean.choice(value, _SPACED, "the shape")
        count = len(variable.terms) if state.design.count is None else state.design.count
        change = partial(edits.space_terms, variable=variable.name, count=count, kind=kind)
        return Edit(f"{variable.name}: {count} even terms", change)

    def _change(self, value: object) -> tuple[Event, ...]:
        return self._rename() if clean.choice(value, _CHANGES, "the action") == _RENAME else self._remove()

    def _remove(self) -> tuple[Event, ...]:
        _, variable = self._present()
        return (Edit(f"remove {variable.name}", partial(edits.remove_variable, variable=variable.name)),)

    def _add(self, value: object) -> tuple[Event, ...]:
        """Add a variable under the name that is written, or under the first free one where that is taken."""
        state, variable = self._present()
        label = clean.choice(value, _ADDITIONS, "the action")
        taken = {entry.name for entry in (*state.document.inputs, *state.document.outputs)}
        written = variable.name if state.design.variable_name is None else state.design.variable_name
        free = next(name for name in (f"x{number}" for number in range(1, len(taken) + 2)) if name not in taken)
        name = free if written in taken else clean.name(written, "the variable's name")
        return Edit(f"{label} {name}", partial(_ADDITIONS[label], name=name)), Selected({"variable": name})

    def _rename(self) -> tuple[Event, ...]:
        state, variable = self._present()
        wanted = variable.name if state.design.variable_name is None else state.design.variable_name
        name = clean.name(wanted, "the variable's name")
        change = partial(edits.rename_variable, variable=variable.name, name=name)
        return Edit(f"rename {variable.name} to {name}", change), Selected({"variable": name, "term": state.term})

    def _present(self) -> tuple[AppState, Variable]:
        return self._store.state, chosen(self._store.state)


def _counted(value: object) -> DesignChanged:
    return DesignChanged({"count": round(clean.number(value, 1, MAX_TERMS, "the number of terms"))})
