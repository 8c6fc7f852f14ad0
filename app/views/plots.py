"""Response › Plots: coordinates against their targets, and the signals behind them, beside other runs."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
import viser
from numpy.typing import NDArray

from app import clean
from app.charts import Line, add_chart, resampled, series
from app.palette import BEFORE, COORDINATES, KEPT, PID, REFERENCE, RUN, css
from app.runner import Frame
from app.state import CHARTS, MAX_KEPT, AppState, Chart, Result, Selected
from app.store import Shown, Store, is_same
from app.widgets import MARK, ChoiceGroup, coordinate_label, div, escape, on_input, put
from robot.arm import PRESETS, Arm

_POINTS = 500
"""Points of a curve: more than the panel has pixels."""
_DASH = (6, 4)
_DEGREES = math.degrees(1.0)
_NAMES: dict[Chart, str] = {"error": "error", "output": "T", "forces": "forces", "lyapunov": "V"}
_HEIGHTS: dict[Chart, int] = {"error": 105, "output": 105, "forces": 130, "lyapunov": 105}
_RESPONSE_HEIGHT = 150
_COORDINATES = max(2 * Arm.preset(name).n_modules for name in PRESETS)
_MARKER = "fw-time-charts"
_CURSOR_STEP = 1e-3
"""Share of the width by which the cursor must move to be sent again."""

Array = NDArray[np.float64]
Curve = Callable[[Result], Array]


class _Drawn(NamedTuple):
    """A chart and its title."""

    title: Any
    chart: Any


class PlotsView:
    """A chart for each chosen coordinate, then charts of the chosen coordinate's other signals."""

    def __init__(self, gui: viser.GuiApi, store: Store) -> None:
        self._labels: tuple[str, ...] = ()
        self._store = store
        self._drawn: Shown = ()
        self._at = -1.0
        self._coordinate = ChoiceGroup(gui, "coordinate", store.dispatch, self._choose)
        self._others: Any = gui.add_button_group("also", ("–",), visible=False)
        on_input(self._others, store.dispatch, self._toggle_other)
        self._signals: Any = gui.add_button_group("below", tuple(_NAMES.values()), visible=False)
        on_input(self._signals, store.dispatch, self._toggle_chart)
        self._coordinate.set_visible(False)
        # The cursor is a style sheet: a curve would have to be sent whole to move.
        self._cursor = gui.add_html(f'<i id="{_MARKER}"></i>')
        lines = (Line("target", REFERENCE), *_lines(()))
        self._responses = [_add(gui, lines, _RESPONSE_HEIGHT) for _ in range(_COORDINATES)]
        self._charts: dict[Chart, _Drawn] = {}
        for name in CHARTS:
            own = _force_lines(_COORDINATES, ()) if name == "forces" else _lines(())
            self._charts[name] = _add(gui, own, _HEIGHTS[name])

    def shows(self, state: AppState) -> Shown:
        """Return the parts that are shown."""
        runs = state.runs
        return runs.current, runs.before, runs.pid, runs.kept, state.coordinate, state.others, state.charts

    def render(self, state: AppState) -> None:
        """Redraw when a run or a choice has changed."""
        runs = state.runs
        before, self._drawn = self._drawn, self.shows(state)
        if runs.current is None or is_same(before, self._drawn):
            return
        self._render_choices(state, runs.current)
        t = np.linspace(0.0, runs.current.run.scenario.duration, _POINTS)
        for i, drawn in enumerate(self._responses):
            self._show(drawn, i in state.coordinates)
            if i in state.coordinates:
                self._draw_response(drawn, state, t, i)
        for name, drawn in self._charts.items():
            is_possible = name != "lyapunov" or runs.current.lyapunov is not None
            self._show(drawn, name in state.charts and is_possible)
            if name in state.charts and is_possible:
                self._draw_signal(name, drawn, state, t)

    def show(self, frame: Frame) -> None:
        """Put the time cursor where the arm is."""
        current = self._store.state.runs.current
        if current is None:
            return
        at = min(frame.t / current.run.scenario.duration, 1.0)
        if abs(at - self._at) < _CURSOR_STEP:
            return
        self._at = at
        self._cursor.content = _cursor_html(at)

    def _render_choices(self, state: AppState, current: Result) -> None:
        names = tuple(coordinate_label(name) for name in current.run.arm.coordinates)
        self._labels = names
        self._coordinate.show(names, names[state.coordinate])
        self._coordinate.set_visible(True)
        marked = tuple(f"{MARK}{name}" if i in state.others else name for i, name in enumerate(names))
        signals = tuple(f"{MARK}{_NAMES[name]}" if name in state.charts else _NAMES[name] for name in CHARTS)
        for handle, options in ((self._others, marked), (self._signals, signals)):
            put(handle, visible=True, options=options)

    def _show(self, drawn: _Drawn, is_visible: bool) -> None:
        put(drawn.title, visible=is_visible)
        put(drawn.chart, visible=is_visible)

    def _draw_response(self, drawn: _Drawn, state: AppState, t: Array, i: int) -> None:
        runs = state.runs
        assert runs.current is not None
        arm = runs.current.run.arm
        unit, factor = ("mm", 1e3) if i < arm.n_modules else ("°", _DEGREES)
        target = resampled(t, runs.current.drawn.t, runs.current.drawn.reference[:, i]) * factor
        curves = _curves(state, t, lambda result: result.drawn.q[:, i] * factor)
        lines = (Line("target", REFERENCE, 1.5, (2, 4)), *_lines(_results(state)))
        self._fill(drawn, (t, target, *curves), lines, f"{self._labels[i]} in {unit}")

    def _draw_signal(self, name: Chart, drawn: _Drawn, state: AppState, t: Array) -> None:
        current = state.runs.current
        assert current is not None
        i, lines = state.coordinate, _lines(_results(state))
        label = self._labels[i]
        match name:
            case "error":
                unit, factor = ("mm", 1e3) if i < current.run.arm.n_modules else ("°", _DEGREES)
                curves = _curves(state, t, lambda r: (r.drawn.reference[:, i] - r.drawn.q[:, i]) * factor)
                title = f"error of {label} in {unit}"
            case "output":
                curves = _curves(state, t, lambda r: r.drawn.output[:, i])
                title = f"fuzzy output T of {label}"
            case "lyapunov":
                alike = [
                    (line, result if result is not None and _is_alike(result, current) else None)
                    for line, result in _results(state)
                ]
                lines = _lines(alike)
                curves = [_lyapunov(t, result or current) for _, result in alike]
                title = "Lyapunov function V of the law"
            case "forces":
                names = current.run.arm.actuators
                curves = [resampled(t, current.drawn.t, current.drawn.forces[:, k]) for k in range(len(names))]
                curves += [curves[0]] * (_COORDINATES - len(curves))
                lines = _force_lines(len(curves), names)
                title = "actuator forces in N"
        self._fill(drawn, (t, *curves), lines, title)

    def _fill(self, drawn: _Drawn, data: tuple[Array, ...], lines: Sequence[Line], title: str) -> None:
        described = series(lines)
        put(drawn.chart, series=described)
        drawn.chart.data = data
        drawn.title.content = _title_html(title, lines)

    def _choose(self, label: str) -> Selected:
        return Selected({"coordinate": self._labels.index(label)})

    def _toggle_other(self, value: object) -> Selected:
        chosen = self._labels.index(clean.choice(_unmarked(value), self._labels, "the coordinate"))
        others = set(self._store.state.others) ^ {chosen}
        return Selected({"others": tuple(sorted(others))})

    def _toggle_chart(self, value: object) -> Selected:
        texts = {text: name for name, text in _NAMES.items()}
        chosen = texts[clean.choice(_unmarked(value), texts, "the chart")]
        return Selected({"charts": self._store.state.charts ^ {chosen}})


