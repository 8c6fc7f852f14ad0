"""Design › Rules: the table of consequents, painted with a brush, glowing with what fires; findings; the list."""

from __future__ import annotations

from functools import partial

import numpy as np
import viser

from app import clean, grid
from app.painting import grid_variables, painted, shown_grid
from app.palette import MUTED, term_colors
from app.runner import Frame
from app.state import AppState, DesignChanged, Edit, Selected
from app.store import Shown, Store, View
from app.views.rules.axes import AxesView
from app.views.rules.findings import FindingsView
from app.views.rules.listing import RuleListView
from app.views.rules.usage import UsageView, activity_of
from app.widgets import div, on_input, put
from fuzzy import edits
from fuzzy.system import Variable

_FILLS = {
    "diagonal": edits.fill_diagonal,
    "piltan": edits.fill_piltan,
    "mirror": edits.mirror_antisymmetrically,
    "clear": edits.clear_table,
}
_FROM_GAINS = "PD"
_GAINS = "Kp · Kd"
_MOST_GAIN = 1e9
_GAIN_STEP = 0.001


class RulesView:
    """The rules of the document as a table, its brushes, what the check finds, and the rules of the list.

    Attributes:
        views: This and those inside.
    """

    def __init__(self, gui: viser.GuiApi, store: Store) -> None:
        self._store = store
        self._terms: tuple[tuple[str, ...], ...] = ()
        self._numbers = np.empty((0, 0), dtype=np.int64)
        self._has_all = False
        gui.add_html(grid.BASE_STYLE)
        axes = AxesView(gui, store)
        self._style = gui.add_html("")
        self._brush = gui.add_html("")
        self._chosen_brush = gui.add_html("")
        self._table = gui.add_html("")
        self._glow = gui.add_html("")
        self._fill = gui.add_button_group("pattern", (*_FILLS, _FROM_GAINS))
        on_input(self._fill, store.dispatch, self._filled)
        self._gains = gui.add_vector2(
            _GAINS,
            (0.0, 0.0),
            step=_GAIN_STEP,
            hint="The PD law from which the table can be filled: output per unit of the rows' and the columns' input",
        )
        on_input(self._gains, store.dispatch, _gained)
        usage = UsageView(gui)
        findings = FindingsView(gui, store)
        self._list = RuleListView(gui, store)
        self._brush_buttons = grid.HiddenButtons(gui, (), self._choose)
        self._cell_buttons = grid.HiddenButtons(gui, (), self._paint)
        self.views: tuple[View, ...] = (self, axes, usage, findings, self._list)

    def shows(self, state: AppState) -> Shown:
        """Return the parts that are shown."""
        return state.document, state.design, state.brush

    def render(self, state: AppState) -> bool:
        """Show the document's rules, as soon as there are as many buttons as it takes."""
        shown = shown_grid(state)
        for part in (self._fill, self._gains):
            put(part, visible=shown is not None)
        if shown is None:
            text = "one input: the rules are a list" if state.design.grid is None else "too many terms for a table here"
            self._table.content = div(f'<span style="color:{MUTED}">{text}</span>')
            self._brush.content = self._glow.content = ""
            self._numbers = np.empty((0, 0), dtype=np.int64)
            return False
        rows, columns, output = grid_variables(state.document, shown)
        self._has_all = self._ensure_buttons(rows, columns, output)
        if not self._has_all:
            return True
        names = [term.name for term in output.terms]
        chosen = names.index(state.brush) if state.brush is not None else len(names)
        self._brush.content = grid.brush_html(output, self._brush_buttons.ids)
        self._chosen_brush.content = grid.chosen_brush_html(chosen)
        self._gains.value = state.design.gains or edits.full_gains(state.document, shown)
        self._numbers = np.array(edits.grid_rule_numbers(state.document, shown))
        self._table.content = grid.table_html(
            (rows.name, [term.name for term in rows.terms]),
            (columns.name, [term.name for term in columns.terms]),
            edits.grid_cells(state.document, shown),
            dict(zip(names, term_colors(output), strict=True)),
            self._cell_buttons.ids,
        )
        return False

    def show(self, frame: Frame) -> None:
        """Let cells and rules glow with the firing strengths of the chosen coordinate."""
        state = self._store.state
        self._list.show(frame)
        if not self._numbers.size:
            return
        numbers = self._numbers
        activity = activity_of(state)
        silent = np.zeros(numbers.shape, dtype=bool)
        if activity is not None and len(activity) > numbers.max(initial=-1):
            silent = (numbers >= 0) & (activity[numbers] <= 0.0)
        strengths = np.zeros(numbers.shape)
        if frame.strength is not None and frame.strength.size > max(numbers.max(initial=-1), 0):
            strengths = np.where(numbers >= 0, frame.strength[numbers], 0.0)
        marked = [(i, j) for i, j in state.design.marked if i < len(numbers) and j < len(numbers[0])]
        self._glow.content = grid.glow_html(strengths.round(2).tolist(), silent.tolist(), marked)

    def _ensure_buttons(self, rows: Variable, columns: Variable, output: Variable) -> bool:
        """Have a hidden button for every cell and brush, named after the terms; return whether all are there."""
        terms = tuple(tuple(term.name for term in variable.terms) for variable in (rows, columns, output))
        if terms == self._terms:
            return True
        self._terms = ()  # until all are there they are those of no table
        brushes = [*(f"brush {term.name}" for term in output.terms), "brush no rule"]
        cells = [f"{row.name}, {column.name}" for row in rows.terms for column in columns.terms]
        if self._brush_buttons.relabel(brushes) or self._cell_buttons.relabel(cells):
            return False
        self._terms = terms
        self._style.content = grid.focus_html(self._cell_buttons.ids, len(columns.terms))
        return True

    def _choose(self, number: int) -> None:
        state = self._store.state
        shown = shown_grid(state)
        names = [] if shown is None else [term.name for term in grid_variables(state.document, shown)[2].terms]
        self._store.dispatch(Selected({"brush": names[number] if number < len(names) else None}))

    def _paint(self, number: int) -> None:
        edit = painted(self._store.state, number)
        if edit is not None and self._has_all:  # until then the page shows the cells of another table
            self._store.dispatch(edit)

    def _filled(self, value: object) -> Edit | None:
        state = self._store.state
        name = clean.choice(value, (*_FILLS, _FROM_GAINS), "the pattern")
        shown = shown_grid(state)
        if shown is None:
            return None
        if name in _FILLS:
            return Edit(f"fill the table: {name}", partial(_FILLS[name], grid=shown))
        kp, kd = state.design.gains or edits.full_gains(state.document, shown)
        change = partial(edits.fill_linear, proportional=kp, derivative=kd, grid=shown)
        return Edit(f"fill the table: Kp = {kp:g}, Kd = {kd:g}", change)


def _gained(value: object) -> DesignChanged:
    if not isinstance(value, tuple | list) or len(value) != 2:
        raise clean.Refused("the gains are no pair; valid are two numbers")
    kp, kd = (clean.number(one, -_MOST_GAIN, _MOST_GAIN, name) for one, name in zip(value, ("Kp", "Kd"), strict=True))
    return DesignChanged({"gains": (kp, kd)})
