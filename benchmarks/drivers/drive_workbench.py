"""This project's engine."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parents[2]))

from msgspec.structs import replace
from protocol import serve

from fuzzy import compile_system
from fuzzy.shapes import Gaussian, Shape, Triangle
from fuzzy.system import And, FuzzySystem, Input, Is, Output, Rule, RuleBase, RuleTable, Term


class Driver:
    batches = True

    def version(self) -> str:
        return "(here)"

    def build(self, system: dict[str, Any]) -> None:
        inputs = tuple(Input(v["name"], v["low"], v["high"], _terms(v)) for v in system["inputs"])
        outputs = tuple(Output(v["name"], v["low"], v["high"], _terms(v)) for v in system["outputs"])
        self.system = FuzzySystem("benchmark", inputs, outputs, _rules(system, inputs, outputs[0]))
        self.controller = compile_system(self.system)

    def calls(self, rows: list[list[float]]) -> list[float]:
        controller: Any = self.controller
        return [controller(*row) for row in rows]

    def batch(self, rows: Any) -> Any:
        return self.controller.batch(rows)

    def edit(self, rule: int, term: str) -> None:
        base = self.system.rules
        if base.table is None:
            changed = list(base.list)
            changed[rule] = replace(changed[rule], consequents=(Is(self.system.outputs[0].name, term),))
            base = replace(base, list=tuple(changed))
        else:
            cells = [list(row) for row in base.table.cells]
            cells[rule // len(cells[0])][rule % len(cells[0])] = term
            base = replace(base, table=replace(base.table, cells=tuple(map(tuple, cells))))
        self.system = replace(self.system, rules=base)
        self.controller = compile_system(self.system)


def _terms(variable: dict[str, Any]) -> tuple[Term, ...]:
    shapes: dict[str, Callable[..., Shape]] = {"triangle": Triangle, "gaussian": Gaussian}
    return tuple(Term(name, shapes[kind](*parameters)) for name, kind, parameters in variable["terms"])


def _rules(system: dict[str, Any], inputs: tuple[Input, ...], output: Output) -> RuleBase:
    """Return a table where the rules fill one, as a user would have it, otherwise a list."""
    names = [variable.name for variable in inputs]
    found = {tuple(terms): consequent for terms, consequent in system["rules"]}
    if len(inputs) == 2:
        rows, columns = ([term.name for term in variable.terms] for variable in inputs)
        if list(found) == [(row, column) for row in rows for column in columns]:
            cells = tuple(tuple(found[row, column] for column in columns) for row in rows)
            return RuleBase(RuleTable(names[0], names[1], output.name, cells))
    return RuleBase(
        list=tuple(
            Rule(And(tuple(map(Is, names, terms))), (Is(output.name, consequent),))
            for terms, consequent in system["rules"]
        )
    )


serve(Driver())
