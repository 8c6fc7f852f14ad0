"""The points of terms that can be dragged, as thumbs of a slider below the chart."""

from __future__ import annotations

import math
from functools import partial
from typing import Any, NamedTuple

import viser

from app import clean
from app.state import AppState, DragMode, Selected
from app.store import Shown, Store
from app.views.membership.choice import chosen, edit_of_term, extent, possible_mode
from app.widgets import Meaning, full_width_html, on_input
from fuzzy import edits, shapes
from fuzzy.shapes import Shape
from fuzzy.system import FuzzySystem, Variable

_STEPS = 400
"""Positions of a thumb over the variable's range."""
_MARGINS = (50, 12)
"""Pixels that put the slider's ends under the ends of the chart's axis."""

_SPREADS = {
    "sigma": ("mean", 1.0),
    "left_sigma": ("left_mean", -1.0),
    "right_sigma": ("right_mean", 1.0),
    "width": ("center", 1.0),
}
"""Widths are dragged at that distance from the parameter that is their middle, to its right or left."""


class Thumb(NamedTuple):
    """A point that can be dragged: a parameter of a term, and where it stands."""

    term: str
    parameter: str
    value: float


class PointsView:
    """A slider with a thumb for each point."""

    def __init__(self, gui: viser.GuiApi, store: Store) -> None:
        self._gui = gui
        self._store = store
        self._thumbs: tuple[Thumb, ...] = ()
        self._slider: Any = None
        self._parts: list[Any] = []
        self._key: tuple[Any, ...] = ()
        self._place = gui.add_folder(None)

    def shows(self, state: AppState) -> Shown:
        """Return the parts that are shown."""
        return state.document, state.variable, state.term, state.drag

    def render(self, state: AppState) -> None:
        """Put the thumbs where the points are; a slider with another number of thumbs or range is made anew."""
        variable = chosen(state)
        self._thumbs = thumbs(variable, state.term, state.drag)
        low, high = extent(variable)
        key = (variable.name, low, high, tuple((thumb.term, thumb.parameter) for thumb in self._thumbs))
        values = tuple(thumb.value for thumb in self._thumbs)
        if key == self._key:
            if self._slider is not None:
                self._slider.value = values
            return
        self._key = key
        for handle in self._parts:
            handle.remove()
        self._parts, self._slider = [], None
        if values:
            with self._place:
                marks = ((low, f"{low:.4g}"), (high, f"{high:.4g}"))
                self._slider = self._gui.add_multi_slider("", low, high, (high - low) / _STEPS, values, marks=marks)
                style = self._gui.add_html(full_width_html(self._slider, *_MARGINS))
            self._parts = [self._slider, style]
            on_input(self._slider, self._store.dispatch, self._dragged)

    def _dragged(self, values: Any) -> Meaning:
        state = self._store.state
        assert state is not None, "rendered before any callback"
        variable = chosen(state)
        low, high = extent(variable)
        is_shown = self._key[:1] == (variable.name,)
        if not is_shown or not isinstance(values, tuple) or len(values) != len(self._thumbs):
            return None  # sent for thumbs that are there no more
        cleaned = [clean.number(value, low, high, "the point") for value in values]
        moved = [
            (thumb, value)
            for thumb, value in zip(self._thumbs, cleaned, strict=True)
            if not math.isclose(value, thumb.value, rel_tol=0.0, abs_tol=(high - low) / _STEPS / 4)
        ]
        if not moved:
            return None
        thumb = moved[0][0]
        change = partial(
            _moved_all, variable=variable.name, moved=tuple(moved), mode=possible_mode(variable, state.drag)
        )
        gesture = f"drag {variable.name} {thumb.term} {thumb.parameter}"
        edit = edit_of_term(state, f"{variable.name}: drag {thumb.term}", change, thumb.term, gesture)
        return edit if thumb.term == state.term else (Selected({"term": thumb.term}), edit)


def thumbs(variable: Variable, term: str, mode: DragMode) -> tuple[Thumb, ...]:
    """Return the points that can be dragged, from left to right.

    In a partition of triangles and trapezoids these are the tops of all terms, since their feet follow; otherwise the
    finite points and the widths of the chosen term.
    """
    mode = possible_mode(variable, mode)
    found = []
    for entry in variable.terms:
        if mode == "partition":
            names = shapes.parameter_names(entry.shape)[1:-1]
            found += [thumb for thumb in shape_thumbs(entry.name, entry.shape) if thumb.parameter in names]
        elif entry.name == term:
            found += shape_thumbs(entry.name, entry.shape)
    low, high = extent(variable)
    return tuple(sorted((t for t in found if low <= t.value <= high), key=lambda thumb: thumb.value))


def shape_thumbs(term: str, shape: Shape) -> list[Thumb]:
    """Return a thumb for each parameter of a shape that is a finite place or a width."""
    values = dict(zip(shapes.parameter_names(shape), shapes.parameters(shape), strict=True))
    found = [Thumb(term, name, values[name]) for name in shapes.location_names(shape)]
    for name, (middle, side) in _SPREADS.items():
        if name in values:
            found.append(Thumb(term, name, values[middle] + side * values[name]))
    return [thumb for thumb in found if math.isfinite(thumb.value)]


def _moved_all(
    system: FuzzySystem, variable: str, moved: tuple[tuple[Thumb, float], ...], mode: DragMode
) -> FuzzySystem:
    """Return the system with thumbs moved, one after the other."""
    for thumb, place in moved:
        value = place
        if thumb.parameter in _SPREADS:
            middle, side = _SPREADS[thumb.parameter]
            named = next(v for v in (*system.inputs, *system.outputs) if v.name == variable)
            shape = next(term.shape for term in named.terms if term.name == thumb.term)
            values = dict(zip(shapes.parameter_names(shape), shapes.parameters(shape), strict=True))
            value = side * (place - values[middle])
        system = edits.move_point(system, variable, thumb.term, thumb.parameter, value, mode)
    return system
