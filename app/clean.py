"""Values that can be used as they are: each function returns one, or raises :class:`Refused` with a sentence.

:mod:`app.door` holds every message against what its widget declares. Callbacks use these functions for what a widget
cannot declare: names, names of files, what fits the document. ``what`` names the value in the message. Meant to be
called as ``clean.number(event.target.value, 0, 1, "the weight")``.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable

from fuzzy.errors import expected, shown
from fuzzy.formats import READABLE

MAX_NAME = 64
"""Longest name of a variable, a term or a file, in characters."""

MAX_UPLOAD = 1 << 20
"""Most bytes of an uploaded file, and of all uploads in flight together."""


class Refused(ValueError):  # noqa: N818 - it is an answer to the browser, not a fault of the program
    """Something that a browser sent and that is not used; the message says what was found and what is valid."""


def number(value: object, low: float, high: float, what: str = "the value") -> float:
    """Return ``value`` as a float if it is a finite number in [``low``, ``high``]."""
    valid = f"valid is a number from {low:g} to {high:g}"
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise Refused(f"{what} is {_described(value)}; {valid}")
    try:
        converted = float(value)
    except OverflowError:
        converted = math.inf
    if not low <= converted <= high or not math.isfinite(converted):
        raise Refused(f"{what} is {converted:.12g}; {valid}")
    return converted


def choice(value: object, valid: Iterable[str], what: str = "the choice") -> str:
    """Return ``value`` if it is one of ``valid``."""
    names = list(valid)
    if isinstance(value, str) and value in names:
        return value
    raise Refused(f"{what} is {expected(shown(value) if isinstance(value, str) else _described(value), names)}")


def flag(value: object, what: str = "the switch") -> bool:
    """Return ``value`` if it is true or false."""
    if isinstance(value, bool):
        return value
    raise Refused(f"{what} is {_described(value)}; valid are true and false")


def name(value: object, what: str = "the name") -> str:
    """Return ``value`` without surrounding blanks if it can name a variable or a term."""
    cleaned = text(value, 4 * MAX_NAME, what).strip()
    if not cleaned:
        raise Refused(f"{what} is empty; valid are 1 to {MAX_NAME} printable characters")
    if len(cleaned) > MAX_NAME:
        raise Refused(f"{what} has {len(cleaned)} characters; valid are 1 to {MAX_NAME}")
    if not cleaned.isprintable():
        raise Refused(f"{what} is {_described(cleaned)}; control and other unprintable characters are not valid")
    return cleaned


def text(value: object, most: int, what: str = "the text") -> str:
    """Return ``value`` if it is text of at most ``most`` characters that can be written as UTF-8."""
    if not isinstance(value, str):
        raise Refused(f"{what} is {_described(value)}; valid is text")
    if len(value) > most:
        raise Refused(f"{what} has {len(value)} characters; valid are at most {most}")
    if any("\ud800" <= character <= "\udfff" for character in value):
        raise Refused(f"{what} holds half a character (a lone surrogate); valid is text that UTF-8 can hold")
    return value


def file_name(value: object, what: str = "the file name") -> str:
    """Return ``value`` if it is a plain name of a YAML file, without any folder."""
    plain = text(value, 4 * MAX_NAME, what)
    if re.fullmatch(rf"(?!\.)[A-Za-z0-9._-]{{1,{MAX_NAME}}}", plain) and plain.endswith(".yaml"):
        return plain
    raise Refused(
        f"{what} is {_described(plain)}; valid are at most {MAX_NAME} of the characters A-Z a-z 0-9 . _ - "
        "that end in .yaml and do not begin with a dot"
    )


def upload_name(value: object, what: str = "the file name") -> str:
    """Return ``value`` if it is a plain name, without any folder, of a kind of file that can be read."""
    plain = text(value, 4 * MAX_NAME, what)
    if re.fullmatch(rf"(?!\.)[^/\\:\x00-\x1f\x7f]{{1,{MAX_NAME}}}", plain) and plain.lower().endswith(READABLE):
        return plain
    raise Refused(
        f"{what} is {_described(plain)}; valid are at most {MAX_NAME} characters without / \\ : that end in "
        f"{' '.join(READABLE)} and do not begin with a dot"
    )


def upload(name: object, content: object) -> tuple[str, bytes]:
    """Return name and content of an uploaded file if both can be used."""
    plain = upload_name(name)
    if not isinstance(content, bytes):
        raise Refused(f"the content of {plain} is {_described(content)}; valid are bytes")
    if len(content) > MAX_UPLOAD:
        raise Refused(f"{plain} has {len(content)} bytes; valid are at most {MAX_UPLOAD}")
    return plain, content


def _described(value: object) -> str:
    """Return what a message says of a value; never the whole of something large."""
    if isinstance(value, str):
        return f"'{shown(value)}'"
    return repr(value) if isinstance(value, (bool, type(None), float)) else f"of type {type(value).__name__}"
