"""Response › Why: which rules made the output what it is, and which to look at where the response overshoots."""

from __future__ import annotations

import time
from collections.abc import Mapping
from functools import partial

import numpy as np
import viser

from app.palette import BAD, GOOD, MUTED, css, term_colors
from app.runner import Frame
from app.state import Advice, AppState, Edit
from app.store import Shown, Store
from app.widgets import coordinate_label, div, equation, escape, number, on_input
from fuzzy.analysis import Contribution, Contributions, contributions, stepped
from fuzzy.inference import Controller
from fuzzy.language import format_expression
from fuzzy.system import FuzzySystem

_PERIOD = 0.2
"""Least time between two pictures, s: faster than that nobody reads."""

_NOTHING = 1e-3
"""Share of the output's range that counts as nothing."""


class WhyView:
    """A sentence and a bar for every rule that fires, for the chosen coordinate at the time that is shown."""

    def __init__(self, gui: viser.GuiApi, store: Store) -> None:
        self._store = store
        self._shown_at = 0.0
        self._now = gui.add_html("")
        self._advice = gui.add_html("")
        self._try = gui.add_button("Try it", visible=False, hint="Paint the cell as proposed; Ctrl+Z takes it back")
        on_input(self._try, store.dispatch, lambda _: self._proposed())

    def shows(self, state: AppState) -> Shown:
        """Return the parts that are shown."""
        return state.runs.current, state.runs.advice, state.coordinate

    def render(self, state: AppState) -> None:
        """Show the advice for the chosen coordinate."""
        if state.runs.current is None:
            return
        found = _advice_for(state)
        self._advice.content = _advice_html(state, found)
        self._try.visible = found is not None and found.term is not None

    def show(self, frame: Frame) -> None:
        """Explain the output of this moment."""
        now = time.monotonic()
        if now - self._shown_at < _PERIOD and self._store.state.playback.is_playing:
            return
        self._shown_at = now
        if frame.inference is None or not np.isfinite(frame.inputs).all():
            waits = self._store.state.runs.current is None
            text = "The first run is being simulated." if waits else "This law asks no rules: nothing to explain."
            self._now.content = div(text, f"color:{MUTED}")
            return
        found = contributions(frame.inference, frame.inputs)
        self._now.content = _moment_html(frame, frame.inference, found, self._store.state.coordinate)

    def _proposed(self) -> Edit | None:
        found = _advice_for(self._store.state)
        if found is None or found.rule is None or found.term is None:
            return None
        label = f"{_short(found.rule.antecedent)} → {found.term}, as proposed"
        return Edit(label, partial(_with_consequent, number=found.number, term=found.term))


def _with_consequent(system: FuzzySystem, number: int, term: str) -> FuzzySystem:
    """Return the system with the proposed consequent, unless it was edited meanwhile."""
    candidates = (stepped(system, number, steps) for steps in (-3, -2, -1, 1, 2, 3))
    return next((one[0] for one in candidates if one is not None and one[1] == term), system)


def _advice_for(state: AppState) -> Advice | None:
    return next((one for one in state.runs.advice or () if one.coordinate == state.coordinate), None)


def _short(antecedent: object) -> str:
    return format_expression(antecedent)  # pyright: ignore[reportArgumentType]


def _moment_html(frame: Frame, controller: Controller, found: Contributions, coordinate: int) -> str:
    name = coordinate_label(frame.arm.coordinates[coordinate])
    return div(_sentence(frame, controller, found, name) + _bars(controller, found))


def _sentence(frame: Frame, controller: Controller, found: Contributions, name: str) -> str:
    system = controller.system
    e, de = (variable.name for variable in system.inputs)
    where = f"At t = {frame.t:.2f} s {name} has {equation(escape(e), float(frame.inputs[0]))}"
    where = f"{where} and {equation(escape(de), float(frame.inputs[1]))}."
    if not found.rules:
        return f"<div>{where} No rule fires: {equation(escape(found.output), found.value)} is the default.</div>"
    first = found.rules[0]
    reason = "weaker rules together" if first.rule is None else escape(_short(first.rule.antecedent))
    output = equation(escape(found.output), found.value)
    of = next(one for one in system.outputs if one.name == found.output)
    if abs(found.value) < _NOTHING * (of.high - of.low):
        why = "the one rule that fires says so" if len(found.rules) == 1 else "the rules that fire hold each other"
        return f"<div>{where} <b>{output}</b>: {why}.</div>"
    what = f"<b>{output}</b> {'raises' if found.value > 0 else 'lowers'} it"
    return f"<div>{where} {what}, mostly because {reason} ({_signed(first.moved)}).</div>"


