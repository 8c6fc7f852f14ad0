"""A .fll file to the document, which evaluates as fuzzylite: midpoints, 1000 where the file does not say."""

from __future__ import annotations

import math
import re
from typing import Any

from fuzzy.errors import expected, shown
from fuzzy.formats.assembly import (
    Chosen,
    Imported,
    Notes,
    marked_resolution,
    rule_base,
    unique,
)
from fuzzy.formats.fll import words
from fuzzy.formats.fll.blocks import Block, blocks_of, is_true, named, numbers, split
from fuzzy.formats.rule_text import Dialect, ParsedRule, RuleReader, Token
from fuzzy.formats.source import Source, number
from fuzzy.limits import MAX_RULES
from fuzzy.system import WEIGHTED_VALUES, FuzzySystem, Inference, Input, NoFire, Output, Sampling, Term

_TOKEN = re.compile(r"[(),]|[^\s(),]+")
_RESOLUTION = 1000
_MAX_RULE = 20_000
_DIALECT = Dialect(words.HEDGES, has_chaining=True)


def read(text: str, name: str) -> Imported:
    """Read a file's text.

    Args:
        text: The .fll.
        name: Name of the file, for errors.

    Raises:
        FormatError: With line and column of the first mistake, what was found and what is valid.
    """
    source = Source(text, name)
    notes = Notes(source)
    blocks = blocks_of(notes)
    engine = blocks[0]
    found_inputs = named(source, blocks, "InputVariable")
    inputs = tuple(_input(notes, block) for block in found_inputs)
    aggregation = Chosen("aggregation", source)
    defuzzifier = Chosen("defuzzifier", source)
    sampling = Chosen("resolution", source)
    outputs = []
    for block in named(source, blocks, "OutputVariable"):
        outputs.append(_output(notes, block, len(inputs)))
        _operators_of_output(notes, block, aggregation, defuzzifier, sampling)
    parsed, operators = _rules(notes, blocks, inputs, outputs)
    rules = [entry.rule for entry in parsed]
    method = defuzzifier.get("centroid")
    is_weighted = method in WEIGHTED_VALUES
    resolution = marked_resolution(text, "exact" if is_weighted else sampling.get(Sampling(_RESOLUTION)))
    inference = Inference(
        operators["conjunction"].get("min"),
        operators["disjunction"].get("max"),
        "min" if is_weighted else operators["implication"].get("min"),
        aggregation.get("sum" if is_weighted else "max"),
        method,
        resolution,
    )
    rule_set = rule_base(inputs, outputs, rules)
    return notes.imported(FuzzySystem(engine.name or "engine", inputs, tuple(outputs), rule_set, inference))


def _variable(notes: Notes, block: Block, path: str, n_inputs: int) -> tuple[float, float, tuple[Term, ...]]:
    source = notes.source
    if not is_true(source, block, "enabled", otherwise=True):
        message = f"'{shown(block.name)}' is not enabled, which has no word in the workbench"
        raise source.error(message, block.values["enabled"].offset)
    notes.at(path, block.offset)
    if "range" not in block.values:
        raise source.error(f"'{shown(block.name)}' has no range", block.offset)
    place = block.values["range"].offset
    ends = numbers(source, split(source, block.values["range"]))
    if len(ends) != 2 or not all(map(math.isfinite, ends)):
        message = f"expected a range of two finite numbers, found '{shown(block.values['range'].text)}'"
        raise source.error(message, place)
    notes.at(f"{path}.range", place)
    return ends[0], ends[1], tuple(_terms(notes, block, path, n_inputs))


def _terms(notes: Notes, block: Block, path: str, n_inputs: int) -> list[Term]:
    source = notes.source
    terms: list[Term] = []
    for entry in block.entries:
        found = split(source, entry)
        if len(found) < 2:
            message = f"expected a name, a class and parameters, found '{shown(entry.text)}'"
            raise source.error(message, entry.offset)
        name, word = found[0].text, found[1]
        unique([term.name for term in terms], name, f"a term of {shown(block.name)} called", source, entry.offset)
        if word.text in words.REFUSED:
            raise source.error(f"the term '{word.text}' has no shape in the workbench", word.offset)
        shape, height = words.shape(source, word.text, numbers(source, found[2:]), word.offset, n_inputs)
        notes.at(f"{path}.terms.{name}", entry.offset)
        terms.append(Term(name, shape, height))
    return terms


def _input(notes: Notes, block: Block) -> Input:
    return Input(block.name, *_variable(notes, block, f"inputs.{block.name}", 0))


def _output(notes: Notes, block: Block, n_inputs: int) -> Output:
    source = notes.source
    low, high, terms = _variable(notes, block, f"outputs.{block.name}", n_inputs)
    no_fire = NoFire("nan")
    if "default" in block.values:
        text, offset = block.values["default"]
        value = number(text)
        if value is None:
            raise source.error(f"expected a number or nan, found '{shown(text)}'", offset)
        notes.at(f"outputs.{block.name}.no_fire", offset)
        no_fire = NoFire("nan") if math.isnan(value) else NoFire("default", value)
    if any(is_true(source, block, key, otherwise=False) for key in ("lock-previous", "lock-valid")):
        if no_fire.policy == "default":
            notes.remark(
                "the default counts only before the first output: the middle of the range is taken", block.offset
            )
        no_fire = NoFire("hold")
    return Output(block.name, low, high, terms, no_fire=no_fire)


