"""Design › Rules, lower part: the rules of the list, and one that is being written."""

from __future__ import annotations

import time
from collections.abc import Callable
from functools import partial
from typing import Any

import viser

from app import clean, grid
from app.palette import ERROR, MUTED
from app.runner import Frame
from app.state import AppState, DesignChanged, Edit, Event
from app.store import Shown, Store
from app.widgets import div, escape, full_width_html, on_input, put
from fuzzy import edits, language, rules
from fuzzy.errors import FormatError
from fuzzy.system import And, Expression, FuzzySystem, Is, Not, Rule

_MOST_TEXT = 4000
_ACTIONS = ("add", "replace", "delete", "new")
_STEPS = {"‹": -1, "›": 1}
_AS_LIST = "turn the table into a list"
_AS_TABLE = "turn the list into a table"


class RuleListView:
    """A page of the list, and the editor of one rule."""

    def __init__(self, gui: viser.GuiApi, store: Store) -> None:
        self._store = store
        self._offset = 0
        self._head = gui.add_html("")
        self._rows = gui.add_html("")
        self._glow = gui.add_html("")
        self._chosen = gui.add_html("")
        self._pages = gui.add_button_group("page", tuple(_STEPS))
        self._text = gui.add_text("rule", "", multiline=True)
        gui.add_html(full_width_html(self._text, 10, 10))
        self._error = gui.add_html("")
        self._weight = gui.add_slider("weight", 0.0, 1.0, 0.01, 1.0)
        self._actions = gui.add_button_group("", _ACTIONS)
        self._form: Any = gui.add_button_group("", (_AS_LIST,))
        self._buttons = grid.HiddenButtons(gui, [f"rule {n + 1} of the page" for n in range(grid.PAGE)], self._choose)
        on_input(self._pages, store.dispatch, self._turn_page)
        on_input(self._text, store.dispatch, lambda text: DesignChanged({"rule_text": clean.text(text, _MOST_TEXT)}))
        on_input(self._weight, store.dispatch, self._weigh)
        on_input(self._actions, store.dispatch, self._act)
        on_input(self._form, store.dispatch, self._change_form)

    def shows(self, state: AppState) -> Shown:
        """Return the parts that are shown."""
        return state.document, state.design

    def render(self, state: AppState) -> None:
        """Show the page, the chosen rule and what is wrong with the text."""
        system, design = state.document, state.design
        listed = system.rules.list
        self._offset = len(rules.all_rules(system)) - len(listed)
        page = _page(state)
        first = page * grid.PAGE
        shown = listed[first : first + grid.PAGE]
        self._head.content = div(_head(system, first, len(shown)))
        self._rows.content = grid.rows_html(
            [
                grid.row_html(
                    target,
                    f"rule{first + n}",
                    f'<span style="color:{MUTED}">{first + n + 1}</span> {escape(language.format_rule(rule))}',
                )
                for n, (rule, target) in enumerate(zip(shown, self._buttons.ids, strict=False))
            ]
        )
        self._chosen.content = "" if design.rule is None else grid.chosen_html(f"rule{design.rule}")
        put(self._pages, visible=len(listed) > grid.PAGE)
        self._text.value = _text(state)
        self._error.content = _error_html(state)
        chosen = None if design.rule is None else listed[design.rule]
        put(self._weight, visible=chosen is not None)
        if chosen is not None:
            self._weight.value = chosen.weight
        has_table = system.rules.table is not None
        put(self._form, visible=design.grid is not None)
        options = (_AS_LIST if has_table else _AS_TABLE,)
        put(self._form, options=options)

    def show(self, frame: Frame) -> None:
        """Let the rules glow with their firing strengths."""
        state = self._store.state
        first = _page(state) * grid.PAGE
        count = len(state.document.rules.list[first : first + grid.PAGE])
        strengths: list[float] = []
        if (
            count
            and frame.strength is not None
            and frame.strength.size == self._offset + len(state.document.rules.list)
        ):
            start = self._offset + first
            strengths = frame.strength[start : start + count].round(2).tolist()
        self._glow.content = grid.row_glow_html(strengths, first)

    def _choose(self, number: int) -> None:
        state = self._store.state
        chosen = _page(state) * grid.PAGE + number
        if chosen < len(state.document.rules.list):
            self._store.dispatch(DesignChanged({"rule": chosen, "rule_text": None}))

    def _turn_page(self, value: object) -> DesignChanged:
        state = self._store.state
        page = _page(state) + _STEPS[clean.choice(value, _STEPS, "the page")]
        return DesignChanged({"page": min(max(page, 0), _last_page(state.document))})

    def _weigh(self, value: object) -> Edit | None:
        state = self._store.state
        number = state.design.rule
        weight = clean.number(value, 0.0, 1.0, "the weight")
        if number is None or weight == state.document.rules.list[number].weight:
            return None
        change = partial(edits.set_weight, number=number, weight=weight)
        return Edit(f"rule {number + 1}: weight {weight:g}", change, f"weight {number}", time.monotonic())

    def _act(self, value: object) -> Event | tuple[Event, ...] | None:
        state = self._store.state
        action = clean.choice(value, _ACTIONS, "the action")
        number = state.design.rule
        listed = len(state.document.rules.list)
        if action == "new":
            return DesignChanged({"rule": None, "rule_text": ""})
        if action == "add":
            chosen = DesignChanged({"rule": listed, "page": listed // grid.PAGE})
            return Edit(f"add rule {listed + 1}", _written(_text(state), edits.add_rule)), chosen
        if number is None:
            raise clean.Refused(f"no rule is chosen to {action}; valid is a click on one of the list first")
        if action == "delete":
            return Edit(f"delete rule {number + 1}", partial(edits.remove_rule, number=number))
        return Edit(f"replace rule {number + 1}", _written(_text(state), partial(_replaced, number=number)))

    def _change_form(self, value: object) -> tuple[Event, ...] | None:
        shown = self._store.state.design.grid
        chosen = DesignChanged({"rule": None, "page": 0})  # numbers of the list now stand for other rules
        if clean.choice(value, (_AS_LIST, _AS_TABLE), "the form") == _AS_LIST:
            return Edit(_AS_LIST, edits.dissolve_table), chosen
        return None if shown is None else (Edit(_AS_TABLE, partial(edits.give_table, grid=shown)), chosen)


def _written(text: str, edit: Callable[..., FuzzySystem]) -> Callable[[FuzzySystem], FuzzySystem]:
    """Return the edit with the rule that a text says, read in the system that is edited."""
    return lambda system: edit(system, rule=language.parse_rule(text, system))


def _replaced(system: FuzzySystem, number: int, rule: rules.Rule) -> FuzzySystem:
    return edits.set_rule(system, number, rule)


def _text(state: AppState) -> str:
    """Return the text that is being written, or the chosen rule's own."""
    design = state.design
    if design.rule_text is not None:
        return design.rule_text
    return "" if design.rule is None else language.format_rule(state.document.rules.list[design.rule])


def _page(state: AppState) -> int:
    return min(state.design.page, _last_page(state.document))


def _last_page(system: FuzzySystem) -> int:
    return max(len(system.rules.list) - 1, 0) // grid.PAGE


def _head(system: FuzzySystem, first: int, count: int) -> str:
    listed = len(system.rules.list)
    if not listed:
        text = "none" if system.rules.table is None else "none besides the table"
        return f'<b>Rules as text</b> <span style="color:{MUTED}">{text}</span>'
    which = f"{listed}" if count == listed else f"{first + 1} to {first + count} of {listed}"
    return f'<b>Rules as text</b> <span style="color:{MUTED}">{which}</span>'


def _example(system: FuzzySystem) -> str:
    """Return a rule that could be written, in the document's own words."""
    first, last, output = system.inputs[0], system.inputs[-1], system.outputs[0]
    tested: Expression = Not(Is(last.name, last.terms[-1].name))
    if first is not last:
        tested = And((Is(first.name, first.terms[0].name), tested))
    return language.format_rule(Rule(tested, (Is(output.name, output.terms[0].name),), 0.8))


def _error_html(state: AppState) -> str:
    """Return what is wrong with the text, under the column at which it is."""
    text = _text(state)
    if not text.strip():
        return div(f"such as <code>{escape(_example(state.document))}</code>", f"color:{MUTED};font-size:12px")
    try:
        language.parse_rule(text, state.document)
    except FormatError as error:
        at = max(error.column - 1, 0)
        before, rest = text[:at], text[at:].split(maxsplit=1)
        wrong = rest[0][:40] if rest else "⌴"
        where = f'{escape(before[-28:])}<u style="color:{ERROR};text-underline-offset:3px">{escape(wrong)}</u>'
        message = f'<span style="color:{ERROR}">column {error.column}: {escape(error.message)}</span>'
        return div(f'<code style="font-size:12px">{where}</code><br>{message}')
    return ""
