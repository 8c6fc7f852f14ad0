"""A .fll file as blocks of keys and values."""

from __future__ import annotations

import itertools
import re
from dataclasses import dataclass, field

from fuzzy.errors import expected, shown
from fuzzy.formats.assembly import Notes, unique
from fuzzy.formats.rule_text import Token
from fuzzy.formats.source import Source, number
from fuzzy.limits import MAX_OUTPUT_TERMS, MAX_RULES, MAX_VARIABLES
from fuzzy.shapes import MAX_POINTS

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
_MAX_WORDS = 2 * MAX_POINTS + 3
"""Name, class, points and height of a term."""


@dataclass
class Block:
    """A block of the file: its word, its name, its values by key, and its terms or rules."""

    word: str
    name: str
    offset: int
    values: dict[str, Token] = field(default_factory=dict)
    entries: list[Token] = field(default_factory=list)


def blocks_of(notes: Notes) -> list[Block]:
    """Return the blocks of a file, the engine first."""
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
        most = MAX_RULES if key.text == "rule" else MAX_OUTPUT_TERMS
        if len(block.entries) > most:
            raise source.error(f"more than {most} {key.text}s", key.offset)
        return
    if key.text not in _KEYS[block.word]:
        valid = [*_KEYS[block.word], *([_REPEATED[block.word]] if block.word in _REPEATED else [])]
        raise source.error(f"unknown key {expected(shown(key.text), valid)}", key.offset)
    if key.text in block.values:
        raise source.error(f"'{key.text}' stands twice", key.offset)
    block.values[key.text] = value


def named(source: Source, blocks: list[Block], word: str) -> list[Block]:
    """Return the blocks of one kind: at least one, each with a name of its own."""
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


def is_true(source: Source, block: Block, key: str, *, otherwise: bool) -> bool:
    """Return a switch of a block."""
    if key not in block.values:
        return otherwise
    text, offset = block.values[key]
    if text not in ("true", "false"):
        raise source.error(f"expected true or false, found '{shown(text)}'", offset)
    return text == "true"


def numbers(source: Source, found: list[Token]) -> list[float]:
    """Return the numbers that words are."""
    values = []
    for word in found:
        value = number(word.text)
        if value is None:
            raise source.error(f"expected a number, found '{shown(word.text)}'", word.offset)
        values.append(value)
    return values


def split(source: Source, token: Token) -> list[Token]:
    """Return the words of a value."""
    found = [
        Token(match.group(), token.offset + match.start())
        for match in itertools.islice(_WORD.finditer(token.text), _MAX_WORDS + 1)
    ]
    if len(found) > _MAX_WORDS:
        raise source.error(f"more than {_MAX_WORDS} words", found[-1].offset)
    return found
