"""How a command ends when what the user gave cannot be used."""

from __future__ import annotations

from pathlib import Path


class CommandError(Exception):
    """A command that cannot go on; the text is the whole line for standard error."""


class UsageError(Exception):
    """A command line that says what the command cannot do; the text is the sentence for standard error."""


def failure(message: str, file: Path | str | None = None, line: int = 0, column: int = 0) -> CommandError:
    """Return the error ``file:line:column: error: message``; without a file, the program's name stands for it.

    Line and column count from 1; 0 where it is about the file as a whole.
    """
    place = f"{file}:{line}:{column}" if file is not None else "fuzzy-workbench"
    return CommandError(f"{place}: error: {message}")


def describe(error: Exception) -> str | None:
    """Return the line for standard error that says what a user's mistake was; None for a mistake of the program."""
    from fuzzy.errors import FormatError, FuzzyError

    match error:
        case CommandError() | FormatError():
            return str(error)
        case OSError(filename=str() as name, strerror=str() as reason):
            return f"{name}:0:0: error: {reason}"
        case FuzzyError() | OSError():
            return f"fuzzy-workbench: error: {error}"
        case _:
            return None
