"""A finding: what a designer should know about a place of a system."""

from __future__ import annotations

from typing import Literal

import msgspec

Level = Literal["error", "warning", "hint"]


class Finding(msgspec.Struct, frozen=True):
    """Something that a designer should look at.

    Attributes:
        level: ``error`` cannot be used, ``warning`` acts otherwise than it looks, ``hint`` may well be meant.
        message: One sentence.
        path: Place in the document, such as ``inputs.e.terms.NB``.
        cells: Row and column numbers of the rule table's cells that it is about.
        line: Line in the file, counted from 1; 0 before :func:`locate`.
        column: Column in the file, counted from 1; 0 before :func:`locate`.
    """

    level: Level
    message: str
    path: str = ""
    cells: tuple[tuple[int, int], ...] = ()
    line: int = 0
    column: int = 0