def _word(source: Source, token: Token, valid: dict[str, str], what: str) -> str:
    if token.text not in valid:
        raise source.error(f"unknown {what} {expected(shown(token.text), valid)}", token.offset)
    return valid[token.text]


def _operators_of_output(
    notes: Notes, block: Block, aggregation: Chosen, defuzzifier: Chosen, sampling: Chosen
) -> None:
    source = notes.source
    token = block.values.get("aggregation", block.values.get("accumulation"))
    if token is not None and token.text != "none":
        value = _word(source, token, words.AGGREGATIONS, "aggregation")
        aggregation.choose(value, f"'{block.name}'", token.offset)
    token = block.values.get("defuzzifier")
    if token is None or token.text in ("", "none"):
        raise source.error(f"'{shown(block.name)}' has no defuzzifier", token.offset if token else block.offset)
    found = split(source, token)
    method = _word(source, found[0], words.DEFUZZIFIERS, "defuzzifier")
    if method in WEIGHTED_VALUES and is_true(source, block, "lock-range", otherwise=False):
        notes.remark("a weighted average is not limited to the range (lock-range)", block.values["lock-range"].offset)
    defuzzifier.choose(method, f"'{block.name}'", token.offset)
    if len(found) == 1 or method in WEIGHTED_VALUES:
        sampling.choose(Sampling(_RESOLUTION), f"'{block.name}'", token.offset)
        return
    points = number(found[1].text)
    if points is None or not points.is_integer() or not 1 < points <= 100_000:
        raise source.error(f"expected a resolution of 2 to 100000, found '{shown(found[1].text)}'", found[1].offset)
    sampling.choose(Sampling(int(points)), f"'{block.name}'", found[1].offset)


def _rules(
    notes: Notes, blocks: list[Block], inputs: tuple[Input, ...], outputs: list[Output]
) -> tuple[list[ParsedRule], dict[str, Chosen]]:
    source = notes.source
    operators = {key: Chosen(key, source) for key in ("conjunction", "disjunction", "implication")}
    reader = RuleReader(source, inputs, outputs, _DIALECT, is_folded=False)
    parsed: list[ParsedRule] = []
    for block in (block for block in blocks if block.word == "RuleBlock"):
        if not is_true(source, block, "enabled", otherwise=True):
            notes.remark(f"the rule block '{shown(block.name)}' is not enabled and left out", block.offset)
            continue
        _check_activation(source, block)
        found = []
        for entry in block.entries:
            if len(entry.text) > _MAX_RULE:
                raise source.error(f"a rule of {len(entry.text)} characters: at most {_MAX_RULE}", entry.offset)
            tokens = [Token(match.group(), entry.offset + match.start()) for match in _TOKEN.finditer(entry.text)]
            notes.at(f"rules.list[{len(parsed) + len(found)}]", entry.offset)
            found.append(reader.read(tokens, entry.offset + len(entry.text)))
        if len(parsed) + len(found) > MAX_RULES:
            raise source.error(f"more than {MAX_RULES} rules", block.offset)
        _operators_of_rules(source, block, found, operators)
        parsed += found
    return parsed, operators


def _check_activation(source: Source, block: Block) -> None:
    """Refuse activation methods but the general one; in fuzzylite 5 the word was the implication's."""
    token = block.values.get("activation")
    if token is None or token.text in ("General", "none", ""):
        return
    if token.text in words.CONJUNCTIONS and "implication" not in block.values:
        block.values["implication"] = token
        return
    raise source.error(
        f"the activation '{shown(token.text)}' has no word in the workbench; valid: General", token.offset
    )


def _operators_of_rules(source: Source, block: Block, rules: list[ParsedRule], operators: dict[str, Chosen]) -> None:
    """Take the operators of a rule block that its rules use."""
    tables: dict[str, dict[str, Any]] = {
        "conjunction": words.CONJUNCTIONS,
        "disjunction": words.DISJUNCTIONS,
        "implication": words.CONJUNCTIONS,
    }
    is_used = {
        "conjunction": any(rule.uses_and for rule in rules),
        "disjunction": any(rule.uses_or for rule in rules),
        "implication": bool(rules),
    }
    for key, table in tables.items():
        token = block.values.get(key)
        if token is None or token.text == "none":
            if is_used[key] and key != "implication":
                message = f"the rule block '{shown(block.name)}' uses {key[:3]} rules but has no {key}"
                raise source.error(message, token.offset if token else block.offset)
            continue
        value = _word(source, token, table, key)
        if is_used[key]:
            operators[key].choose(value, f"the rule block '{block.name}'", token.offset)
        else:
            operators[key].suggest(value)
