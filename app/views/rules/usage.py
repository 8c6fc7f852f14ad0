"""How many rules there are, how many never fired in the last run, and how often none of them did."""

from __future__ import annotations

import numpy as np
import viser

from app.palette import MUTED
from app.state import AppState
from app.store import Shown
from app.widgets import coordinate_label, div, number
from fuzzy import rules


class UsageView:
    """One line below the table."""

    def __init__(self, gui: viser.GuiApi) -> None:
        self._line = gui.add_html("")

    def shows(self, state: AppState) -> Shown:
        """Return the parts that are shown."""
        return state.document.rules, state.runs.current

    def render(self, state: AppState) -> None:
        """Count."""
        self._line.content = _count_html(state)


def activity_of(state: AppState) -> np.ndarray | None:
    """Return the largest firing strength of every rule in the run, over all coordinates; None without rules."""
    result = state.runs.current
    return None if result is None or result.run.activity.size == 0 else result.run.activity.max(axis=0)


def _count_html(state: AppState) -> str:
    system = state.document
    count = len(rules.all_rules(system))
    lines = [f"{count} rule{'s' if count != 1 else ''}"]
    listed = len(system.rules.list)
    if listed and listed < count:
        lines.append(f"{listed} of them in the list")
    activity = activity_of(state)
    result = state.runs.current
    if result is not None and activity is not None and len(activity) == count:
        never = int((activity <= 0.0).sum())
        lines.append(f"{never} never fired in this run" if never else "all fired in this run")
        run = result.run
        for steps, what in ((run.undefined, "none fired"), (run.clamped, "inputs beyond their ranges")):
            if steps.any():
                most = int(steps.argmax())
                share = 100 * steps[most] / max(len(run.t), 1)
                name = coordinate_label(run.arm.coordinates[most])
                lines.append(f"{what}: {name} {number(share, 2)} % of the time")
    return div(f'<span style="color:{MUTED}">{" · ".join(lines)}</span>')
