"""Which format a file is written in: its content says, and its suffix where the content does not."""

from __future__ import annotations

import re
from pathlib import PurePath
from typing import Literal, get_args

from fuzzy.errors import FormatError, expected

Format = Literal["yaml", "fis", "fll", "fcl", "fml"]

SUFFIXES: dict[str, Format] = {
    ".yaml": "yaml",
    ".yml": "yaml",
    ".fis": "fis",
    ".fll": "fll",
    ".fcl": "fcl",
    ".xml": "fml",
    ".fml": "fml",
}
"""The format of every suffix that can be read and written."""

FORMATS: tuple[Format, ...] = get_args(Format)

TITLES: dict[Format, str] = {
    "yaml": "the workbench's YAML",
    "fis": "MATLAB's or Octave's .fis",
    "fll": "fuzzylite's .fll",
    "fcl": "IEC 61131-7 .fcl",
    "fml": "IEEE 1855 FML .xml",
}

_HEAD = 64 * 1024
"""How much of a file is looked at."""

_SIGNS: dict[Format, re.Pattern[str]] = {
    "yaml": re.compile(r"""^["']?schema["']?\s*:""", re.M),
    "fml": re.compile(r"\A\s*<(?:\?xml|!--|!DOCTYPE|[\w:]*fuzzySystem)"),
    "fis": re.compile(r"^[ \t]*(?:\[(?:System|Interface)\]|Ninputs[ \t]*=)", re.M),
    "fll": re.compile(r"^[ \t]*(?:Engine|InputVariable|OutputVariable)[ \t]*:", re.M),
    "fcl": re.compile(r"^[ \t]*FUNCTION_BLOCK\b", re.M | re.I),
}


def detect(text: str, name: str) -> Format:
    """Return the format of a file.

    Args:
        text: The content.
        name: Name of the file; its suffix counts where the content does not tell.

    Raises:
        FormatError: Neither the content nor the suffix names a format.
    """
    suffix = PurePath(name).suffix.lower()
    stated = SUFFIXES.get(suffix)
    head = text[:_HEAD]
    if stated is not None and _SIGNS[stated].search(head):
        return stated
    for entry in FORMATS:
        if _SIGNS[entry].search(head):
            return entry
    if stated is not None:
        return stated
    if suffix:
        raise FormatError(f"unknown suffix {expected(suffix, SUFFIXES)}; the content is none of these", name)
    raise FormatError(f"the content is none of: {', '.join(TITLES.values())}", name)


def format_of(name: str) -> Format:
    """Return the format that a suffix names.

    Raises:
        FormatError: It names none.
    """
    suffix = PurePath(name).suffix.lower()
    if suffix not in SUFFIXES:
        raise FormatError(f"unknown suffix {expected(suffix, SUFFIXES)}", name)
    return SUFFIXES[suffix]
