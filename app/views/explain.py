"""Design › Inference, lower part: how the shown moment's output comes about, step by step."""

from __future__ import annotations

import time

import numpy as np
import viser

from app.charts import Line, add_chart
from app.palette import BAD, MUTED, RUN, css, term_color
from app.runner import Frame
from app.state import AppState
from app.widgets import coordinate_label, div, escape
from fuzzy.inference import Controller, Trace
from fuzzy.rules import format_expression

_PERIOD = 0.2
"""Least time between two pictures, s: faster than that nobody reads."""
_HEIGHT = 120
_RULES = 6
"""Rules that are listed, the strongest first."""
_LINES = (Line("output set", RUN, 1.8, fill="rgba(79,143,247,0.25)"), Line("crisp output", BAD, 2.0))


class ExplainView:
    """The inference of the chosen coordinate's fuzzy block, as the kernels that control computed it."""

    def __init__(self, gui: viser.GuiApi) -> None:
        self._steps = gui.add_html("")
        self._chart = add_chart(gui, _LINES, height=_HEIGHT, x_label="u", y_range=(0.0, 1.05), has_legend=False)
        self._chart.visible = False
        self._state: AppState | None = None
        self._shown_at = 0.0

    def render(self, state: AppState) -> None:
        """Remember which coordinate is chosen."""
        self._state = state

    def show(self, frame: Frame) -> None:
        """Explain the inference of this moment."""
        now = time.monotonic()
        if self._state is None or (now - self._shown_at < _PERIOD and self._state.playback.is_playing):
            return
        self._shown_at = now
        if frame.inference is None or not np.isfinite(frame.inputs).all():
            self._chart.visible = False
            self._steps.content = div("Nothing is inferred: this controller has no fuzzy block.", f"color:{MUTED}")
            return
        trace = frame.inference.explain(*frame.inputs)
        name = coordinate_label(frame.arm.coordinates[self._state.coordinate])
        self._steps.content = _steps_html(frame.inference, trace, name, frame.t)
        self._chart.visible = True
        self._chart.data = output_curve(trace)


def output_curve(trace: Trace) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return u, the aggregated set, and a line at the crisp output, of the first output.

    A sum of sets may exceed 1; it is scaled to a height of 1 for the picture.
    """
    output = next(iter(trace.outputs.values()))
    low, high = output.u[0], output.u[-1]
    width = 1e-3 * (high - low)
    value = min(max(output.value, low + width), high - width) if np.isfinite(output.value) else low
    u = np.union1d(output.u, [value - width, value, value + width])
    degree = np.interp(u, output.u, output.degree) / max(1.0, float(output.degree.max()))
    return u, degree, np.where(u == value, 1.0, 0.0) * np.isfinite(output.value)


def _steps_html(controller: Controller, trace: Trace, coordinate: str, t: float) -> str:
    system = controller.system
    lines = [f'<b>Step by step</b> <span style="color:{MUTED}">for {coordinate} at t = {t:.2f} s</span>']
    for variable in system.inputs:
        degrees = trace.memberships[variable.name]
        terms = ", ".join(
            f'<span style="color:{css(term_color(n, len(variable.terms)))}">{escape(term)}</span> {degree:.2f}'
            for n, (term, degree) in enumerate(degrees.items())
            if degree > 0.0
        )
        note = f' <span style="color:{BAD}">(outside its range)</span>' if variable.name in trace.clamped else ""
        lines.append(f"1 · {escape(variable.name)} = {trace.inputs[variable.name]:.3f}{note} is {terms or 'no term'}")
    lines.append(f"2 · {len(trace.rules)} of {len(trace.strength)} rules fire")
    for fired in trace.rules[:_RULES]:
        consequents = ", ".join(escape(f"{one.variable} is {one.term}") for one in fired.rule.consequents)
        bar = f"background:linear-gradient(90deg,rgba(79,143,247,.35) {100 * fired.strength:.0f}%,transparent 0)"
        text = f"{fired.strength:.2f} &nbsp;{escape(format_expression(fired.rule.antecedent))} → {consequents}"
        lines.append(f'<span style="display:block;padding:0 4px;border-radius:3px;{bar}">{text}</span>')
    if len(trace.rules) > _RULES:
        lines.append(f"and {len(trace.rules) - _RULES} weaker ones")
    for name, output in trace.outputs.items():
        heights = ", ".join(f"{escape(term)} {height:.2f}" for term, height in output.heights.items() if height > 0.0)
        lines.append(f"3 · sets of {escape(name)}: {heights or 'none'}")
        origin = "" if output.fired else " (no rule fires)"
        lines.append(f"4 · <b>{escape(name)} = {output.value:.3f}</b>{origin}")
    return div("".join(f'<div style="margin:2px 0">{line}</div>' for line in lines))
