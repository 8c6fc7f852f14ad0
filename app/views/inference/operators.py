"""Design › Inference: the operators, each with its formula, the resolution, and the policies of the variables."""

from __future__ import annotations

from functools import partial
from typing import Any, get_args

import viser

from app import clean
from app.palette import MUTED
from app.state import AppState, Edit
from app.store import Shown, Store, View
from app.views.inference.formulas import lines
from app.views.inference.policies import PoliciesView
from app.widgets import div, on_input
from fuzzy import edits
from fuzzy.limits import MAX_POINTS, MIN_POINTS
from fuzzy.operators import COMPOSITIONS
from fuzzy.system import Aggregation, Defuzzifier, Implication, Sampling, SamplingRule, SNorm, TNorm

_OTHER = "other"
_COMPOSITIONS = {
    f"{name} ({entry.equation})" if entry.equation else name: {
        "implication": entry.implication,
        "aggregation": entry.aggregation,
    }
    for name, entry in COMPOSITIONS.items()
}
"""The compositions by name, with the number of the source paper's equation."""

_OPERATORS = {
    "conjunction": ("AND", get_args(TNorm)),
    "disjunction": ("OR", get_args(SNorm)),
    "implication": ("implication", get_args(Implication)),
    "aggregation": ("aggregation", get_args(Aggregation)),
    "defuzzifier": ("defuzzifier", get_args(Defuzzifier)),
}

_EXACT = "exact"
_RESOLUTIONS = {
    _EXACT: _EXACT,
    "13 levels, with both ends": Sampling(13, "endpoints"),
    "101 points, with both ends": Sampling(101, "endpoints"),
    "1000 midpoints": Sampling(1000, "midpoints"),
}
"""Offered at once; any other sampling by its rule and number of points."""
_SAMPLED = "other samples"
_FIRST_SAMPLING = Sampling(200, "midpoints")


class InferenceView:
    """Editors of the document's inference options.

    Attributes:
        views: This and those inside.
    """

    def __init__(self, gui: viser.GuiApi, store: Store) -> None:
        self._composition = gui.add_dropdown("composition", (*_COMPOSITIONS, _OTHER))
        on_input(self._composition, store.dispatch, _composed)
        self._operators: dict[str, Any] = {}
        for field, (label, options) in _OPERATORS.items():
            self._operators[field] = gui.add_dropdown(label, options)
            on_input(self._operators[field], store.dispatch, partial(_operator_edit, field, options))
        self._resolution = gui.add_dropdown("resolution", (*_RESOLUTIONS, _SAMPLED))
        on_input(self._resolution, store.dispatch, self._resolved)
        self._rule = gui.add_dropdown("samples", get_args(SamplingRule))
        self._points = gui.add_number("points", _FIRST_SAMPLING.points, step=1)
        on_input(self._rule, store.dispatch, self._set_rule)
        on_input(self._points, store.dispatch, self._set_points)
        self.views: tuple[View, ...] = (self, PoliciesView(gui, store))
        self._formulas = gui.add_html("")
        self._store = store

    def shows(self, state: AppState) -> Shown:
        """Return the parts that are shown."""
        return (state.document.inference,)

    def render(self, state: AppState) -> None:
        """Show the document's options."""
        inference = state.document.inference
        pair = {"implication": inference.implication, "aggregation": inference.aggregation}
        names = [name for name, operators in _COMPOSITIONS.items() if operators == pair]
        self._composition.value = names[0] if names else _OTHER
        for field, handle in self._operators.items():
            handle.value = getattr(inference, field)
        offered = [name for name, resolution in _RESOLUTIONS.items() if resolution == inference.resolution]
        self._resolution.value = offered[0] if offered else _SAMPLED
        sampling = self._sampling()
        for handle in (self._rule, self._points):
            handle.visible = sampling is not None
        shown = sampling or _FIRST_SAMPLING
        self._rule.value, self._points.value = shown.rule, shown.points
        text = "".join(f'<div style="margin:0.3em 0">{line}</div>' for line in lines(inference))
        self._formulas.content = div(text, f"color:{MUTED}")

    def _resolved(self, value: object) -> Edit | None:
        name = clean.choice(value, (*_RESOLUTIONS, _SAMPLED), "the resolution")
        if name in _RESOLUTIONS:
            return _resolution_edit(_RESOLUTIONS[name])
        return _resolution_edit(_FIRST_SAMPLING) if self._sampling() is None else None

    def _set_rule(self, value: object) -> Edit | None:
        rule: Any = clean.choice(value, get_args(SamplingRule), "the sampling rule")
        sampling = self._sampling()
        return None if sampling is None else _resolution_edit(Sampling(sampling.points, rule))

    def _set_points(self, value: object) -> Edit | None:
        points = round(clean.number(value, MIN_POINTS, MAX_POINTS, "the number of points"))
        sampling = self._sampling()
        return None if sampling is None else _resolution_edit(Sampling(points, sampling.rule))

    def _sampling(self) -> Sampling | None:
        resolution = self._store.state.document.inference.resolution
        return resolution if isinstance(resolution, Sampling) else None


def _composed(value: object) -> Edit | None:
    name = clean.choice(value, (*_COMPOSITIONS, _OTHER), "the composition")
    if name == _OTHER:
        return None
    return Edit(f"composition {name}", partial(edits.set_inference, **_COMPOSITIONS[name]))


def _operator_edit(field: str, options: tuple[str, ...], value: object) -> Edit:
    name = clean.choice(value, options, f"the {_OPERATORS[field][0]}")
    return Edit(f"{_OPERATORS[field][0]} {name}", partial(edits.set_inference, **{field: name}))


def _resolution_edit(resolution: Any) -> Edit:
    text = resolution if resolution == _EXACT else f"{resolution.points} {resolution.rule}"
    return Edit(f"resolution {text}", partial(edits.set_inference, resolution=resolution), "resolution")
