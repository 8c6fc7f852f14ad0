"""The words of an .fcl file without its comments, and a cursor over them."""

from __future__ import annotations

import re
from typing import NamedTuple

from fuzzy.errors import FormatError, shown
from fuzzy.formats.rule_text import Token
from fuzzy.formats.source import Source, number

_TOKEN = re.compile(
    r"(?P<blank>\s+)"
    r"|(?P<standard>\(\*.*?\*\))"
    r"|(?P<comment>//[^\n]*|/\*.*?\*/|\#[^\n]*)"
    r"|(?P<open>\(\*|/\*)"
    r"|(?P<number>[-+]?(?:\d+(?:\.(?!\.)\d*)?|\.\d+)(?:[eE][-+]?\d+)?(?![\w]))"
    r"|(?P<word>[^\W\d][\w]*|[-+]inf\b)"
    r"|(?P<mark>:=|\.\.|[():;,|*/^%+-])"
    r"|(?P<other>.)",
    re.DOTALL,
)
MAX_TOKENS = 100_000
"""Greatest number of words: 4096 rules of two dozen words each."""


class Words(NamedTuple):
    """The words of a file, and whether it has comments that the standard does not know."""

    tokens: list[Token]
    has_c_comments: bool


def tokenize(source: Source) -> Words:
    """Return the words of a file.

    Raises:
        FormatError: At a comment that does not end, or a character that begins no word.
    """
    tokens: list[Token] = []
    has_c_comments = False
    for match in _TOKEN.finditer(source.text):
        kind, offset = match.lastgroup, match.start()
        if kind in ("blank", "standard"):
            continue
        if kind == "comment":
            has_c_comments = True
            continue
        if kind == "open":
            raise source.error("this comment does not end", offset)
        if kind == "other":
            raise source.error(f"unexpected character '{shown(match.group())}'", offset)
        tokens.append(Token(match.group(), offset))
        if len(tokens) > MAX_TOKENS:
            raise source.error(f"more than {MAX_TOKENS} words", offset)
    return Words(tokens, has_c_comments)


class Cursor:
    """The words of a file, one after the other; keywords may be in any case."""

    def __init__(self, source: Source, tokens: list[Token]) -> None:
        self.source = source
        self._tokens = tokens
        self._next = 0

    @property
    def text(self) -> str:
        """The current word; empty at the end of the file."""
        return self._tokens[self._next].text if self._next < len(self._tokens) else ""

    @property
    def word(self) -> str:
        """The current word in capitals."""
        return self.text.upper()

    @property
    def offset(self) -> int:
        """Where the current word begins."""
        return self._tokens[self._next].offset if self._next < len(self._tokens) else len(self.source.text)

    def take(self) -> Token:
        """Return the current word and step to the next."""
        token = Token(self.text, self.offset)
        self._next += 1
        return token

    def accept(self, word: str) -> bool:
        """Step over a word where it comes next."""
        if self.word != word:
            return False
        self._next += 1
        return True

    def require(self, word: str) -> None:
        """Step over a word, which must come next."""
        if not self.accept(word):
            raise self.unexpected(f"'{word}'")

    def unexpected(self, valid: str) -> FormatError:
        """Return an error that says what was found and what would be valid."""
        found = f"'{shown(self.text)}'" if self.text else "the end of the file"
        return self.source.error(f"expected {valid}, found {found}", self.offset)

    def name(self, what: str) -> Token:
        """Return a name and step over it."""
        if not self.text or not (self.text[0].isalpha() or self.text[0] == "_"):
            raise self.unexpected(what)
        return self.take()

    def number(self, *, may_be_nan: bool = False) -> float:
        """Return a number and step over it."""
        value = number(self.text)
        if value is None or (value != value and not may_be_nan):
            if self.text[:1].isalpha():
                message = (
                    f"expected a number, found the name '{shown(self.text)}': variables inside membership functions"
                )
                raise self.source.error(f"{message} cannot be said in the workbench", self.offset)
            raise self.unexpected("a number")
        self._next += 1
        return value

    def end(self) -> None:
        """Step over a semicolon, which must come next."""
        self.require(";")