def _bars(controller: Controller, found: Contributions) -> str:
    """Return a row for every rule: what it says, its firing strength, and a bar to the side to which it moved T."""
    output = controller.system.outputs[0]
    colors = {term.name: css(color) for term, color in zip(output.terms, term_colors(output), strict=True)}
    largest = max((abs(one.moved) for one in found.rules), default=1.0) or 1.0
    rows = [_bar(one, colors, 50.0 * one.moved / largest) for one in found.rules]
    start = f"from {number(found.base)}" if found.base else ""
    head = f'<div style="color:{MUTED};margin-top:6px">how far each rule moved {escape(found.output)} {start}</div>'
    return head + "".join(rows) if rows else ""


def _bar(one: Contribution, colors: Mapping[str, str], width: float) -> str:
    if one.rule is None:
        text, color = "weaker rules together", MUTED
    else:
        consequent = one.rule.consequents[0].term
        color = colors.get(consequent, MUTED)
        text = f"{escape(_short(one.rule.antecedent))} → {escape(consequent)}"
        text = f'{text} <span style="color:{MUTED}">fires {number(one.strength, 2)}</span>'
    left = 50.0 + min(width, 0.0)
    bar = f"left:{left:.1f}%;width:{abs(width):.1f}%;background:{color}"
    track = "position:relative;height:6px;background:rgba(255,255,255,.06);border-radius:3px"
    middle = "position:absolute;left:50%;top:-2px;bottom:-2px;width:1px;background:rgba(255,255,255,.35)"
    return (
        f'<div style="margin:5px 0"><div style="display:flex;justify-content:space-between"><span>{text}</span>'
        f'<b style="font-variant-numeric:tabular-nums;white-space:nowrap">{_signed(one.moved)}</b></div>'
        f'<div style="{track}"><i style="position:absolute;top:0;bottom:0;border-radius:3px;{bar}"></i>'
        f'<i style="{middle}"></i></div></div>'
    )


def _signed(value: float) -> str:
    return f"+{number(value)}" if value > 0 else number(value)


def _advice_html(state: AppState, found: Advice | None) -> str:
    current = state.runs.current
    assert current is not None
    name = coordinate_label(current.run.arm.coordinates[state.coordinate])
    if state.runs.advice is None:
        return div("Looking for the rule behind the overshoot …", f"color:{MUTED}")
    if found is None:
        others = [coordinate_label(current.run.arm.coordinates[one.coordinate]) for one in state.runs.advice]
        more = f" Look at {', '.join(others)}." if others else ""
        return div(f"{name} does not overshoot.{more}", f"color:{MUTED}")
    text = f"<b>{name} overshoots by {number(found.percent)} %</b>, most at t = {found.peak:.2f} s."
    if found.rule is None:
        return div(f"{text} No rule had a part in it: look at the gains.")
    rule = f"{escape(_short(found.rule.antecedent))} → {escape(found.rule.consequents[0].term)}"
    did = "pushed on" if found.push > 0 else "braked"
    when = f"between {found.start:.2f} and {found.peak:.2f} s"
    text = f"{text} Look at <b>{rule}</b>: {when} it {did}, by {number(abs(found.push))} on the mean."
    if found.term is None:
        return div(f'{text} <span style="color:{BAD}">No other term helps: look at the gains.</span>')
    settles = "it never settles" if not np.isfinite(found.settling) else f"settling {number(found.settling)} s"
    tried = f"Tried: with {escape(found.term)} it overshoots by {number(found.after)} %, {settles}."
    return div(f'{text} <span style="color:{GOOD}">{tried}</span>')
