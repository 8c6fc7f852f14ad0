"""pyfuzzylite (numpy). Default resolution: 1000 midpoints."""

from __future__ import annotations

from importlib import import_module, metadata
from typing import Any

import numpy as np
from protocol import serve

fuzzylite: Any = import_module("fuzzylite")
SHAPES = {"triangle": fuzzylite.Triangle, "gaussian": fuzzylite.Gaussian}


class Driver:
    batches = True

    def version(self) -> str:
        return metadata.version("pyfuzzylite")

    def build(self, system: dict[str, Any]) -> None:
        self.names = [v["name"] for v in system["inputs"]]
        self.output = system["outputs"][0]["name"]
        self.antecedents = [
            " and ".join(f"{name} is {term}" for name, term in zip(self.names, terms, strict=True))
            for terms, _ in system["rules"]
        ]
        block = fuzzylite.RuleBlock(
            conjunction=fuzzylite.Minimum(),
            disjunction=fuzzylite.Maximum(),
            implication=fuzzylite.Minimum(),
            activation=fuzzylite.General(),
            rules=[fuzzylite.Rule.create(self._text(n, term)) for n, (_, term) in enumerate(system["rules"])],
        )
        self.engine = fuzzylite.Engine(
            "benchmark",
            input_variables=[
                fuzzylite.InputVariable(
                    v["name"], minimum=v["low"], maximum=v["high"], lock_range=True, terms=_terms(v)
                )
                for v in system["inputs"]
            ],
            output_variables=[
                fuzzylite.OutputVariable(
                    v["name"],
                    minimum=v["low"],
                    maximum=v["high"],
                    aggregation=fuzzylite.Maximum(),
                    defuzzifier=fuzzylite.Centroid(),
                    terms=_terms(v),
                )
                for v in system["outputs"]
            ],
            rule_blocks=[block],
        )

    def calls(self, rows: list[list[float]]) -> list[float]:
        engine = self.engine
        inputs, output = engine.input_variables, engine.output_variables[0]
        values = []
        for row in rows:
            for variable, value in zip(inputs, row, strict=True):
                variable.value = value
            engine.process()
            values.append(float(np.take(output.value, -1)))
        return values

    def batch(self, rows: Any) -> Any:
        self.engine.input_values = rows
        self.engine.process()
        return self.engine.output_variables[0].value

    def edit(self, rule: int, term: str) -> None:
        self.engine.rule_blocks[0].rules[rule] = fuzzylite.Rule.create(self._text(rule, term), self.engine)

    def _text(self, number: int, term: str) -> str:
        return f"if {self.antecedents[number]} then {self.output} is {term}"


def _terms(variable: dict[str, Any]) -> list[Any]:
    return [SHAPES[kind](name, *parameters) for name, kind, parameters in variable["terms"]]


serve(Driver())
