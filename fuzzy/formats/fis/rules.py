"""The rules of a .fis file: ``2 -1.2, 3 0 (0.5) : 1``."""

from __future__ import annotations

import itertools
import re
from collections.abc import Sequence
from typing import Any, TypeVar

from fuzzy.errors import shown
from fuzzy.formats.fis.sections import Line
from fuzzy.formats.source import Source, number
from fuzzy.system import And, Expression, Hedged, Input, Is, Not, Or, Output, Rule, Variable

_MOST_CODES = 100
_RULE = re.compile(r"(?P<inputs>[^,()]*),(?P<outputs>[^,()]*)\((?P<weight>[^()]*)\)\s*:\s*(?P<connection>\S+)\s*")
_WORD = re.compile(r"\S+")
_CODE = re.compile(r"(-?)(\d{1,6})(?:\.(\d*))?", re.ASCII)

Hedges = dict[str, tuple[Any, ...]]
_V = TypeVar("_V", bound=Variable)


def read_rules(
    source: Source, lines: Sequence[Line], inputs: Sequence[Input], outputs: Sequence[Output], hedges: Hedges
) -> tuple[list[Rule], list[Is]]:
    """Return the rules in their order, and the conclusions that are negated ("output is not X").

    A negated conclusion names the term "not X" in the rules, and the term itself in the list.

    Raises:
        FormatError: At the number that is wrong.
    """
    rules: list[Rule] = []
    negated: list[Is] = []
    for line in lines:
        match = _RULE.fullmatch(line.text)
        if match is None:
            example = "1 2, 1 (1) : 1"
            raise source.error(f"expected a rule such as '{example}', found '{shown(line.text)}'", line.offset)
        rules.append(_rule(source, line, match, inputs, outputs, hedges, negated))
    return rules, negated


def _rule(
    source: Source,
    line: Line,
    match: re.Match[str],
    inputs: Sequence[Input],
    outputs: Sequence[Output],
    hedges: Hedges,
    negated: list[Is],
) -> Rule:
    antecedents = []
    for variable, code in _coded(source, line, match, "inputs", inputs):
        expression = _proposition(source, variable, code, hedges)
        if expression is not None:
            antecedents.append(expression)
    if not antecedents:
        raise source.error("the rule asks for no input, so it cannot be said in the workbench", line.offset)
    consequents = []
    for variable, code in _coded(source, line, match, "outputs", outputs):
        conclusion = _conclusion(source, variable, code, negated)
        if conclusion is not None:
            consequents.append(conclusion)
    if not consequents:
        raise source.error("the rule concludes on no output", line.offset)
    weight = number(match.group("weight").strip())
    if weight is None or not 0 <= weight <= 1:
        found = shown(match.group("weight").strip())
        raise source.error(f"expected a weight from 0 to 1, found '{found}'", line.offset + match.start("weight"))
    connection = number(match.group("connection"))
    if connection not in (1, 2):
        place = line.offset + match.start("connection")
        raise source.error(f"expected 1 (and) or 2 (or), found '{shown(match.group('connection'))}'", place)
    join = And if connection == 1 else Or
    antecedent = antecedents[0] if len(antecedents) == 1 else join(tuple(antecedents))
    return Rule(antecedent, tuple(consequents), weight)


def _coded(
    source: Source, line: Line, match: re.Match[str], group: str, variables: Sequence[_V]
) -> list[tuple[_V, Line]]:
    """Return the code of every variable."""
    place = line.offset + match.start(group)
    found = itertools.islice(_WORD.finditer(match.group(group)), _MOST_CODES + 1)
    codes = [Line(word.group(), place + word.start()) for word in found]
    if len(codes) != len(variables):
        count = f"more than {_MOST_CODES}" if len(codes) > _MOST_CODES else str(len(codes))
        raise source.error(f"{count} terms for the {len(variables)} {group}", place)
    return list(zip(variables, codes, strict=True))


def _parts(source: Source, variable: Variable, code: Line) -> tuple[bool, int, str]:
    """Return whether a code negates, the term's number, and the digits of its hedge."""
    match = _CODE.fullmatch(code.text)
    if match is None:
        raise source.error(f"expected a term's number, found '{shown(code.text)}'", code.offset)
    place = int(match.group(2))
    if place > len(variable.terms):
        valid = f"0 to {len(variable.terms)}"
        raise source.error(f"'{variable.name}' has no term {place}; valid: {valid}", code.offset)
    return bool(match.group(1)), place, (match.group(3) or "").rstrip("0")


def _proposition(source: Source, variable: Input, code: Line, hedges: Hedges) -> Expression | None:
    is_negated, place, digits = _parts(source, variable, code)
    if digits and digits not in hedges:
        valid = ", ".join(f".{key}" for key in hedges)
        raise source.error(f"unknown hedge '.{shown(digits)}'; valid: {valid}", code.offset)
    if place == 0:
        if digits or is_negated:
            raise source.error(f"'{shown(code.text)}' is a hedge on no term", code.offset)
        return None
    expression: Expression = Is(variable.name, variable.terms[place - 1].name)
    for hedge in hedges[digits] if digits else ():
        expression = Hedged(expression, hedge)
    return Not(expression) if is_negated else expression


def _conclusion(source: Source, variable: Output, code: Line, negated: list[Is]) -> Is | None:
    is_negated, place, digits = _parts(source, variable, code)
    if digits:
        raise source.error("a hedge in a conclusion has no word in the workbench", code.offset)
    if place == 0:
        return None
    term = variable.terms[place - 1].name
    if not is_negated:
        return Is(variable.name, term)
    negated.append(Is(variable.name, term))
    return Is(variable.name, f"not {term}")
