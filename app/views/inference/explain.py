"""Design › Inference, lower part: how an output comes about, step by step, now or for chosen inputs."""

from __future__ import annotations

import asyncio
import time
from typing import Any

import numpy as np
import viser
from numpy.typing import NDArray

from app import clean
from app.charts import Line, add_chart
from app.numbers import NumberRow
from app.palette import BAD, ERROR, MUTED, RUN, css, term_colors
from app.runner import Frame
from app.state import AppState, DesignChanged
from app.store import Shown, Store
from app.widgets import MARK, coordinate_label, div, escape, on_input, put
from fuzzy.errors import FuzzyError
from fuzzy.inference import Controller, Trace, compile_system
from fuzzy.language import format_expression
from fuzzy.operators import implied
from fuzzy.shapes import Linear
from fuzzy.system import FuzzySystem, Output

_PERIOD = 0.2
"""Least time between two pictures, s: faster than that nobody reads."""
_HEIGHT = 130
_RULES = 6
"""Rules that are listed, the strongest first."""
_LIVE, _CHOSEN = "the moment shown", "chosen inputs"
_ROWS = 6
"""Rows of three inputs: more than a system may have."""
_DECIMALS = 3

Array = NDArray[np.float64]
Probe = tuple[FuzzySystem, tuple[float, ...]]


class ExplainView:
    """The inference of the chosen coordinate's fuzzy block, or of the document for chosen inputs."""

    def __init__(self, gui: viser.GuiApi, store: Store) -> None:
        self._gui = gui
        self._which: Any = gui.add_button_group("explain", (_LIVE, _CHOSEN))
        on_input(self._which, store.dispatch, self._choose)
        self._numbers = [
            NumberRow(gui, store.dispatch, lambda values, row=row: self._set_inputs(row, values))
            for row in range(_ROWS)
        ]
        self._steps = gui.add_html("")
        self._place = gui.add_folder(None)
        self._chart: viser.GuiUplotHandle | None = None
        self._lines: tuple[Line, ...] = ()
        self._store = store
        self._shown_at = 0.0
        self._inputs: tuple[float, ...] = ()
        self._asked: Probe | None = None
        self._task: asyncio.Task[None] | None = None
        self._compiled: tuple[FuzzySystem, Controller] | None = None

    def shows(self, state: AppState) -> Shown:
        """Return the parts that are shown."""
        return state.document, state.design

    def render(self, state: AppState) -> None:
        """Show the chosen inputs, and explain them if the document or they are new."""
        probe = state.design.probe
        options = (_LIVE, f"{MARK}{_CHOSEN}") if probe is not None else (f"{MARK}{_LIVE}", _CHOSEN)
        put(self._which, options=options)
        names = [variable.name for variable in state.document.inputs]
        pairs = list(zip(names, probe or (), strict=False))
        for row, numbers in enumerate(self._numbers):
            numbers.show(pairs[3 * row : 3 * row + 3], _DECIMALS)
        asked = None if probe is None else (state.document, probe)
        if asked is not None and (self._asked is None or asked[0] is not self._asked[0] or asked[1] != self._asked[1]):
            self._task = asyncio.get_running_loop().create_task(self._explain(*asked))
        self._asked = asked

    def show(self, frame: Frame) -> None:
        """Explain the inference of this moment, unless inputs are chosen."""
        now = time.monotonic()
        if now - self._shown_at < _PERIOD and self._store.state.playback.is_playing:
            return
        self._shown_at = now
        self._inputs = tuple(float(value) for value in frame.inputs)
        if self._asked is not None:
            return
        if frame.inference is None or not np.isfinite(frame.inputs).all():
            self._fail("Nothing is inferred: this controller has no fuzzy block.", MUTED)
            return
        name = coordinate_label(frame.arm.coordinates[self._store.state.coordinate])
        trace = frame.inference.explain(*frame.inputs)
        self._show_trace(frame.inference, trace, f"for {name} at t = {frame.t:.2f} s")

    async def _explain(self, document: FuzzySystem, probe: tuple[float, ...]) -> None:
        """Compile and infer beside the event loop; the newest question is answered last."""
        try:
            if self._compiled is not None and self._compiled[0] is document:
                controller = self._compiled[1]
            else:
                controller = await asyncio.to_thread(compile_system, document)
            trace = await asyncio.to_thread(controller.explain, *probe)
        except FuzzyError as error:
            if self._is_asked(document, probe):
                self._fail(f"{error}", ERROR)
            return
        if self._is_asked(document, probe):
            self._compiled = (document, controller)
            self._show_trace(controller, trace, "for the chosen inputs")

    def _is_asked(self, document: FuzzySystem, probe: tuple[float, ...]) -> bool:
        return self._asked is not None and self._asked[0] is document and self._asked[1] == probe

    def _choose(self, value: object) -> DesignChanged:
        state = self._store.state
        which = clean.choice(value.removeprefix(MARK) if isinstance(value, str) else value, (_LIVE, _CHOSEN))
        if which == _LIVE:
            return DesignChanged({"probe": None})
        inputs = state.document.inputs
        now = self._inputs if len(self._inputs) == len(inputs) else (0.0,) * len(inputs)
        # Where a moving arm would be is rounded to what the fields show.
        probe = (
            round(min(max(one, variable.low), variable.high), _DECIMALS) if np.isfinite(one) else variable.low
            for one, variable in zip(now, inputs, strict=True)
        )
        return DesignChanged({"probe": tuple(probe)})

    def _set_inputs(self, row: int, values: tuple[float, ...]) -> DesignChanged | None:
        probe = self._store.state.design.probe
        if probe is None or len(probe[3 * row : 3 * row + 3]) != len(values):
            return None  # sent for another system
        return DesignChanged({"probe": (*probe[: 3 * row], *values, *probe[3 * row + 3 :])})

    def _show_trace(self, controller: Controller, trace: Trace, when: str) -> None:
        self._steps.content = _steps_html(controller, trace, when)
        output = _shown_output(controller.system, self._store.state)
        lines = output_lines(output)
        data = output_curves(controller.system, output, trace)
        if self._chart is None or lines != self._lines:
            if self._chart is not None:
                self._chart.remove()
            self._lines = lines
            with self._place:
                self._chart = add_chart(
                    self._gui, lines, height=_HEIGHT, x_label=output.name, y_range=(0.0, 1.05), has_legend=False,
                    data=data,
                )  # fmt: skip
            return
        self._chart.visible = True
        self._chart.data = data

    def _fail(self, text: str, color: str) -> None:
        self._steps.content = div(escape(text), f"color:{color}")
        if self._chart is not None:
            self._chart.visible = False


