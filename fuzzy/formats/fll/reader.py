"""A .fll file to the document, which evaluates as fuzzylite: midpoints, 1000 where the file does not say."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field
from typing import Any

from fuzzy.errors import expected
from fuzzy.formats.assembly import (
    Chosen,
    Imported,
    Notes,
    marked_resolution,
    rule_base,
    unique,
)
from fuzzy.formats.fll import words
from fuzzy.formats.rule_text import Dialect, ParsedRule, RuleReader, Token
from fuzzy.formats.source import Source, number, shown
from fuzzy.system import WEIGHTED_VALUES, FuzzySystem, Inference, Input, NoFire, Output, Sampling, Term
from fuzzy.validation import MAX_RULES, MAX_TERMS, MAX_VARIABLES

_BLOCKS = ("Engine", "InputVariable", "OutputVariable", "RuleBlock")
_KEYS = {
    "Engine": ("description",),
    "InputVariable": ("description", "enabled", "range", "lock-range"),
    "OutputVariable": (
        *("description", "enabled", "range", "lock-range", "aggregation", "accumulation", "defuzzifier", "default"),
        *("lock-previous", "lock-valid"),
    ),
    "RuleBlock": ("description", "enabled", "conjunction", "disjunction", "implication", "activation"),
}
_REPEATED = {"InputVariable": "term", "OutputVariable": "term", "RuleBlock": "rule"}
_LINE = re.compile(r"([A-Za-z-]+)\s*:\s*(.*)")
_WORD = re.compile(r"\S+")
_TOKEN = re.compile(r"[(),]|[^\s(),]+")
_RESOLUTION = 1000
_MAX_RULE = 20_000
_DIALECT = Dialect(words.HEDGES, has_chaining=True)


@dataclass
class Block:
    """A block of the file: its word, its name, its values by key, and its terms or rules."""

    word: str
    name: str
    offset: int
    values: dict[str, Token] = field(default_factory=dict)
    entries: list[Token] = field(default_factory=list)


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
    blocks = _blocks(notes)
    engine = blocks[0]
    found_inputs = _of(source, blocks, "InputVariable")
    inputs = tuple(_input(notes, block) for block in found_inputs)
    aggregation = Chosen("aggregation", source)
    defuzzifier = Chosen("defuzzifier", source)
    sampling = Chosen("resolution", source)
    outputs = []
    for block in _of(source, blocks, "OutputVariable"):
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


def _blocks(notes: Notes) -> list[Block]:
    source = notes.source
    blocks: list[Block] = []
    for start, line in source.lines():
        text = line.partition("#")[0].strip()
        if not text:
            continue
        offset = start + line.index(text)
        match = _LINE.fullmatch(text)
        if match is None:
            raise source.error(f"expected 'key: value', found '{shown(text)}'", offset)
        key, value = match.groups()
        place = offset + match.start(2)
        if key in _BLOCKS:
            if (key == "Engine") != (not blocks):
                raise source.error(f"expected 'Engine:' first and once, found '{key}:'", offset)
            blocks.append(Block(key, value, place))
            if len(blocks) > 3 * MAX_VARIABLES + 1:
                raise source.error(f"more than {3 * MAX_VARIABLES} blocks", offset)
        elif not blocks:
            raise source.error(f"expected 'Engine:' first, found '{shown(key)}:'", offset)
        else:
            _add(notes, blocks[-1], Token(key, offset), Token(value, place))
    if not blocks:
        raise source.error("the file is empty; expected 'Engine:'", 0)
    return blocks


def _add(notes: Notes, block: Block, key: Token, value: Token) -> None:
    source = notes.source
    if key.text == _REPEATED.get(block.word):
        block.entries.append(value)
        most = MAX_RULES if key.text == "rule" else MAX_TERMS
        if len(block.entries) > most:
            raise source.error(f"more than {most} {key.text}s", key.offset)
        return
    if key.text not in _KEYS[block.word]:
        valid = [*_KEYS[block.word], *([_REPEATED[block.word]] if block.word in _REPEATED else [])]
        raise source.error(f"unknown key {expected(shown(key.text), valid)}", key.offset)
    if key.text in block.values:
        raise source.error(f"'{key.text}' stands twice", key.offset)
    block.values[key.text] = value


def _of(source: Source, blocks: list[Block], word: str) -> list[Block]:
    found = [block for block in blocks if block.word == word]
    if not found:
        raise source.error(f"'{word}:' is missing: the file ends too early", len(source.text))
    names: set[str] = set()
    for block in found:
        if not block.name:
            raise source.error(f"'{word}:' has no name", block.offset)
        unique(names, block.name, "a variable called", source, block.offset)
        names.add(block.name)
    if len(found) > MAX_VARIABLES:
        raise source.error(f"more than {MAX_VARIABLES} of '{word}:'", found[MAX_VARIABLES].offset)
    return found


def _is(source: Source, block: Block, key: str, *, otherwise: bool) -> bool:
    if key not in block.values:
        return otherwise
    text, offset = block.values[key]
    if text not in ("true", "false"):
        raise source.error(f"expected true or false, found '{shown(text)}'", offset)
    return text == "true"


def _numbers(source: Source, found: list[Token]) -> list[float]:
    values = []
    for word in found:
        value = number(word.text)
        if value is None:
            raise source.error(f"expected a number, found '{shown(word.text)}'", word.offset)
        values.append(value)
    return values


def _split(token: Token) -> list[Token]:
    return [Token(match.group(), token.offset + match.start()) for match in _WORD.finditer(token.text)]


def _variable(notes: Notes, block: Block, path: str, n_inputs: int) -> tuple[float, float, tuple[Term, ...]]:
    source = notes.source
    if not _is(source, block, "enabled", otherwise=True):
        message = f"'{shown(block.name)}' is not enabled, which has no word in the workbench"
        raise source.error(message, block.values["enabled"].offset)
    notes.at(path, block.offset)
    if "range" not in block.values:
        raise source.error(f"'{shown(block.name)}' has no range", block.offset)
    place = block.values["range"].offset
    ends = _numbers(source, _split(block.values["range"]))
    if len(ends) != 2 or not all(map(math.isfinite, ends)):
        message = f"expected a range of two finite numbers, found '{shown(block.values['range'].text)}'"
        raise source.error(message, place)
    notes.at(f"{path}.range", place)
    return ends[0], ends[1], tuple(_terms(notes, block, path, n_inputs))


def _terms(notes: Notes, block: Block, path: str, n_inputs: int) -> list[Term]:
    source = notes.source
    terms: list[Term] = []
    for entry in block.entries:
        found = _split(entry)
        if len(found) < 2:
            message = f"expected a name, a class and parameters, found '{shown(entry.text)}'"
            raise source.error(message, entry.offset)
        name, word = found[0].text, found[1]
        unique([term.name for term in terms], name, f"a term of {shown(block.name)} called", source, entry.offset)
        if word.text in words.REFUSED:
            raise source.error(f"the term '{word.text}' has no shape in the workbench", word.offset)
        shape, height = words.shape(source, word.text, _numbers(source, found[2:]), word.offset, n_inputs)
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
    if _is(source, block, "lock-previous", otherwise=False) or _is(source, block, "lock-valid", otherwise=False):
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
    if token is None or token.text == "none":
        raise source.error(f"'{shown(block.name)}' has no defuzzifier", token.offset if token else block.offset)
    found = _split(token)
    method = _word(source, found[0], words.DEFUZZIFIERS, "defuzzifier")
    if method in WEIGHTED_VALUES and _is(source, block, "lock-range", otherwise=False):
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
        if not _is(source, block, "enabled", otherwise=True):
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
