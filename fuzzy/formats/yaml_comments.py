"""Comments in a rule base's YAML, which saving from the workbench would lose."""

from __future__ import annotations

import re

import yaml

_COMMENT = re.compile(r"(?:^|(?<=[ \t\n]))#[^\n]*")


def has_comments(text: str) -> bool:
    """Tell whether a file holds comments that are lost when the workbench saves it.

    The line of column names that the workbench itself writes above a table's cells does not count, nor does a text
    that is no YAML.
    """
    return bool(comments(text))


def comments(text: str) -> list[tuple[int, str]]:
    """Return line, counted from 1, and text of every comment that saving would lose."""
    scalars = _scalars(text)
    if scalars is None:
        return []
    lines = text.split("\n")
    found: list[tuple[int, str]] = []
    for match in _COMMENT.finditer(text):
        if any(start <= match.start() < end for start, end in scalars):
            continue
        line = text.count("\n", 0, match.start()) + 1
        is_own = (
            line > 1
            and lines[line - 2].partition("#")[0].strip() == "cells:"
            and lines[line - 1].strip().startswith("#")
        )
        if not is_own:
            found.append((line, match.group()))
    return found


def _scalars(text: str) -> list[tuple[int, int]] | None:
    """Return where texts and numbers stand, in which # begins no comment; None for what is no YAML."""
    try:
        tokens = list(yaml.scan(text, Loader=yaml.SafeLoader))
    except yaml.YAMLError:
        return None
    return [(token.start_mark.index, token.end_mark.index) for token in tokens if isinstance(token, yaml.ScalarToken)]