def _unmarked(value: object) -> object:
    return value.removeprefix(MARK) if isinstance(value, str) else value


def _add(gui: viser.GuiApi, lines: Sequence[Line], height: int) -> _Drawn:
    title = gui.add_html("", visible=False)
    chart = add_chart(gui, lines, height=height, has_legend=False)
    chart.visible = False
    return _Drawn(title, chart)


def _results(state: AppState) -> tuple[tuple[Line, Result | None], ...]:
    """Return all runs that a chart compares, the present one last, each with the look of its curve.

    There are always as many, so that a chart keeps its number of curves; those that are not there are not seen.
    """
    runs = state.runs
    kept = {one.slot: one for one in runs.kept}
    compared = [(Line("PID", PID, 1.5), runs.pid), (Line("before", BEFORE, 1.5, _DASH), runs.before)]
    for slot in range(MAX_KEPT):
        one = kept.get(slot)
        line = Line(one.name if one else "", css(KEPT[slot]), 1.5, _DASH)
        compared.append((line, one.result if one else None))
    return (*compared, (Line("now", RUN, 2.5), runs.current))


def _lines(compared: Sequence[tuple[Line, Result | None]]) -> tuple[Line, ...]:
    if not compared:
        return tuple(Line("", RUN) for _ in range(MAX_KEPT + 3))
    return tuple(line._replace(is_shown=result is not None) for line, result in compared)


def _curves(state: AppState, t: Array, of: Curve) -> list[Array]:
    """Return one curve for each run that is compared, at the times t; one that is not there is the present one's."""
    current = state.runs.current
    assert current is not None
    curves = []
    for _, result in _results(state):
        one = result or current
        curves.append(resampled(t, one.drawn.t, of(one)))
    return curves


def _is_alike(result: Result, current: Result) -> bool:
    """Return whether two runs have Lyapunov functions of one kind, and so of one unit."""
    return result.lyapunov is not None and type(result.run.controller) is type(current.run.controller)


def _lyapunov(t: Array, result: Result) -> Array:
    values = np.zeros(len(result.drawn.t)) if result.lyapunov is None else result.lyapunov
    return resampled(t, result.drawn.t, values)


def _force_lines(count: int, names: Sequence[str]) -> tuple[Line, ...]:
    colors = [css(COORDINATES[k % len(COORDINATES)]) for k in range(count)]
    return tuple(
        Line(names[k] if k < len(names) else "", color, 1.5, is_shown=k < len(names)) for k, color in enumerate(colors)
    )


def _title_html(title: str, lines: Sequence[Line]) -> str:
    """Return a chart's title with its legend: the chart's own takes two lines and shows values that nobody reads."""
    legend = " ".join(
        f'<span style="color:{line.color};white-space:nowrap">{"┄" if line.dash else "━"} {escape(line.label)}</span>'
        for line in reversed(lines)
        if line.is_shown
    )
    return div(f"<b>{title}</b> over t in s &nbsp; {legend}", "margin:0")


def _cursor_html(at: float) -> str:
    """Return the style sheet that draws the time cursor over every chart of this panel, at a share of its width."""
    line = f'content:"";position:absolute;top:0;bottom:0;left:{100 * at:.2f}%;width:1px;background:rgba(255,255,255,.6)'
    return (
        f'<i id="{_MARKER}"></i><style>div:has(> div > #{_MARKER}) .u-over::after{{{line};pointer-events:none}}</style>'
    )
