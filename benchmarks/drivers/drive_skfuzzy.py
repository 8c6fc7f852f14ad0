"""scikit-fuzzy (numpy), its control interface. Universes of 121 points, which hold every break point."""

from __future__ import annotations

import functools
import operator
from importlib import import_module, metadata
from typing import Any

import numpy as np
from protocol import serve

skfuzzy: Any = import_module("skfuzzy")
control: Any = import_module("skfuzzy.control")
POINTS = 121


class Driver:
    batches = True

    def version(self) -> str:
        return metadata.version("scikit-fuzzy")

    def build(self, system: dict[str, Any]) -> None:
        self.inputs = [_variable(control.Antecedent, v) for v in system["inputs"]]
        self.output = _variable(control.Consequent, system["outputs"][0])
        self.antecedents = [terms for terms, _ in system["rules"]]
        self.rules = [self._rule(n, term) for n, (_, term) in enumerate(system["rules"])]
        self._assemble()

    def calls(self, rows: list[list[float]]) -> list[float]:
        simulation = self.simulation
        values = []
        for row in rows:
            for variable, value in zip(self.inputs, row, strict=True):
                simulation.input[variable.label] = value
            simulation.compute()
            values.append(simulation.output.get(self.output.label, np.nan))
        return values

    def batch(self, rows: Any) -> Any:
        # A simulation keeps to numbers or to arrays, so this one is another.
        simulation = control.ControlSystemSimulation(self.system)
        for n, variable in enumerate(self.inputs):
            simulation.input[variable.label] = rows[:, n].copy()
        simulation.compute()
        return simulation.output[self.output.label]

    def edit(self, rule: int, term: str) -> None:
        # A rule cannot be replaced; the variables and the other rules can be used again.
        self.rules[rule] = self._rule(rule, term)
        self._assemble()

    def _rule(self, number: int, term: str) -> Any:
        propositions = [variable[name] for variable, name in zip(self.inputs, self.antecedents[number], strict=True)]
        return control.Rule(functools.reduce(operator.and_, propositions), self.output[term], label=f"rule {number}")

    def _assemble(self) -> None:
        self.system = control.ControlSystem(self.rules)
        self.simulation = control.ControlSystemSimulation(self.system)


def _variable(kind: Any, found: dict[str, Any]) -> Any:
    shapes = {"triangle": lambda u, p: skfuzzy.trimf(u, p), "gaussian": lambda u, p: skfuzzy.gaussmf(u, *p)}
    variable = kind(np.linspace(found["low"], found["high"], POINTS), found["name"])
    for name, shape, parameters in found["terms"]:
        variable[name] = shapes[shape](variable.universe, parameters)
    return variable


serve(Driver())
