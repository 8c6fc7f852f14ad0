"""``check``: findings on rule bases, as a compiler writes them."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import tyro

if TYPE_CHECKING:
    from collections.abc import Iterator


def check(
    files: tyro.conf.Positional[Annotated[tuple[Path, ...], tyro.conf.arg(metavar="FILE...", help_behavior_hint="")]],
    /,
    *,
    json: bool = False,
) -> int:
    """Look for mistakes and weak spots in rule bases.

    Prints one line file:line:column: error|warning: message for every finding. Exit code 1 when there are any.

    Args:
        files: The rule bases.
        json: Print the findings as JSON.
    """
    if not files:
        from app.commands.failure import UsageError

        raise UsageError("check needs at least one FILE")
    findings = [finding for file in files for finding in _findings(file)]
    if json:
        import msgspec

        print(msgspec.json.format(msgspec.json.encode({"files": len(files), "findings": findings})).decode())
    else:
        for found in findings:
            print("{file}:{line}:{column}: {severity}: {message}".format_map(found))
    return 1 if findings else 0


def _findings(file: Path) -> Iterator[dict[str, str | int]]:
    from fuzzy.check import check as examine

    from fuzzy.errors import FormatError
    from fuzzy.formats import load, positions
    from fuzzy.formats.yaml import nearest

    try:
        system = load(file)
        places = positions(file)
    except FormatError as error:
        message = f"{error.path}: {error.message}" if error.path else error.message
        yield _finding(file, (error.line or 1, error.column or 1), "error", message, error.path)
        return
    for found in examine(system):
        yield _finding(file, nearest(places, found.path), found.severity, found.message, found.path)


def _finding(file: Path, place: tuple[int, int], severity: str, message: str, path: str) -> dict[str, str | int]:
    return {
        "file": str(file),
        "line": place[0],
        "column": place[1],
        "severity": severity,
        "path": path,
        "message": message,
    }
