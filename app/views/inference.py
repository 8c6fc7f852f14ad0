"""Design › Inference: the operators, each with its formula, and what an output is when no rule fires."""

from __future__ import annotations

from functools import partial
from typing import Any, get_args

import viser

from app import clean
from app.palette import MUTED
from app.state import AppState, Edit
from app.store import Dispatch
from app.widgets import div, on_input
from fuzzy import edits
from fuzzy.system import Aggregation, Defuzzifier, Implication, Inference, NoFire, NoFirePolicy, Sampling, SNorm, TNorm

_COMPOSITIONS = {
    "Max-Min (31)": {"implication": "min", "aggregation": "max"},
    "Max-Product": {"implication": "product", "aggregation": "max"},
    "Sum-Min (32)": {"implication": "min", "aggregation": "sum"},
    "Sum-Product": {"implication": "product", "aggregation": "sum"},
}
"""Named pairs of implication and aggregation; the numbers are the paper's equations."""

_OPERATORS = {
    "conjunction": ("AND", get_args(TNorm)),
    "disjunction": ("OR", get_args(SNorm)),
    "implication": ("implication", get_args(Implication)),
    "aggregation": ("aggregation", get_args(Aggregation)),
    "defuzzifier": ("defuzzifier", get_args(Defuzzifier)),
}

_FORMULAS = {
    ("implication", "min"): "rule r clips its set: μ<sub>r</sub>(u) = min(w<sub>r</sub>, μ(u))",
    ("implication", "product"): "rule r scales its set: μ<sub>r</sub>(u) = w<sub>r</sub> · μ(u)",
    ("aggregation", "max"): "output set: μ(u) = max<sub>r</sub> μ<sub>r</sub>(u)",
    ("aggregation", "sum"): "output set: μ(u) = Σ<sub>r</sub> μ<sub>r</sub>(u)",
    ("conjunction", "min"): "a AND b = min(a, b)",
    ("conjunction", "product"): "a AND b = a · b",
    ("conjunction", "bounded_difference"): "a AND b = max(0, a + b − 1)",
    ("conjunction", "drastic_product"): "a AND b = a if b = 1, b if a = 1, otherwise 0",
    ("conjunction", "einstein_product"): "a AND b = a b / (2 − (a + b − a b))",
    ("conjunction", "hamacher_product"): "a AND b = a b / (a + b − a b)",
    ("conjunction", "nilpotent_minimum"): "a AND b = min(a, b) if a + b &gt; 1, otherwise 0",
    ("disjunction", "max"): "a OR b = max(a, b)",
    ("disjunction", "algebraic_sum"): "a OR b = a + b − a · b",
    ("disjunction", "bounded_sum"): "a OR b = min(1, a + b)",
    ("disjunction", "drastic_sum"): "a OR b = a if b = 0, b if a = 0, otherwise 1",
    ("disjunction", "einstein_sum"): "a OR b = (a + b) / (1 + a b)",
    ("disjunction", "hamacher_sum"): "a OR b = (a + b − 2 a b) / (1 − a b)",
    ("disjunction", "nilpotent_maximum"): "a OR b = max(a, b) if a + b &lt; 1, otherwise 1",
    ("defuzzifier", "center_of_sums"): (
        "center of sums: T = Σ<sub>r</sub> ∫ u μ<sub>r</sub>(u) du / Σ<sub>r</sub> ∫ μ<sub>r</sub>(u) du "
        "&nbsp;(33; the paper's COG): every rule counts, whatever the aggregation"
    ),
    ("defuzzifier", "centroid"): "centroid: T = ∫ u μ(u) du / ∫ μ(u) du &nbsp;(34; the paper's COA, IEC's COG)",
}

_EXACT = "exact"
_RESOLUTIONS = {
    _EXACT: _EXACT,
    "13 levels, with both ends": Sampling(13, "endpoints"),
    "101 points, with both ends": Sampling(101, "endpoints"),
    "1000 midpoints": Sampling(1000, "midpoints"),
}
"""Offered resolutions; a file may hold any other."""

