"""Design › Membership: the terms of a variable, drawn and dragged."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from functools import partial
from typing import Any, NamedTuple, get_args

import numpy as np
import viser

from app import clean
from app.charts import Line, add_chart, series
from app.palette import MUTED, css, term_color
from app.runner import Frame
from app.state import AppState, DragMode, Edit, Event, Selected
from app.store import Dispatch
from app.widgets import ChoiceGroup, div, escape, full_width_html, on_input
from fuzzy import edits, sets, shapes
from fuzzy.shapes import Gaussian, Trapezoid, Triangle
from fuzzy.system import FuzzySystem, Input, Variable

_POINTS = 241
_HEIGHT = 170
_STEPS = 400
"""Positions of a thumb over the variable's range."""
_SLIDER_MARGINS = (50, 12)
"""Pixels that put the slider's ends under the ends of the chart's axis."""
_MOST_PARAMETERS = 4
_STEP = 0.001
"""Step, and with it the shown digits, of the number fields."""
_MOST_VALUE = 1e12
_SPREAD = "mean + sigma"
"""The thumb that moves a Gaussian's sigma."""


class Thumb(NamedTuple):
    """A point that can be dragged: a parameter of a term, and where it stands."""

    term: str
    parameter: str
    value: float


class MembershipView:
    """Chart, thumbs and numbers of one variable's terms."""

    def __init__(self, gui: viser.GuiApi, dispatch: Dispatch) -> None:
        self._gui = gui
        self._dispatch = dispatch
        self._state: AppState | None = None
        self._drawn: tuple[Any, ...] = ()
        self._lines: list[Line] = []
        self._chart_key: tuple[Any, ...] = ()
        self._thumbs: tuple[Thumb, ...] = ()
        self._slider: Any = None
        self._slider_parts: list[Any] = []
        self._slider_key: tuple[Any, ...] = ()
        self._variable = ChoiceGroup(gui, "variable", dispatch, lambda name: Selected({"variable": name}))
        self._legend = gui.add_html("")
        self._chart_place = gui.add_folder(None)
        self._chart: viser.GuiUplotHandle | None = None
        self._slider_place = gui.add_folder(None)
        self._drag = gui.add_dropdown("drag", get_args(DragMode), hint="partition: neighbours follow, the sum stays 1")
        on_input(self._drag, dispatch, lambda mode: Selected({"drag": clean.choice(mode, get_args(DragMode))}))
        self._term = ChoiceGroup(gui, "term", dispatch, lambda name: Selected({"term": name}))
        self._shape = gui.add_dropdown("shape", tuple(shapes.kind(shape) for shape in shapes.SHAPES))
        on_input(self._shape, dispatch, self._change_shape)
        self._numbers = [gui.add_number("abcd"[n], 0.0, step=_STEP) for n in range(_MOST_PARAMETERS)]
        for n, field in enumerate(self._numbers):
            on_input(field, dispatch, partial(self._set_parameter, n))
        self._low = gui.add_number("range from", 0.0, step=_STEP)
        self._high = gui.add_number("range to", 1.0, step=_STEP)
        on_input(self._low, dispatch, partial(self._set_range, is_low=True))
        on_input(self._high, dispatch, partial(self._set_range, is_low=False))

    def render(self, state: AppState) -> None:
        """Show the chosen variable and term."""
        self._state = state
        variable = chosen(state)
        self._variable.show([v.name for v in (*state.document.inputs, *state.document.outputs)], variable.name)
        self._term.show([term.name for term in variable.terms], state.term)
        self._drag.value = state.drag
        self._render_term(state, variable)
        self._render_slider(state, variable)
        self._low.value, self._high.value = float(variable.low), float(variable.high)
        drawn = (variable, state.term)
        if drawn != self._drawn:
            self._drawn = drawn
            self._draw(variable, state.term)
            self._legend.content = _legend_html(variable, state.term, None)

    def show(self, frame: Frame) -> None:
        """Show the live value of an input and its memberships."""
        state = self._state
        if state is None:
            return
        variable = chosen(state)
        names = [v.name for v in state.document.inputs]
        value = None
        if (
            frame.strength is not None
            and isinstance(variable, Input)
            and names.index(variable.name) < len(frame.inputs)
        ):
            value = float(frame.inputs[names.index(variable.name)])
        self._legend.content = _legend_html(variable, state.term, value)

    def _render_term(self, state: AppState, variable: Variable) -> None:
        shape = next(term.shape for term in variable.terms if term.name == state.term)
        self._shape.value = shapes.kind(shape)
        values, names = shapes.parameters(shape), shapes.parameter_names(shape)
        for n, field in enumerate(self._numbers):
            field.visible = n < len(values) and math.isfinite(values[n])
            if field.visible:
                field.label = f"{state.term}: {names[n]}"
                field.value = float(values[n])

    def _render_slider(self, state: AppState, variable: Variable) -> None:
        """Put the thumbs where the points are; a slider with another number of thumbs or range is made anew."""
        self._thumbs = thumbs(variable, state.term, state.drag)
        low, high = extent(variable)
        key = (variable.name, low, high, tuple((thumb.term, thumb.parameter) for thumb in self._thumbs))
        values = tuple(thumb.value for thumb in self._thumbs)
        if key == self._slider_key:
            if self._slider is not None:
                self._slider.value = values
            return
        self._slider_key = key
        for handle in self._slider_parts:
            handle.remove()
        self._slider_parts = []
        if values:
            with self._slider_place:
                marks = ((low, f"{low:.4g}"), (high, f"{high:.4g}"))
                self._slider = self._gui.add_multi_slider("", low, high, (high - low) / _STEPS, values, marks=marks)
                style = self._gui.add_html(full_width_html(self._slider, *_SLIDER_MARGINS))
            self._slider_parts = [self._slider, style]
            on_input(self._slider, self._dispatch, self._dragged)

    def _draw(self, variable: Variable, term: str) -> None:
        low, high = extent(variable)
        points = {point for entry in variable.terms for point in sets.break_points(entry)}
        x = np.union1d(np.linspace(low, high, _POINTS), [point for point in points if low <= point <= high])
        count = len(variable.terms)
        lines = []
        for number_, entry in enumerate(variable.terms):
            color = term_color(number_, count)
            is_chosen = entry.name == term
            fill = css(color, 0.22 if is_chosen else 0.06)
            lines.append(Line(entry.name, css(color), 3.0 if is_chosen else 1.6, fill=fill))
        data = (x, *(sets.degrees(entry, x) for entry in variable.terms))
        key = (variable.name, len(data), low, high)
        if self._chart is not None and key == self._chart_key:
            self._chart.data = data
            if lines != self._lines:
                self._lines = lines
                self._chart.series = series(lines, variable.name)
            return
        self._lines, self._chart_key = lines, key
        if self._chart is not None:  # uPlot would keep the other variable's axis, or another number of curves
            self._chart.remove()
        with self._chart_place:
            self._chart = add_chart(
                self._gui,
                lines,
                height=_HEIGHT,
                x_label=variable.name,
                y_range=(0.0, 1.05),
                has_legend=False,
                data=data,
            )

    def _dragged(self, values: Any) -> tuple[Event, ...] | None:
        state = self._present()
        variable = chosen(state)
        low, high = extent(variable)
        if not isinstance(values, tuple) or len(values) != len(self._thumbs):
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
        label = f"{variable.name}: drag {thumb.term}"
        change = partial(
            _moved_all, variable=variable.name, moved=tuple(moved), mode=possible_mode(variable, state.drag)
        )
        gesture = f"drag {variable.name} {thumb.term} {thumb.parameter}"
        return Selected({"term": thumb.term}), Edit(label, change, gesture, time.monotonic())

    def _set_parameter(self, n: int, value: object) -> Edit | None:
        state = self._present()
        variable = chosen(state)
        shape = next(term.shape for term in variable.terms if term.name == state.term)
        cleaned = clean.number(value, -_MOST_VALUE, _MOST_VALUE, "the parameter")
        if is_shown_as(cleaned, shapes.parameters(shape)[n]):
            return None
        return self._edit(
            f"{state.term} {shapes.parameter_names(shape)[n]} = {cleaned:g}",
            partial(
                edits.move_point,
                variable=state.variable,
                term=state.term,
                parameter=shapes.parameter_names(shape)[n],
                value=cleaned,
                mode=possible_mode(variable, state.drag),
            ),
            gesture=f"number {state.variable} {state.term} {n}",
        )

    def _change_shape(self, value: object) -> Edit:
        state = self._present()
        kind = clean.choice(value, [shapes.kind(shape) for shape in shapes.SHAPES], "the shape")
        change = partial(edits.set_shape_kind, variable=state.variable, term=state.term, kind=kind)
        return self._edit(f"{state.variable} {state.term}: {kind}", change)

    def _set_range(self, value: object, *, is_low: bool) -> Edit | None:
        state = self._present()
        variable = chosen(state)
        cleaned = clean.number(value, -_MOST_VALUE, _MOST_VALUE, "the range")
        if is_shown_as(cleaned, variable.low if is_low else variable.high):
            return None
        low, high = (cleaned, variable.high) if is_low else (variable.low, cleaned)
        change = partial(edits.set_range, variable=variable.name, low=low, high=high)
        return self._edit(f"range of {variable.name}", change, gesture=f"range {variable.name} {is_low}")

    def _edit(self, label: str, change: Callable[[FuzzySystem], FuzzySystem], gesture: str = "") -> Edit:
        return Edit(label, change, gesture, time.monotonic())

    def _present(self) -> AppState:
        assert self._state is not None, "rendered before any callback"
        return self._state


