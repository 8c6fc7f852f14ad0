"""Design › Membership: the terms of a variable, drawn and dragged, with the live value."""

from __future__ import annotations

from typing import Any, get_args

import numpy as np
import viser

from app import clean
from app.charts import Line, add_chart, series
from app.palette import MUTED, TEXT, css, term_colors
from app.runner import Frame
from app.state import AppState, DesignChanged, DragMode, Event, Selected
from app.store import Shown, Store, View
from app.views.membership.choice import chosen, extent
from app.views.membership.gain import GainView
from app.views.membership.points import PointsView
from app.views.membership.term import TermView
from app.views.membership.variable import VariableView
from app.widgets import MARK, ChoiceGroup, div, escape, on_input, put
from fuzzy import sets
from fuzzy.system import Input, Variable

_POINTS = 241
_HEIGHT = 170
_LEAST_SHOWN = 0.005
"""Least degree that is not 0 in two digits."""
_SYMMETRIC = "symmetric"
_DRAGGING = (*get_args(DragMode), _SYMMETRIC)
_AXIS = (60, 22, 42, 132)
"""Pixels from the panel's edges to the ends of the chart's axis, up from its bottom, and of the axis' height."""


class MembershipView:
    """Chart of one variable's terms, and what edits them.

    Attributes:
        views: This and those inside.
    """

    def __init__(self, gui: viser.GuiApi, store: Store) -> None:
        self._gui = gui
        self._store = store
        self._drawn: tuple[Any, ...] = ()
        self._lines: list[Line] = []
        self._chart_key: tuple[Any, ...] = ()
        self._variable = ChoiceGroup(gui, "variable", store.dispatch, lambda name: Selected({"variable": name}))
        self._legend = gui.add_html("")
        self._chart_place = gui.add_folder(None)
        self._chart: viser.GuiUplotHandle | None = None
        self._cursor = gui.add_html("")
        points = PointsView(gui, store)
        self._drag: Any = gui.add_button_group("drag", _DRAGGING, hint="partition: neighbours follow, the sum stays 1")
        on_input(self._drag, store.dispatch, self._choose_dragging)
        inside = (points, TermView(gui, store), GainView(gui, store), VariableView(gui, store))
        self.views: tuple[View, ...] = (self, *inside)

    def shows(self, state: AppState) -> Shown:
        """Return the parts that are shown."""
        return state.document, state.variable, state.term, state.drag, state.design

    def render(self, state: AppState) -> None:
        """Show the chosen variable and term."""
        variable = chosen(state)
        self._variable.show([v.name for v in (*state.document.inputs, *state.document.outputs)], variable.name)
        chosen_ways = {state.drag, _SYMMETRIC if state.design.is_symmetric else ""}
        options = tuple(f"{MARK}{way}" if way in chosen_ways else way for way in _DRAGGING)
        put(self._drag, options=options)
        drawn = (variable, state.term)
        if drawn != self._drawn:
            self._drawn = drawn
            self._draw(variable, state.term)
            self._show_value(variable, None)

    def show(self, frame: Frame) -> None:
        """Show the live value of an input and its memberships."""
        state = self._store.state
        variable = chosen(state)
        names = [v.name for v in state.document.inputs]
        value = None
        if (
            frame.strength is not None
            and isinstance(variable, Input)
            and names.index(variable.name) < len(frame.inputs)
        ):
            value = float(frame.inputs[names.index(variable.name)])
        self._show_value(variable, value)

    def _choose_dragging(self, value: object) -> Event:
        way = clean.choice(value.removeprefix(MARK) if isinstance(value, str) else value, _DRAGGING, "the way to drag")
        if way == _SYMMETRIC:
            return DesignChanged({"is_symmetric": not self._store.state.design.is_symmetric})
        return Selected({"drag": way})

    def _show_value(self, variable: Variable, value: float | None) -> None:
        self._legend.content = _legend_html(variable, self._store.state.term, value)
        self._cursor.content = _cursor_html(variable, value)

    def _draw(self, variable: Variable, term: str) -> None:
        low, high = extent(variable)
        points = {point for entry in variable.terms for point in sets.break_points(entry)}
        x = np.union1d(np.linspace(low, high, _POINTS), [point for point in points if low <= point <= high])
        lines = []
        for entry, color in zip(variable.terms, term_colors(variable), strict=True):
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


def _cursor_html(variable: Variable, value: float | None) -> str:
    """Return a line over the chart at the live value, at the end of the axis for one beyond it."""
    if value is None or not np.isfinite(value):
        return ""
    low, high = extent(variable)
    share = (min(max(value, low), high) - low) / (high - low)
    left, right, up, height = _AXIS
    place = f"left:calc({left}px + {share:.4f}*(100% - {left + right}px));bottom:{up}px;height:{height}px"
    line = f"position:absolute;{place};width:2px;margin-left:-1px;background:{TEXT};opacity:.8;pointer-events:none"
    return f'<div style="position:relative;height:0"><div id="now" style="{line}"></div></div>'


def _legend_html(variable: Variable, chosen_term: str, value: float | None) -> str:
    """Return the terms in their colours, with the degrees of the live value."""
    unit = f" {escape(variable.unit)}" if variable.unit else ""
    parts = []
    inside = None if value is None else min(max(value, variable.low), variable.high)
    for term, color in zip(variable.terms, term_colors(variable), strict=True):
        degree = 0.0 if inside is None else float(sets.degrees(term, inside))
        weight = "700" if term.name == chosen_term else "400"
        is_active = degree >= _LEAST_SHOWN
        text = f"{escape(term.name)} {degree:.2f}" if is_active else escape(term.name)
        opacity = 1.0 if is_active or inside is None else 0.75
        parts.append(f'<span style="color:{css(color)};font-weight:{weight};opacity:{opacity}">{text}</span>')
    now = (
        ""
        if value is None
        else f'<br><span style="color:{MUTED}">now {escape(variable.name)} = {round(value, 3) + 0.0:.3f}{unit}</span>'
    )
    return div(" · ".join(parts) + (now or f'<br><span style="color:{MUTED}">&nbsp;</span>'))
