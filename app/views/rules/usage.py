"""How many rules there are, and how many of them never fired in the last run."""

from __future__ import annotations

import numpy as np
import viser

from app.palette import MUTED
from app.state import AppState
from app.store import Shown
from app.widgets import div
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
    if activity is not None and len(activity) == count:
        never = int((activity <= 0.0).sum())
        lines.append(f"{never} never fired in this run" if never else "all fired in this run")
    return div(f'<span style="color:{MUTED}">{" · ".join(lines)}</span>')
