"""ferrifuzz (Rust). Default resolution: 200 steps, 201 end points."""

from __future__ import annotations

from importlib import import_module, metadata
from typing import Any

from protocol import serve

ferrifuzz: Any = import_module("ferrifuzz")
SHAPES = {"triangle": ferrifuzz.mf.triangle, "gaussian": ferrifuzz.mf.gaussian}


class Driver:
    batches = True

    def version(self) -> str:
        return metadata.version("ferrifuzz")

    def build(self, system: dict[str, Any]) -> None:
        self.inputs = [_variable(v) for v in system["inputs"]]
        self.outputs = [_variable(v) for v in system["outputs"]]
        self.names = [v["name"] for v in system["inputs"]]
        self.output = system["outputs"][0]["name"]
        self.antecedents = [
            " AND ".join(f"{name} IS {term}" for name, term in zip(self.names, terms, strict=True))
            for terms, _ in system["rules"]
        ]
        self.rules = [self._rule(n, term) for n, (_, term) in enumerate(system["rules"])]
        self._assemble()

    def calls(self, rows: list[list[float]]) -> list[float]:
        evaluate = self.system.evaluate
        return [evaluate(row)[0] for row in rows]

    def batch(self, rows: Any) -> Any:
        columns = {name: rows[:, n].copy() for n, name in enumerate(self.names)}
        return self.system.compute_batch(columns)[self.output]

    def edit(self, rule: int, term: str) -> None:
        # A rule cannot be replaced; the variables and the parsed rules can be used again.
        self.rules[rule] = self._rule(rule, term)
        self._assemble()

    def _rule(self, number: int, term: str) -> Any:
        return ferrifuzz.Rule.from_string(f"IF {self.antecedents[number]} THEN {self.output} IS {term}")

    def _assemble(self) -> None:
        self.system = ferrifuzz.FuzzySystem()
        for variable in self.inputs:
            self.system.add_input(variable)
        for variable in self.outputs:
            self.system.add_output(variable)
        self.system.add_rules(self.rules)


def _variable(found: dict[str, Any]) -> Any:
    variable = ferrifuzz.Variable(found["name"], found["low"], found["high"])
    for name, kind, parameters in found["terms"]:
        variable[name] = SHAPES[kind](*parameters)
    return variable


serve(Driver())
