"""Rule bases for commands: files in every format, `-` for standard input, remarks to standard error."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from fuzzy.formats import Imported
    from fuzzy.system import FuzzySystem

STANDARD = Path("-")
"""What stands for standard input or output."""

STDIN = "<stdin>"
"""How errors name standard input."""


def read(path: Path) -> Imported:
    """Read a rule base in any format, from standard input for `-`.

    Raises:
        FormatError: It cannot be read or is not valid, with line and column.
    """
    from fuzzy import formats

    if path != STANDARD:
        return formats.imported(path)
    return formats.from_bytes(sys.stdin.buffer.read(formats.MAX_BYTES + 1), STDIN)


def load(path: Path) -> FuzzySystem:
    """Read a rule base in any format and print what was left out or taken otherwise as warnings."""
    imported = read(path)
    name = STDIN if path == STANDARD else str(path)
    for remark in imported.remarks:
        print(f"{name}:{remark.line}:{remark.column}: warning: {remark.message}", file=sys.stderr)
    return imported.system


def refuse_two_from_standard_input(first: Path, second: Path) -> None:
    """Refuse two files of which both would be standard input.

    Raises:
        UsageError: Both are `-`.
    """
    from app.commands.failure import UsageError

    if first == second == STANDARD:
        raise UsageError("standard input can be one of the files only")
