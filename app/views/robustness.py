"""Response › Metrics › Robustness: this controller and PID on many random arms, ordered and cancelled here."""

from __future__ import annotations

import numpy as np
import viser

from app.palette import BAD, MUTED, PID, RUN
from app.state import AppState
from app.state.study import PLANTS, Outcome, StudyCancelled, StudyChosen, StudyOrdered
from app.store import Shown, Store
from app.widgets import ChoiceGroup, div, escape, figure, number, on_input, progress_bar
from robot.robustness import SPREAD, Spread, histogram, percentile

_FIGURES = {
    "overshoot": ("overshoot", "%"),
    "settling_time": ("settling time", "s"),
    "steady_state_error": ("steady-state error", "%"),
    "rms_error": ("RMS error", "%"),
}
_WIDTH, _HEIGHT = 330, 70
"""Of the histogram, in pixels."""


class RobustnessView:
    """Chooses the number of arms, starts and cancels, and shows progress and what was found."""

    def __init__(self, gui: viser.GuiApi, store: Store) -> None:
        text = (
            f"How this controller and PID do the present scenario on random arms: every mass, inertia, spring and "
            f"damper is off by up to ± {100 * SPREAD:.0f} %, and the controller does not know."
        )
        gui.add_html(div(text, f"color:{MUTED}"))
        self._plants = ChoiceGroup(gui, "arms", store.dispatch, lambda name: StudyChosen(int(name)))
        self._start = gui.add_button("Study robustness")
        self._cancel = gui.add_button("Cancel the study", visible=False, color="orange")
        self._bar = gui.add_html("")
        self._found = gui.add_html("")
        on_input(self._start, store.dispatch, lambda _: StudyOrdered())
        on_input(self._cancel, store.dispatch, lambda _: StudyCancelled())
        self._shown: tuple[Outcome, bool] | None = None

    def shows(self, state: AppState) -> Shown:
        """Return the parts that are shown."""
        return state.study, state.document, state.setup

    def render(self, state: AppState) -> None:
        """Show how far a study is, and what the last one found."""
        study = state.study
        is_running = study.order is not None and study.order.method is None
        self._plants.show([str(count) for count in PLANTS], str(study.plants))
        self._start.visible = not is_running
        self._cancel.visible = is_running
        self._bar.content = progress_bar(study.done, "done, this controller first, then PID") if is_running else ""
        outcome = study.outcome
        if outcome is None:
            return
        shown = (outcome, outcome.order.document == state.document and outcome.order.setup == state.setup)
        if self._shown is None or self._shown[0] is not outcome or self._shown[1] != shown[1]:
            self._shown = shown
            self._found.content = _outcome_html(*shown)


def _outcome_html(outcome: Outcome, is_present: bool) -> str:
    order = outcome.order
    what = f"{order.plants} arms, {escape(order.document.name)}, {escape(order.setup.controller)}"
    stale = f'<div style="color:{BAD}">▲ found before the last change of rules or experiment: study again</div>'
    both = "".join(f'<td colspan="2" style="text-align:right">{name}</td>' for name in ("this controller", "PID"))
    head = f'<tr style="color:{MUTED}"><td></td>{both}</tr>'
    half = '<td style="text-align:right">median</td><td style="text-align:right">95 %</td>'
    lines = [head, f'<tr style="color:{MUTED}"><td>worst coordinate</td>{half}{half}</tr>']
    for name, (label, unit) in _FIGURES.items():
        cells = "".join(
            f'<td id="robust-{name}-{who}-{percent}" style="text-align:right">{_text(found, name, percent)}</td>'
            for who, found in (("law", outcome.law), ("pid", outcome.pid))
            for percent in (50, 95)
        )
        lines.append(f'<tr><td>{label} <span style="color:{MUTED}">{unit}</span></td>{cells}</tr>')
    away = "".join(
        f'<td colspan="2" style="text-align:right">{_share(found)}</td>' for found in (outcome.law, outcome.pid)
    )
    lines.append(f'<tr><td>ran away <span style="color:{MUTED}">%</span></td>{away}</tr>')
    style = "width:100%;border-spacing:3px;font-variant-numeric:tabular-nums;font-size:12px;line-height:1.3"
    table = f'<table style="{style}">{"".join(lines)}</table>'
    faded = "" if is_present else "opacity:.6"
    return div(
        f'{"" if is_present else stale}<div style="{faded}"><div>{what}</div>{table}{_histogram_svg(outcome)}</div>'
    )


def _text(found: Spread, name: str, percent: float) -> str:
    return figure(percentile(getattr(found, name), percent))


def _share(found: Spread) -> str:
    return f"{100.0 * np.mean(found.stopped):.3g}"


def _histogram_svg(outcome: Outcome) -> str:
    """Return how often each overshoot came up, or each RMS error where the scenario has no step."""
    name = "rms_error" if np.isnan(outcome.law.overshoot).all() else "overshoot"
    edges, counts = histogram([getattr(outcome.law, name), getattr(outcome.pid, name)])
    most = max(1, *(int(count.max()) for count in counts))
    wide = _WIDTH / len(counts[0])
    bars = [
        f'<rect x="{wide * i:.1f}" y="{_HEIGHT * (1 - n / most):.1f}" width="{wide - 1:.1f}" '
        f'height="{_HEIGHT * n / most:.1f}" fill="{color}" fill-opacity="0.65"/>'
        for count, color in zip(counts, (RUN, PID), strict=True)
        for i, n in enumerate(count)
        if n
    ]
    label, unit = _FIGURES[name]
    ends = f"<span>0</span><span>{number(float(edges[-1]))} {unit}</span>"
    caption = (
        f'<div style="color:{MUTED};display:flex;justify-content:space-between">{ends}</div>'
        f'<div style="color:{MUTED}">how many arms, by {label}: <b style="color:{RUN}">this controller</b>, '
        f'<b style="color:{PID}">PID</b></div>'
    )
    return (
        f'<svg viewBox="0 0 {_WIDTH} {_HEIGHT}" width="100%" style="display:block;margin-top:6px;'
        f'border-bottom:1px solid {MUTED}">{"".join(bars)}</svg>{caption}'
    )