_MOST_VALUE = 1e12


class InferenceView:
    """Editors of the document's inference options."""

    def __init__(self, gui: viser.GuiApi, dispatch: Dispatch) -> None:
        self._composition = gui.add_dropdown("composition", (*_COMPOSITIONS, "other"))
        on_input(self._composition, dispatch, _composed)
        self._operators: dict[str, Any] = {}
        for field, (label, options) in _OPERATORS.items():
            self._operators[field] = gui.add_dropdown(label, options)
            on_input(self._operators[field], dispatch, partial(_operator_edit, field, options))
        self._resolution = gui.add_dropdown("resolution", (*_RESOLUTIONS, "as in the file"))
        on_input(self._resolution, dispatch, _resolved)
        self._policy = gui.add_dropdown("no rule fires", get_args(NoFirePolicy))
        self._value = gui.add_number("its value", 0.0)
        on_input(self._policy, dispatch, self._policy_edit)
        on_input(self._value, dispatch, self._value_edit)
        self._formulas = gui.add_html("")
        self._state: AppState | None = None

    def render(self, state: AppState) -> None:
        """Show the document's options."""
        self._state = state
        inference = state.document.inference
        pair = {"implication": inference.implication, "aggregation": inference.aggregation}
        names = [name for name, operators in _COMPOSITIONS.items() if operators == pair]
        self._composition.value = names[0] if names else "other"
        for field, handle in self._operators.items():
            handle.value = getattr(inference, field)
        offered = [name for name, resolution in _RESOLUTIONS.items() if resolution == inference.resolution]
        self._resolution.value = offered[0] if offered else "as in the file"
        no_fire = state.document.outputs[0].no_fire
        self._policy.value = no_fire.policy
        self._value.visible = no_fire.policy == "default"
        self._value.value = float(no_fire.value)
        self._formulas.content = _formulas_html(inference)

    def _policy_edit(self, value: object) -> Edit:
        policy: Any = clean.choice(value, get_args(NoFirePolicy), "the policy")
        assert self._state is not None
        output = self._state.document.outputs[0]
        value = min(max(0.0, output.low), output.high) if policy == "default" else 0.0
        return self._no_fire_edit(NoFire(policy, value))

    def _value_edit(self, value: object) -> Edit:
        return self._no_fire_edit(NoFire("default", clean.number(value, -_MOST_VALUE, _MOST_VALUE)))

    def _no_fire_edit(self, no_fire: NoFire) -> Edit:
        assert self._state is not None
        output = self._state.document.outputs[0].name
        label = f"no rule fires: {no_fire.policy}"
        return Edit(label, partial(edits.set_no_fire, output=output, no_fire=no_fire))


def _composed(value: object) -> Edit | None:
    name = clean.choice(value, (*_COMPOSITIONS, "other"), "the composition")
    if name == "other":
        return None
    return Edit(f"composition {name}", partial(edits.set_inference, **_COMPOSITIONS[name]))


def _operator_edit(field: str, options: tuple[str, ...], value: object) -> Edit:
    name = clean.choice(value, options, f"the {_OPERATORS[field][0]}")
    return Edit(f"{_OPERATORS[field][0]} {name}", partial(edits.set_inference, **{field: name}))


def _resolved(value: object) -> Edit | None:
    name = clean.choice(value, (*_RESOLUTIONS, "as in the file"), "the resolution")
    if name not in _RESOLUTIONS:
        return None
    return Edit(f"resolution {name}", partial(edits.set_inference, resolution=_RESOLUTIONS[name]))


def _formulas_html(inference: Inference) -> str:
    lines = [_FORMULAS[field, getattr(inference, field)] for field in _OPERATORS]
    if inference.resolution == _EXACT:
        lines.append("exact: closed forms for piecewise-linear sets; no samples, no step in the surface")
    else:
        lines.append(f"as other engines do: {inference.resolution.points} {inference.resolution.rule}")
    text = "".join(f'<div style="margin:0.3em 0">{line}</div>' for line in lines)
    return div(text, f"color:{MUTED}")
