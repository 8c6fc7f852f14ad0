"""Response › Plots: a coordinate against its target, and the fuzzy output behind it, now, before and under PID."""

from __future__ import annotations

import numpy as np
import viser

from app.charts import Line, add_chart, resampled
from app.palette import BEFORE, PID, REFERENCE, RUN
from app.state import AppState, Selected
from app.store import Dispatch
from app.widgets import ChoiceGroup, coordinate_label, div

_POINTS = 600
"""Points of a curve: more than the panel has pixels."""

_DASH = (6, 4)
_RESPONSE = (
    Line("target", REFERENCE, 1.5, (2, 4)),
    Line("PID", PID, 1.5),
    Line("before", BEFORE, 1.5, _DASH),
    Line("now", RUN, 2.5),
)
_TORQUE = (Line("before", BEFORE, 1.5, _DASH), Line("now", RUN, 2.5))


class PlotsView:
    """Two charts of the chosen coordinate."""

    def __init__(self, gui: viser.GuiApi, dispatch: Dispatch) -> None:
        self._labels: tuple[str, ...] = ()
        self._shown: tuple[object, ...] = ()
        self._coordinate = ChoiceGroup(gui, "coordinate", dispatch, self._choose)
        self._coordinate.set_visible(False)
        self._response_title = gui.add_html("")
        self._response = add_chart(gui, _RESPONSE, height=160, has_legend=False)
        self._torque_title = gui.add_html("")
        self._torque = add_chart(gui, _TORQUE, height=105, has_legend=False)
        self._charts = (self._response, self._torque)
        for chart in self._charts:
            chart.visible = False

    def render(self, state: AppState) -> None:
        """Redraw when a run or the chosen coordinate has changed."""
        runs, i = state.runs, state.coordinate
        shown = (runs.current, runs.before, runs.pid, i)
        if runs.current is None or (self._shown and all(a is b for a, b in zip(shown, self._shown, strict=True))):
            return
        self._shown = shown
        for chart in self._charts:
            chart.visible = True
        current = runs.current.run
        arm = current.arm
        self._labels = labels = tuple(coordinate_label(name) for name in arm.coordinates)
        self._coordinate.show(labels, labels[i])
        self._coordinate.set_visible(True)
        is_length = i < arm.n_modules
        unit, factor = ("mm", 1e3) if is_length else ("°", float(np.rad2deg(1.0)))
        duration = current.scenario.duration
        t = np.linspace(0.0, duration, _POINTS)
        target = resampled(t, current.t, current.reference[:, i])
        # A curve that is not there yet lies under the present one.
        results = [runs.pid or runs.current, runs.before or runs.current, runs.current]
        curves = [resampled(t, result.run.t, result.run.q[:, i]) for result in results]
        self._response.data = (t, *(curve * factor for curve in (target, *curves)))
        self._response_title.content = _title_html(f"{labels[i]} in {unit}", _RESPONSE)
        self._torque.data = (t, *(resampled(t, result.run.t, result.run.output[:, i]) for result in results[1:]))
        self._torque_title.content = _title_html(f"fuzzy output T of {labels[i]}", _TORQUE)

    def _choose(self, label: str) -> Selected:
        return Selected({"coordinate": self._labels.index(label)})


def _title_html(title: str, lines: tuple[Line, ...]) -> str:
    """Return a chart's title with its legend: the chart's own takes two lines and shows values that nobody reads."""
    legend = " ".join(
        f'<span style="color:{line.color};white-space:nowrap">{"┄" if line.dash else "━"} {line.label}</span>'
        for line in reversed(lines)
    )
    return div(f"<b>{title}</b> over t in s &nbsp; {legend}", "margin:0")
