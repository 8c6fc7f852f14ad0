"""simpful (Python). Default resolution: 1000 end points."""

from __future__ import annotations

import functools
from importlib import import_module, metadata
from typing import Any

from protocol import serve

simpful: Any = import_module("simpful")
SHAPES = {"triangle": simpful.TriangleFuzzySet, "gaussian": simpful.GaussianFuzzySet}


class Driver:
    batches = False

    def version(self) -> str:
        return metadata.version("simpful")

    def build(self, system: dict[str, Any]) -> None:
        self.names = [v["name"] for v in system["inputs"]]
        self.output = system["outputs"][0]["name"]
        self.antecedents = [
            functools.reduce(
                lambda left, right: f"({left} AND {right})",
                [f"({name} IS {term})" for name, term in zip(self.names, terms, strict=True)],
            )
            for terms, _ in system["rules"]
        ]
        self.system = simpful.FuzzySystem(show_banner=False, verbose=False)
        for variable in system["inputs"] + system["outputs"]:
            sets = [SHAPES[kind](*parameters, term=name) for name, kind, parameters in variable["terms"]]
            self.system.add_linguistic_variable(
                variable["name"],
                simpful.LinguisticVariable(sets, universe_of_discourse=[variable["low"], variable["high"]]),
            )
        self.system.add_rules([self._text(n, term) for n, (_, term) in enumerate(system["rules"])])

    def calls(self, rows: list[list[float]]) -> list[float]:
        system, names, output = self.system, self.names, [self.output]
        values = []
        for row in rows:
            for name, value in zip(names, row, strict=True):
                system.set_variable(name, value)
            values.append(system.Mamdani_inference(output, ignore_warnings=True)[self.output])
        return values

    def batch(self, rows: Any) -> Any:
        return self.calls(rows.tolist())

    def edit(self, rule: int, term: str) -> None:
        self.system.replace_rule(rule, self._text(rule, term))

    def _text(self, number: int, term: str) -> str:
        return f"IF {self.antecedents[number]} THEN ({self.output} IS {term})"


serve(Driver())
