"""Design › Rules: the table of consequents, painted with a brush, glowing with what fires."""

from __future__ import annotations

from functools import partial

import numpy as np
import viser

from app import clean, grid
from app.palette import BAD, ERROR, MUTED
from app.runner import Frame
from app.state import AppState, Edit, Selected
from app.store import Dispatch
from app.widgets import div, escape, on_input
from fuzzy import edits, rules
from fuzzy.system import FuzzySystem, RuleTable, Variable

_FILLS = {
    "diagonal": edits.fill_diagonal,
    "piltan": edits.fill_piltan,
    "mirror": edits.mirror_antisymmetrically,
    "clear": edits.clear_table,
}
_FINDINGS = 6
"""Findings that are shown; the rest are counted."""


class RulesView:
    """The rule table of the document, its brushes and what the check finds."""

    def __init__(self, gui: viser.GuiApi, dispatch: Dispatch) -> None:
        self._gui = gui
        self._dispatch = dispatch
        self._state: AppState | None = None
        self._terms: tuple[tuple[str, ...], ...] = ()
        self._numbers = np.empty((0, 0), dtype=np.int64)
        self._brush_buttons: grid.HiddenButtons | None = None
        self._cell_buttons: grid.HiddenButtons | None = None
        self._style = gui.add_html("")
        self._brush = gui.add_html("")
        self._table = gui.add_html("")
        self._glow = gui.add_html("")
        fill = gui.add_button_group("Fill", tuple(_FILLS))
        on_input(fill, dispatch, _filled)
        self._findings = gui.add_html("")
        self._hidden = gui.add_folder(None)

    def render(self, state: AppState) -> None:
        """Show the document's table; rebuild the buttons only when it has other terms."""
        before, self._state = self._state, state
        table = state.document.rules.table
        if table is None:
            self._table.content = div("This system has no rule table; its rules are a list in the file.")
            self._brush.content = self._glow.content = ""
            self._findings.content = _findings_html(state)
            return
        rows, columns, output = _variables(state.document, table)
        self._ensure_buttons(rows, columns, output)
        assert self._brush_buttons is not None
        assert self._cell_buttons is not None
        names = [term.name for term in output.terms]
        chosen = names.index(state.brush) if state.brush is not None else len(names)
        self._brush.content = grid.brush_html(names, self._brush_buttons.ids, chosen)
        if before is not None and before.document is state.document and before.runs.current is state.runs.current:
            return
        self._numbers = np.array(rules.table_rule_indices(state.document))
        self._table.content = grid.table_html(
            (rows.name, [term.name for term in rows.terms]),
            (columns.name, [term.name for term in columns.terms]),
            table.cells,
            names,
            self._cell_buttons.ids,
        )
        self._findings.content = _findings_html(state)

    def show(self, frame: Frame) -> None:
        """Let the cells glow with the firing strengths of the chosen coordinate."""
        state = self._state
        if state is None or state.document.rules.table is None:
            return
        numbers = self._numbers
        activity = _activity(state)
        silent = np.zeros(numbers.shape, dtype=bool)
        if activity is not None and len(activity) > numbers.max(initial=-1):
            silent = (numbers >= 0) & (activity[numbers] <= 0.0)
        strengths = np.zeros(numbers.shape)
        if frame.strength is not None and frame.strength.size > max(numbers.max(initial=-1), 0):
            strengths = np.where(numbers >= 0, frame.strength[numbers], 0.0)
        self._glow.content = grid.glow_html(strengths.round(2).tolist(), silent.tolist())

    def _ensure_buttons(self, rows: Variable, columns: Variable, output: Variable) -> None:
        """Make a hidden button for every cell and brush, named after the terms."""
        terms = tuple(tuple(term.name for term in variable.terms) for variable in (rows, columns, output))
        if terms == self._terms:
            return
        self._terms = terms
        for buttons in (self._brush_buttons, self._cell_buttons):
            if buttons is not None:
                buttons.remove()
        with self._hidden:
            brushes = [f"brush {term.name}" for term in output.terms] + ["brush no rule"]
            self._brush_buttons = grid.HiddenButtons(self._gui, brushes, self._choose)
            cells = [f"{row.name}, {column.name}" for row in rows.terms for column in columns.terms]
            self._cell_buttons = grid.HiddenButtons(self._gui, cells, self._paint)
        self._style.content = grid.style_html(self._cell_buttons.ids, len(columns.terms))

    def _choose(self, number: int) -> None:
        names = self._output_terms()
        self._dispatch(Selected({"brush": names[number] if number < len(names) else None}))

    def _paint(self, number: int) -> None:
        assert self._state is not None
        table = self._state.document.rules.table
        if table is None:
            return
        rows, columns, _ = _variables(self._state.document, table)
        i, j = divmod(number, len(columns.terms))
        if i >= len(rows.terms):
            return  # pressed while the table was being replaced by a smaller one
        row, column, brush = rows.terms[i].name, columns.terms[j].name, self._state.brush
        label = f"({row}, {column}) → {brush or 'no rule'}"
        self._dispatch(Edit(label, partial(edits.set_cell, row=row, column=column, consequent=brush)))

    def _output_terms(self) -> list[str]:
        assert self._state is not None
        table = self._state.document.rules.table
        if table is None:
            return []
        return [term.name for term in _variables(self._state.document, table)[2].terms]


def _filled(value: object) -> Edit:
    name = clean.choice(value, _FILLS, "the pattern")
    return Edit(f"fill the table: {name}", _FILLS[name])


def _variables(system: FuzzySystem, table: RuleTable) -> tuple[Variable, Variable, Variable]:
    by_name: dict[str, Variable] = {variable.name: variable for variable in (*system.inputs, *system.outputs)}
    return by_name[table.rows], by_name[table.columns], by_name[table.output]


def _activity(state: AppState) -> np.ndarray | None:
    """Return the largest firing strength of every rule in the run, over all coordinates; None without rules."""
    result = state.runs.current
    return None if result is None or result.run.activity.size == 0 else result.run.activity.max(axis=0)


def _findings_html(state: AppState) -> str:
    system = state.document
    count = len(rules.all_rules(system))
    lines = [f"{count} rules"]
    listed = len(system.rules.list)
    if listed:
        lines.append(f"{listed} of them in a list")
    activity = _activity(state)
    if activity is not None and len(activity) == count:
        never = int((activity <= 0.0).sum())
        lines.append(f"{never} never fired in this run" if never else "all fired in this run")
    parts = [f'<span style="color:{MUTED}">{" · ".join(lines)}</span>']
    parts += [f"<code>{escape(rules.format_rule(rule))}</code>" for rule in system.rules.list[:_FINDINGS]]
    findings = state.findings
    colors = {"error": ERROR, "warning": BAD, "hint": MUTED}
    for finding in findings[:_FINDINGS]:
        parts.append(f'<span style="color:{colors[finding.level]}">▲ {escape(finding.message)}</span>')
    if len(findings) > _FINDINGS:
        parts.append(f'<span style="color:{MUTED}">and {len(findings) - _FINDINGS} more findings</span>')
    return div("<br>".join(parts))
