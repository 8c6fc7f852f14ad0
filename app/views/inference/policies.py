"""What happens to an input outside its range, and what an output is when no rule fires; for each variable."""

from __future__ import annotations

from functools import partial
from typing import Any, get_args

import viser

from app import clean
from app.numbers import MOST_VALUE
from app.state import AppState, Edit
from app.store import Shown, Store
from app.widgets import aligned_html, on_input
from fuzzy import edits
from fuzzy.system import Input, NoFire, NoFirePolicy, OutOfRange, Output


class PoliciesView:
    """A choice for each variable; made anew only for other variables."""

    def __init__(self, gui: viser.GuiApi, store: Store) -> None:
        self._gui = gui
        self._store = store
        self._key: tuple[tuple[str, ...], ...] = ()
        self._place = gui.add_folder(None)
        self._alignment = gui.add_html("")
        self._inputs: list[Any] = []
        self._outputs: list[tuple[Any, Any]] = []

    def shows(self, state: AppState) -> Shown:
        """Return the parts that are shown."""
        return state.document.inputs, state.document.outputs

    def render(self, state: AppState) -> None:
        """Show the policies of the document."""
        document = state.document
        key = tuple(tuple(v.name for v in variables) for variables in (document.inputs, document.outputs))
        if key != self._key:
            self._key = key
            self._build()
        for handle, variable in zip(self._inputs, document.inputs, strict=True):
            handle.value = variable.out_of_range
        for (policy, value), output in zip(self._outputs, document.outputs, strict=True):
            policy.value = output.no_fire.policy
            value.visible = output.no_fire.policy == "default"
            value.value = float(output.no_fire.value)

    def _build(self) -> None:
        for handle in (*self._inputs, *(one for pair in self._outputs for one in pair)):
            handle.remove()
        inputs, outputs = self._key
        with self._place:
            self._inputs = [
                self._gui.add_dropdown(
                    f"{name} out of range",
                    get_args(OutOfRange),
                    hint="clamp: as at the range's end; reject: no inference",
                )
                for name in inputs
            ]
            self._outputs = [
                (
                    self._gui.add_dropdown(
                        f"{name} if no rule", get_args(NoFirePolicy), hint="What the output is when no rule fires"
                    ),
                    self._gui.add_number(f"{name} default", 0.0, step=0.001),
                )
                for name in outputs
            ]
        self._alignment.content = aligned_html([*self._inputs, *(one for pair in self._outputs for one in pair)])
        for number, handle in enumerate(self._inputs):
            on_input(handle, self._store.dispatch, partial(self._range_edit, number))
        for number, (policy, value) in enumerate(self._outputs):
            on_input(policy, self._store.dispatch, partial(self._policy_edit, number))
            on_input(value, self._store.dispatch, partial(self._value_edit, number))

    def _range_edit(self, number: int, value: object) -> Edit:
        policy: Any = clean.choice(value, get_args(OutOfRange), "the policy")
        variable = self._input(number)
        change = partial(edits.set_out_of_range, variable=variable.name, policy=policy)
        return Edit(f"{variable.name} beyond its range: {policy}", change)

    def _policy_edit(self, number: int, value: object) -> Edit:
        policy: Any = clean.choice(value, get_args(NoFirePolicy), "the policy")
        output = self._output(number)
        default = min(max(0.0, output.low), output.high) if policy == "default" else 0.0
        return _no_fire_edit(output, NoFire(policy, default))

    def _value_edit(self, number: int, value: object) -> Edit | None:
        output = self._output(number)
        wanted = NoFire("default", clean.number(value, -MOST_VALUE, MOST_VALUE))
        return None if output.no_fire.policy != "default" else _no_fire_edit(output, wanted)

    def _input(self, number: int) -> Input:
        return self._store.state.document.inputs[number]

    def _output(self, number: int) -> Output:
        return self._store.state.document.outputs[number]


def _no_fire_edit(output: Output, no_fire: NoFire) -> Edit:
    change = partial(edits.set_no_fire, output=output.name, no_fire=no_fire)
    return Edit(f"{output.name} when no rule fires: {no_fire.policy}", change)
