"""An .fcl file to the document, which evaluates as the engine whose dialect it is written in.

jFuzzyLogic takes 1000 left ends of intervals over the range, or over the span of the terms where there is none, and
reads AND and OR from left to right; files of the standard are taken likewise, but AND binds tighter. fuzzylite, which
names itself in the first line or by its terms, takes 1000 midpoints.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

from fuzzy.errors import expected, shown
from fuzzy.formats.assembly import Chosen, Imported, Notes, marked_resolution, rule_base
from fuzzy.formats.fcl import words
from fuzzy.formats.fcl.blocks import Declared, FunctionBlock, RuleBlock, read_function_block
from fuzzy.formats.fcl.terms import span
from fuzzy.formats.fcl.tokens import Cursor, tokenize
from fuzzy.formats.fll import words as fuzzylite
from fuzzy.formats.rule_text import Dialect, ParsedRule, RuleReader, Token
from fuzzy.formats.source import Source
from fuzzy.limits import MAX_RULES
from fuzzy.shapes import Linear, Singleton
from fuzzy.system import WEIGHTED_VALUES, FuzzySystem, Inference, Input, NoFire, Output, Sampling

_FUZZYLITE = re.compile(r"\s*(?://|#|\(\*|/\*).{0,80}fuzzylite", re.IGNORECASE)
_DIALECTS = {
    "fuzzylite": Dialect(fuzzylite.HEDGES, has_chaining=True),
    "jFuzzyLogic": Dialect(is_flat=True),
    "IEC 61131-7": Dialect(),
}
_LIMITED_SUM = ("fuzzylite", "jFuzzyLogic")
"""Dialects whose NSUM is (a + b) / max(1, a + b) of two degrees: the bounded sum."""


def read(text: str, name: str) -> Imported:
    """Read a file's text.

    Args:
        text: The .fcl.
        name: Name of the file, for errors.

    Raises:
        FormatError: With line and column of the first mistake, what was found and what is valid.
    """
    source = Source(text, name)
    notes = Notes(source)
    found = tokenize(source)
    cursor = Cursor(source, found.tokens)
    if not cursor.text:
        raise source.error("the file is empty; expected FUNCTION_BLOCK", 0)
    block = read_function_block(cursor, notes)
    if _FUZZYLITE.match(text):
        block.dialects.add("fuzzylite")
    if found.has_c_comments:
        block.dialects.add("jFuzzyLogic")
    dialect = next((entry for entry in ("fuzzylite", "jFuzzyLogic") if entry in block.dialects), "IEC 61131-7")
    inputs = tuple(_input(notes, entry) for entry in block.variables.values() if entry.is_input)
    outputs = [_output(notes, entry) for entry in block.variables.values() if not entry.is_input]
    for kind, variables in (("VAR_INPUT", inputs), ("VAR_OUTPUT", outputs)):
        if not variables:
            raise source.error(f"the file declares no variable in {kind}", len(text))
    parsed = _rules(notes, block, inputs, outputs, _DIALECTS[dialect])
    rules = [entry.rule for entry in parsed]
    inference = _inference(source, block, dialect, text)
    if inference.defuzzifier in WEIGHTED_VALUES:
        _check_terms(source, block)
    rule_set = rule_base(inputs, outputs, rules)
    return notes.imported(FuzzySystem(block.name or "function_block", inputs, tuple(outputs), rule_set, inference))


def _ends(notes: Notes, entry: Declared, path: str) -> tuple[float, float]:
    name = entry.name
    notes.at(path, entry.name.offset)
    for term, offset in zip(entry.terms, entry.term_offsets, strict=True):
        notes.at(f"{path}.terms.{term.name}", offset)
    if not entry.terms:
        raise notes.source.error(
            f"'{shown(name.text)}' has no terms", entry.block.offset if entry.block else name.offset
        )
    if entry.ends is not None:
        notes.at(f"{path}.range", entry.range_offset)
        return entry.ends
    spans = [span(term.shape) for term in entry.terms]
    low, high = min(end[0] for end in spans), max(end[1] for end in spans)
    notes.remark(f"'{shown(name.text)}' has no RANGE: it is the span of the terms, {low:g} to {high:g}", name.offset)
    return low, high


def _input(notes: Notes, entry: Declared) -> Input:
    low, high = _ends(notes, entry, f"inputs.{entry.name.text}")
    return Input(entry.name.text, low, high, tuple(entry.terms))


def _output(notes: Notes, entry: Declared) -> Output:
    path = f"outputs.{entry.name.text}"
    low, high = _ends(notes, entry, path)
    if entry.no_fire_offset:
        notes.at(f"{path}.no_fire", entry.no_fire_offset)
    return Output(entry.name.text, low, high, tuple(entry.terms), no_fire=entry.no_fire or NoFire("nan"))


def _check_terms(source: Source, block: FunctionBlock) -> None:
    """Refuse sets that have no crisp value for a weighted average."""
    for entry in block.variables.values():
        if entry.is_input:
            continue
        for term in entry.terms:
            if not isinstance(term.shape, Singleton | Linear):
                offset = entry.method.offset if entry.method else entry.name.offset
                raise source.error(
                    f"the term '{term.name}' of '{entry.name.text}' is no singleton, as COGS needs", offset
                )


def _rules(
    notes: Notes, block: FunctionBlock, inputs: tuple[Input, ...], outputs: list[Output], dialect: Dialect
) -> list[ParsedRule]:
    """Return the rules of all blocks, in order."""
    source = notes.source
    reader = RuleReader(source, inputs, outputs, dialect, is_folded=True)
    parsed: list[ParsedRule] = []
    for rules in block.rule_blocks:
        for tokens, end in rules.rules:
            notes.at(f"rules.list[{len(parsed)}]", tokens[0].offset if tokens else end)
            parsed.append(reader.read(tokens, end))
            if len(parsed) > MAX_RULES:
                raise source.error(f"more than {MAX_RULES} rules", end)
    return parsed


def _word(source: Source, token: Token, valid: Mapping[str, str], what: str) -> str:
    if token.text.upper() not in valid:
        raise source.error(f"{what}: unknown operator {expected(shown(token.text), valid)}", token.offset)
    return valid[token.text.upper()]


def _inference(source: Source, block: FunctionBlock, dialect: str, text: str) -> Inference:
    accumulations = words.ACCUMULATIONS
    if dialect in _LIMITED_SUM:
        accumulations = accumulations | {"NSUM": "bounded_sum"}
    method, accumulation = Chosen("method", source), Chosen("accumulation", source)
    for entry in block.variables.values():
        if entry.is_input:
            continue
        if entry.method is None:
            raise source.error(f"'{shown(entry.name.text)}' has no METHOD", entry.name.offset)
        value = _word(source, entry.method, words.METHODS, "METHOD")
        method.choose(value, f"'{entry.name.text}'", entry.method.offset)
        if entry.accumulation is not None:
            value = _word(source, entry.accumulation, accumulations, "ACCU")
            accumulation.choose(value, f"'{entry.name.text}'", entry.accumulation.offset)
    chosen = {"AND": Chosen("AND", source), "OR": Chosen("OR", source), "ACT": Chosen("ACT", source)}
    tables = {"AND": words.CONJUNCTIONS, "OR": words.DISJUNCTIONS, "ACT": words.ACTIVATIONS}
    for rules in block.rule_blocks:
        where = f"the rule block '{rules.name}'"
        for key, table in tables.items():
            if key in rules.operators:
                chosen[key].choose(_word(source, rules.operators[key], table, key), where, rules.operators[key].offset)
        if "ACCU" in rules.operators:
            token = rules.operators["ACCU"]
            accumulation.choose(_word(source, token, accumulations, "ACCU"), where, token.offset)
        _check_enabled(source, rules)
    conjunction, disjunction = _dual(chosen["AND"].value, chosen["OR"].value)
    defuzzifier: Any = method.get("centroid")
    if defuzzifier in WEIGHTED_VALUES:
        joined = accumulation.get("sum" if dialect == "fuzzylite" else "max")
        return Inference(conjunction, disjunction, "min", joined, defuzzifier, marked_resolution(text, "exact"))
    sampling = Sampling(1000, "midpoints" if dialect == "fuzzylite" else "left")
    return Inference(
        conjunction,
        disjunction,
        chosen["ACT"].get("min"),
        accumulation.get("max"),
        defuzzifier,
        marked_resolution(text, sampling),
    )


def _check_enabled(source: Source, rules: RuleBlock) -> None:
    token = rules.operators.get("ENABLED")
    if token is not None and token.text.upper() == "FALSE":
        raise source.error("a rule block that is not enabled cannot be said in the workbench", token.offset)


def _dual(conjunction: Any, disjunction: Any) -> tuple[Any, Any]:
    """Return AND and OR; where a file names one of them, the other is its dual."""
    conjunctions = {value: key for key, value in words.DUALS.items()}
    if conjunction is None:
        conjunction = conjunctions[disjunction] if disjunction is not None else "min"
    return conjunction, words.DUALS[conjunction] if disjunction is None else disjunction