def _shown_output(system: FuzzySystem, state: AppState) -> Output:
    """Return the output that the rule table concludes, or the first."""
    wanted = state.design.grid.output if state.design.grid else ""
    return next((output for output in system.outputs if output.name == wanted), system.outputs[0])


def output_lines(output: Output) -> tuple[Line, ...]:
    """Return how the curves of an output look: a set for each term, the aggregated set, the crisp output."""
    terms = (
        Line(term.name, css(color, 0.9), 1.2, fill=css(color, 0.25))
        for term, color in zip(output.terms, term_colors(output), strict=True)
    )
    return (*terms, Line("output set", RUN, 2.0), Line("crisp output", BAD, 2.0))


def output_curves(system: FuzzySystem, output: Output, trace: Trace) -> tuple[Array, ...]:
    """Return u, the implied set of each term, the aggregated set, and a line at the crisp output.

    A sum of sets may exceed 1; all are scaled to a height of 1 for the picture. Functions of the inputs are no sets.
    """
    found = trace.outputs[output.name]
    low, high = found.u[0], found.u[-1]
    width = 1e-3 * (high - low)
    value = min(max(found.value, low + width), high - width) if np.isfinite(found.value) else low
    u = np.union1d(found.u, [value - width, value, value + width])
    scale = max(1.0, float(found.degree.max()))
    implication = system.inference.implication
    terms = (
        np.zeros(u.size)
        if isinstance(term.shape, Linear)
        else implied(term, implication, min(found.heights[term.name], 1.0), u) / scale
        for term in output.terms
    )
    degree = np.interp(u, found.u, found.degree) / scale
    return u, *terms, degree, np.where(u == value, 1.0, 0.0) * np.isfinite(found.value)


def _steps_html(controller: Controller, trace: Trace, when: str) -> str:
    system = controller.system
    lines = [f'<b>Step by step</b> <span style="color:{MUTED}">{when}</span>']
    for variable in system.inputs:
        degrees = trace.memberships[variable.name]
        terms = ", ".join(
            f'<span style="color:{css(color)}">{escape(term)}</span> {degree:.2f}'
            for (term, degree), color in zip(degrees.items(), term_colors(variable), strict=True)
            if degree > 0.0
        )
        note = f' <span style="color:{BAD}">(outside its range)</span>' if variable.name in trace.clamped else ""
        lines.append(
            f"1 · {escape(variable.name)} = {_decimal(trace.inputs[variable.name])}{note} is {terms or 'no term'}"
        )
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
        lines.append(f"4 · <b>{escape(name)} = {_decimal(output.value)}</b>{origin}")
    return div("".join(f'<div style="margin:2px 0">{line}</div>' for line in lines))


def _decimal(value: float) -> str:
    """Return a number in three decimals; what rounds to 0 has no sign."""
    return f"{round(value, _DECIMALS) + 0.0:.3f}"
