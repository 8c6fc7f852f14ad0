"""Response › Metrics: the numbers of the run beside those before the edit and those of plain PID control."""

from __future__ import annotations

import math

import viser

from app.palette import BAD, GOOD, MUTED
from app.state import AppState, Result
from app.widgets import div, escape, number

_ROWS = {
    "overshoot": ("overshoot", "%"),
    "rise_time": ("rise time, 10 to 90 %", "s"),
    "settling_time": ("settling time, 2 %", "s"),
    "steady_state_error": ("steady-state error", "%"),
    "iae": ("IAE, ∫|e/A| dt", "s"),
    "ise": ("ISE, ∫(e/A)² dt", "s"),
    "itae": ("ITAE, ∫t |e/A| dt", "s²"),
    "rms_error": ("RMS error", "%"),
    "effort": ("effort, ∫F² dt", "N² s"),
    "peak_force": ("peak force", "N"),
}
"""For each metric its name for the reader and its unit; A is the coordinate's step."""

_COLUMNS = ("now", "before", "PID")

_DIFFERENCE = 0.01
"""Relative difference from which on a number counts as better or worse."""


class MetricsView:
    """A table of all metrics; for every one of them less is better."""

    def __init__(self, gui: viser.GuiApi) -> None:
        self._table = gui.add_html("")

    def render(self, state: AppState) -> None:
        """Show the metrics of the runs that there are."""
        runs = state.runs
        if runs.current is None:
            self._table.content = div("The first run is being simulated.", f"color:{MUTED}")
            return
        results = (runs.current, runs.before, runs.pid)
        head = "".join(f'<th style="text-align:right">{name}</th>' for name in _COLUMNS)
        title = '<th style="text-align:left">worst coordinate</th>'
        lines = [f'<tr style="color:{MUTED}">{title}{head}</tr>']
        lines += [_line(metric, results) for metric in _ROWS]
        style = "width:100%;border-spacing:0 3px;font-variant-numeric:tabular-nums"
        stopped = runs.current.run.stopped
        warning = "" if stopped is None else f'<div style="color:{BAD}">{escape(str(stopped))}</div>'
        legend = f'<div style="color:{MUTED}">less is better; green or orange where it differs from before</div>'
        self._table.content = div(f'{warning}<table style="{style}">{"".join(lines)}</table>{legend}')


def _line(metric: str, results: tuple[Result | None, ...]) -> str:
    label, unit = _ROWS[metric]
    values = [math.nan if result is None else getattr(result.metrics, metric)["worst"] for result in results]
    colors = (_color(values[0], values[1]), "inherit", "inherit")
    cells = [
        f'<td id="{metric}-{column}" style="text-align:right;color:{color}">{_text(value)}</td>'
        for column, value, color in zip(_COLUMNS, values, colors, strict=True)
    ]
    return f'<tr><td>{label} <span style="color:{MUTED}">{unit}</span></td>{"".join(cells)}</tr>'


def _color(now: float, before: float) -> str:
    if math.isnan(now) or math.isnan(before) or _text(now) == _text(before):
        return "inherit"
    if math.isfinite(now) and math.isfinite(before) and abs(now - before) <= _DIFFERENCE * max(abs(now), abs(before)):
        return "inherit"
    return GOOD if now < before else BAD


def _text(value: float) -> str:
    if math.isnan(value):
        return "–"
    return "never" if math.isinf(value) else number(value)
