"""Errors that say what was found, where, and what is valid."""

from __future__ import annotations

import difflib
import itertools
from collections.abc import Iterable

_MAX_SHOWN = 40
"""Characters of a text that a message quotes."""


class FuzzyError(ValueError):
    """A fuzzy system, a file or an input that cannot be used.

    Attributes:
        message: What was found and what is valid, one sentence, without its place.
        path: Place in the document, such as ``inputs.e.terms.NB``; empty where there is none.
    """

    def __init__(self, message: str, path: str = "") -> None:
        super().__init__(f"{path}: {message}" if path else message)
        self.message = message
        self.path = path


class InvalidSystemError(FuzzyError):
    """A document that breaks a rule of the schema or of fuzzy inference."""


class InvalidInputError(FuzzyError, ArithmeticError):
    """A crisp input that is not finite, or out of a range that rejects it."""


class FormatError(FuzzyError):
    """A file that cannot be read.

    Attributes:
        source: Name of the file.
        line: Line, counted from 1; 0 where the file has no lines.
        column: Column, counted from 1.
    """

    def __init__(self, message: str, source: str, line: int = 0, column: int = 0, path: str = "") -> None:
        super().__init__(message, path)
        self.source = source
        self.line = line
        self.column = column

    def __str__(self) -> str:
        """Return ``file:line:col: error: path: message``, as compilers write it."""
        place = f"{self.path}: " if self.path else ""
        return f"{self.source}:{self.line}:{self.column}: error: {place}{self.message}"


def expected(found: object, valid: Iterable[str]) -> str:
    """Return "'FOUND'; did you mean 'X'? valid are ..." for an unknown name."""
    names = list(valid)
    folded = {name.casefold(): name for name in names}
    close = difflib.get_close_matches(str(found).casefold(), folded, n=1)
    hint = f"did you mean '{folded[close[0]]}'? " if close else ""
    return f"'{found}'; {hint}valid: {', '.join(names) or 'none'}"


def shown(text: str) -> str:
    """Return a text as errors show it: not too long, on one line."""
    visible = "".join(letter if letter.isprintable() else "?" for letter in itertools.islice(text, _MAX_SHOWN))
    return visible if len(text) <= _MAX_SHOWN else f"{visible}…"
