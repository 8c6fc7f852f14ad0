"""A file's text with places in it: bytes to text, offsets to lines and columns, texts to numbers.

Shared by the readers of other engines' formats; YAML has a tree of its own (:mod:`fuzzy.formats.yaml_tree`).
"""

from __future__ import annotations

import bisect
import functools
import math
import re
from collections.abc import Iterator

from fuzzy.errors import FormatError

MAX_LINES = 100_000
"""Greatest number of lines."""

MAX_NUMBER = 64
"""Greatest length of a number's text."""

_NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eEdD][-+]?\d+)?", re.ASCII)
_NOT_FINITE = {"inf": math.inf, "+inf": math.inf, "-inf": -math.inf, "nan": math.nan, "-nan": math.nan}
_LINE_END = re.compile(r"\r\n|\r|\n")
_CONTROL = re.compile("[\x00-\x08\x0e-\x1f\x7f]")
_BYTE_ORDER_MARKS = {b"\xef\xbb\xbf": "utf-8-sig", b"\xff\xfe": "utf-16", b"\xfe\xff": "utf-16"}


class Source:
    """A file's text.

    Attributes:
        text: The content.
        name: Name of the file, for errors.
    """

    def __init__(self, text: str, name: str) -> None:
        self.text = text
        self.name = name

    @functools.cached_property
    def _starts(self) -> list[int]:
        return [0, *(match.end() for match in _LINE_END.finditer(self.text))]

    def place(self, offset: int) -> tuple[int, int]:
        """Return line and column of an offset, counted from 1."""
        line = bisect.bisect_right(self._starts, offset)
        return line, offset - self._starts[line - 1] + 1

    def error(self, message: str, offset: int, path: str = "") -> FormatError:
        """Return an error at an offset."""
        return FormatError(message, self.name, *self.place(offset), path)

    def lines(self) -> Iterator[tuple[int, str]]:
        """Yield every line with the offset of its first character, without its end.

        Raises:
            FormatError: There are more than ``MAX_LINES``.
        """
        start = 0
        for number, end in enumerate(_LINE_END.finditer(self.text), 1):
            yield start, self.text[start : end.start()]
            start = end.end()
            if number >= MAX_LINES:
                raise self.error(f"more than {MAX_LINES} lines", start)
        yield start, self.text[start:]


def decode(content: bytes, name: str) -> str:
    """Return the text of a file that says its encoding by a byte order mark, or is UTF-8, or else Latin-1.

    Raises:
        FormatError: The bytes are no text.
    """
    encoding = next((value for mark, value in _BYTE_ORDER_MARKS.items() if content.startswith(mark)), "utf-8")
    try:
        text = content.decode(encoding)
    except UnicodeDecodeError:
        text = content.decode("latin-1")
    control = _CONTROL.search(text)
    if control is not None:
        source = Source(text, name)
        raise source.error(f"this is no text: it holds the character {control.group()!r}", control.start())
    return text


def number(text: str) -> float | None:
    """Return the number that a text is, infinities and NaN by name; None where it is none.

    A number beyond the greatest float is infinite, which whoever needs a finite one refuses.
    """
    if len(text) > MAX_NUMBER:
        return None
    if _NUMBER.fullmatch(text):
        return float(text.replace("d", "e").replace("D", "e"))
    return _NOT_FINITE.get(text.lower())
