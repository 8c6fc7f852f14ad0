"""The chosen term: its name, its place among the others, its shape and its numbers."""

from __future__ import annotations

import math
import time
from functools import partial
from typing import Any

import viser

from app import clean
from app.numbers import NumberRow
from app.state import AppState, DesignChanged, Edit, Event, Selected
from app.store import Shown, Store
from app.views.membership.choice import (
    chosen,
    chosen_term,
    digits,
    edit_of_term,
    is_shown_as,
    possible_mode,
)
from app.widgets import MARK, ChoiceGroup, on_input, put
from fuzzy import edits, shapes
from fuzzy.edits import MoveMode, Side
from fuzzy.shapes import Shape
from fuzzy.system import FuzzySystem, Output, Variable

_ACTIONS = ("rename", "add", "remove", "◂", "▸")
_SIDES: dict[str, Side] = {"−∞": "left", "+∞": "right"}
_NOT = "not"
_ROWS = 4
"""Rows of three numbers; a shape with more is dragged, or edited in the file."""


class TermView:
    """Editors of one term."""

    def __init__(self, gui: viser.GuiApi, store: Store) -> None:
        self._store = store
        self._term = ChoiceGroup(gui, "term", store.dispatch, lambda name: Selected({"term": name}))
        self._name = gui.add_text("name", "", hint="Of the chosen term for rename; of a new one beside it for add")
        on_input(
            self._name, store.dispatch, lambda text: DesignChanged({"term_name": clean.text(text, 4 * clean.MAX_NAME)})
        )
        actions = gui.add_button_group("", _ACTIONS)
        on_input(actions, store.dispatch, self._act)
        self._shape: Any = gui.add_dropdown("shape", tuple(shapes.kind(shape) for shape in shapes.SHAPES))
        on_input(self._shape, store.dispatch, self._change_shape)
        self._rows = [NumberRow(gui, store.dispatch, partial(self._set_parameters, row)) for row in range(_ROWS)]
        self._traits: Any = gui.add_button_group(
            "open · not", (*_SIDES, _NOT), hint="Sides that stay 1 up to infinity; not: the complement of the shape"
        )
        on_input(self._traits, store.dispatch, self._toggle)
        self._height = gui.add_slider("height", 0.0, 1.0, 0.01, 1.0, hint="Greatest degree")
        on_input(self._height, store.dispatch, self._set_height)

    def shows(self, state: AppState) -> Shown:
        """Return the parts that are shown."""
        return state.document, state.variable, state.term, state.design

    def render(self, state: AppState) -> None:
        """Show the chosen term."""
        variable = chosen(state)
        entry = chosen_term(state)
        shape = entry.shape
        self._term.show([term.name for term in variable.terms], state.term)
        self._name.value = state.term if state.design.term_name is None else state.design.term_name
        kinds = _kinds(variable)
        put(self._shape, options=kinds)
        self._shape.value = shapes.kind(shape)
        finite = _finite(shape)
        for number, row in enumerate(self._rows):
            row.show(finite[3 * number : 3 * number + 3] if len(finite) <= 3 * _ROWS else [], digits(variable))
        values = shapes.parameters(shape)
        is_on = {"−∞": -math.inf in values, "+∞": math.inf in values, _NOT: entry.complement}
        sides = edits.sides_that_open(shape)
        offered = (*(text for text, side in _SIDES.items() if side in sides), _NOT)
        options = tuple(f"{MARK}{text}" if is_on[text] else text for text in offered)
        put(self._traits, options=options)
        self._height.value = float(entry.height)

    def _act(self, value: object) -> Event | tuple[Event, ...] | None:
        state = self._store.state
        action = clean.choice(value, _ACTIONS, "the action")
        variable, term = chosen(state), state.term
        names = [entry.name for entry in variable.terms]
        if action in ("◂", "▸"):
            place = names.index(term) + (1 if action == "▸" else -1)
            if not 0 <= place < len(names):
                return None
            change = partial(edits.move_term, variable=variable.name, term=term, place=place)
            return Edit(f"{variable.name}: move {term}", change, f"order {variable.name}")
        if action == "remove":
            change = partial(edits.remove_term, variable=variable.name, term=term)
            lost = edits.rules_with(state.document, variable.name, term)
            left = f", and {lost} rule{'s' if lost != 1 else ''} with it" if lost else ""
            return Edit(f"{variable.name}: remove {term}{left}", change)
        name = clean.name(term if state.design.term_name is None else state.design.term_name, "the term's name")
        if action == "rename":
            change = partial(edits.rename_term, variable=variable.name, term=term, name=name)
            return Edit(f"{variable.name}: rename {term} to {name}", change), Selected({"term": name})
        name = edits.fresh_name(variable, name)
        joins = possible_mode(variable, state.drag) == "partition"
        change = partial(edits.insert_term, variable=variable.name, name=name, after=term, joins=joins)
        return Edit(f"{variable.name}: add {name}", change), Selected({"term": name})

    def _change_shape(self, value: object) -> Edit:
        state = self._store.state
        kind = clean.choice(value, _kinds(chosen(state)), "the shape")
        change = partial(edits.set_shape_kind, variable=state.variable, term=state.term, kind=kind)
        return edit_of_term(state, f"{state.variable} {state.term}: {kind}", change, state.term)

    def _set_parameters(self, row: int, values: tuple[float, ...]) -> Edit | None:
        state = self._store.state
        variable = chosen(state)
        shown = _finite(chosen_term(state).shape)[3 * row : 3 * row + 3]
        if len(shown) != len(values):
            return None  # sent for another shape
        changes = {
            name: value
            for (name, present), value in zip(shown, values, strict=True)
            if not is_shown_as(value, present, digits(variable))
        }
        if not changes:
            return None
        what = ", ".join(f"{name} = {value:g}" for name, value in changes.items())
        change = partial(
            _moved, variable=variable.name, term=state.term, changes=changes, mode=possible_mode(variable, state.drag)
        )
        gesture = f"number {variable.name} {state.term} {' '.join(changes)}"
        return edit_of_term(state, f"{state.term} {what}", change, state.term, gesture)

    def _toggle(self, value: object) -> Edit:
        state = self._store.state
        text = clean.choice(value.removeprefix(MARK) if isinstance(value, str) else value, (*_SIDES, _NOT), "the trait")
        variable, term = state.variable, state.term
        if text == _NOT:
            is_complement = not chosen_term(state).complement
            change = partial(edits.set_complement, variable=variable, term=term, is_complement=is_complement)
            return Edit(f"{variable} {term}: {'complement' if is_complement else 'no complement'}", change)
        change = partial(edits.toggle_open_side, variable=variable, term=term, side=_SIDES[text])
        return edit_of_term(state, f"{variable} {term}: open to {text}", change, term)

    def _set_height(self, value: object) -> Edit | None:
        state = self._store.state
        height = clean.number(value, 0.0, 1.0, "the height")
        if height == chosen_term(state).height:
            return None
        change = partial(edits.set_height, variable=state.variable, term=state.term, height=height)
        gesture = f"height {state.variable} {state.term}"
        return Edit(f"{state.term}: height {height:g}", change, gesture, time.monotonic())


def _kinds(variable: Variable) -> tuple[str, ...]:
    """Return the shapes that a term of a variable may take; those of outputs may be functions of the inputs."""
    kinds = shapes.KINDS if isinstance(variable, Output) else shapes.SHAPES
    return tuple(shapes.kind(shape) for shape in kinds)


def _finite(shape: Shape) -> list[tuple[str, float]]:
    pairs = zip(shapes.parameter_names(shape), shapes.parameters(shape), strict=True)
    return [(name, value) for name, value in pairs if math.isfinite(value)]


def _moved(system: FuzzySystem, variable: str, term: str, changes: dict[str, float], mode: MoveMode) -> FuzzySystem:
    for parameter, value in changes.items():
        system = edits.move_point(system, variable, term, parameter, value, mode)
    return system