def chosen(state: AppState) -> Variable:
    """Return the variable whose terms are edited."""
    variables: tuple[Variable, ...] = (*state.document.inputs, *state.document.outputs)
    return next(variable for variable in variables if variable.name == state.variable)


def possible_mode(variable: Variable, wanted: DragMode) -> DragMode:
    """Return how points move: curved sets have no feet that could follow, so that a partition needs straight ones."""
    is_linear = all(isinstance(term.shape, Triangle | Trapezoid) for term in variable.terms)
    return wanted if is_linear else "free"


def is_shown_as(value: float, present: float) -> bool:
    """Whether a number field that shows ``present`` in its few digits sent no more than these back."""
    return abs(value - present) < 0.51 * _STEP and round(present, 3) == round(value, 3)


def extent(variable: Variable) -> tuple[float, float]:
    """Return the part of the axis that is drawn: the range, and points of terms that lie outside."""
    points = [point for term in variable.terms for point in sets.break_points(term)]
    return float(min(variable.low, *points)), float(max(variable.high, *points))


def thumbs(variable: Variable, term: str, mode: DragMode) -> tuple[Thumb, ...]:
    """Return the points that can be dragged, from left to right.

    In a partition of triangles and trapezoids these are the tops of all terms, since their feet follow; otherwise the
    finite points of the chosen term.
    """
    mode = possible_mode(variable, mode)
    found = []
    for entry in variable.terms:
        values = dict(zip(shapes.parameter_names(entry.shape), shapes.parameters(entry.shape), strict=True))
        if mode == "partition":
            tops = tuple(values)[1:-1]
            found += [Thumb(entry.name, name, values[name]) for name in tops]
        elif entry.name == term and isinstance(entry.shape, Gaussian):
            found.append(Thumb(term, "mean", entry.shape.mean))
            found.append(Thumb(term, _SPREAD, entry.shape.mean + entry.shape.sigma))
        elif entry.name == term:
            places = shapes.location_names(entry.shape)
            found += [Thumb(term, name, values[name]) for name in places if math.isfinite(values[name])]
    low, high = extent(variable)
    return tuple(sorted((t for t in found if low <= t.value <= high), key=lambda thumb: thumb.value))


