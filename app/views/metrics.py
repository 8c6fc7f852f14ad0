"""Response › Metrics: the numbers of the run beside those before the edit, of kept runs and of plain PID control."""

from __future__ import annotations

import math
from typing import NamedTuple

import viser

from app.palette import BAD, GOOD, KEPT, MUTED, css
from app.state import AppState, Result
from app.store import Shown
from app.widgets import TINY, div, escape, figure

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
    "saturation": ("force at its limit", "%"),
}
"""For each metric its name for the reader and its unit; A is the coordinate's step."""

_SHORT = {
    "rise_time": "rise time",
    "settling_time": "settling",
    "steady_state_error": "steady state",
    "iae": "IAE",
    "ise": "ISE",
    "itae": "ITAE",
    "effort": "effort",
    "saturation": "at its limit",
}
"""Names that fit beside the columns of baselines."""

_DIFFERENCE = 0.01
"""Relative difference from which on a number counts as better or worse."""


_FEW = 3
"""Columns beside which the long names have room."""


class _Column(NamedTuple):
    """A run in the table: its id, its heading as HTML, and the run with which its numbers are compared."""

    key: str
    heading: str
    result: Result | None
    rival: Result | None


class MetricsView:
    """A table of all metrics; for every one of them less is better."""

    def __init__(self, gui: viser.GuiApi) -> None:
        self._table = gui.add_html("")

    def shows(self, state: AppState) -> Shown:
        """Return the parts that are shown."""
        runs = state.runs
        return runs.current, runs.before, runs.pid, runs.kept

    def render(self, state: AppState) -> None:
        """Show the metrics of the runs that there are."""
        runs = state.runs
        if runs.current is None:
            self._table.content = div("The first run is being simulated.", f"color:{MUTED}")
            return
        kept = [
            _Column(f"kept{one.slot + 1}", _kept_heading(one.slot, one.name), one.result, runs.current)
            for one in runs.kept
        ]
        columns = [
            _Column("now", "now", runs.current, runs.before),
            _Column("before", "before", runs.before, None),
            *kept,
            _Column("PID", "PID", runs.pid, runs.current),
        ]
        head = "".join(f'<th style="text-align:right">{column.heading}</th>' for column in columns)
        title = '<th style="text-align:left">worst coordinate</th>'
        lines = [f'<tr style="color:{MUTED}">{title}{head}</tr>']
        has_limits = runs.current.run.scenario.force_limits is not None
        lines += [_line(metric, columns) for metric in _ROWS if metric != "saturation" or has_limits]
        size = "12px" if kept else "13px"
        style = f"width:100%;border-spacing:3px;font-variant-numeric:tabular-nums;font-size:{size};line-height:1.3"
        stopped = runs.current.run.stopped
        warning = "" if stopped is None else f'<div style="color:{BAD}">{escape(str(stopped))}</div>'
        text = "less is better; green is better, orange worse: now than before, the others than now"
        legend = f'<div style="color:{MUTED}">{text}</div>'
        names = "".join(f"<div>{_kept_heading(one.slot, one.name)} {escape(one.name)}</div>" for one in runs.kept)
        table = f'<div style="overflow-x:auto"><table style="{style}">{"".join(lines)}</table></div>'
        self._table.content = div(f"{warning}{table}{legend}{names}")


def _kept_heading(slot: int, name: str) -> str:
    return f'<span style="color:{css(KEPT[slot])}" title="{escape(name)}">━ {slot + 1}</span>'


def _line(metric: str, columns: list[_Column]) -> str:
    label, unit = _ROWS[metric]
    if len(columns) > _FEW:
        label = _SHORT.get(metric, label)
    cells = []
    for column in columns:
        value, rival = (
            math.nan if result is None else getattr(result.metrics, metric)["worst"]
            for result in (column.result, column.rival)
        )
        color = _color(value, rival)
        cells.append(
            f'<td id="{metric}-{column.key}" style="text-align:right;white-space:nowrap;color:{color}">'
            f"{figure(value)}</td>"
        )
    return f'<tr><td>{label} <span style="color:{MUTED}">{unit}</span></td>{"".join(cells)}</tr>'


def _color(value: float, rival: float) -> str:
    if math.isnan(value) or math.isnan(rival) or figure(value) == figure(rival):
        return "inherit"
    if max(abs(value), abs(rival)) < TINY:  # both read as nothing
        return "inherit"
    both = math.isfinite(value) and math.isfinite(rival)
    if both and abs(value - rival) <= _DIFFERENCE * max(abs(value), abs(rival)):
        return "inherit"
    return GOOD if value < rival else BAD