def _moved_all(
    system: FuzzySystem, variable: str, moved: tuple[tuple[Thumb, float], ...], mode: DragMode
) -> FuzzySystem:
    """Return the system with thumbs moved, one after the other."""
    for thumb, value in moved:
        parameter, moved_to = thumb.parameter, value
        if parameter == _SPREAD:
            named = next(v for v in (*system.inputs, *system.outputs) if v.name == variable)
            shape = next(term.shape for term in named.terms if term.name == thumb.term)
            assert isinstance(shape, Gaussian)
            parameter, moved_to = "sigma", value - shape.mean
        system = edits.move_point(system, variable, thumb.term, parameter, moved_to, mode)
    return system


def _legend_html(variable: Variable, chosen_term: str, value: float | None) -> str:
    """Return the terms in their colours, with the degrees of the live value."""
    unit = f" {escape(variable.unit)}" if variable.unit else ""
    parts = []
    count = len(variable.terms)
    inside = None if value is None else min(max(value, variable.low), variable.high)
    for n, term in enumerate(variable.terms):
        degree = 0.0 if inside is None else float(sets.degrees(term, inside))
        weight = "700" if term.name == chosen_term else "400"
        text = f"{escape(term.name)} {degree:.2f}" if degree > 0.0 else escape(term.name)
        opacity = 1.0 if degree > 0.0 or inside is None else 0.75
        parts.append(
            f'<span style="color:{css(term_color(n, count))};font-weight:{weight};opacity:{opacity}">{text}</span>'
        )
    now = (
        ""
        if value is None
        else f'<br><span style="color:{MUTED}">now {escape(variable.name)} = {value:.3f}{unit}</span>'
    )
    return div(" · ".join(parts) + (now or f'<br><span style="color:{MUTED}">&nbsp;</span>'))
