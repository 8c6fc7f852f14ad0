"""``check``: findings on rule bases, as a compiler writes them."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import tyro

if TYPE_CHECKING:
    from fuzzy.finding import Finding


def check(
    files: tyro.conf.Positional[Annotated[tuple[Path, ...], tyro.conf.arg(metavar="FILE...", help_behavior_hint="")]],
    /,
    *,
    json: bool = False,
) -> int:
    """Look for mistakes and weak spots in rule bases.

    Prints one line file:line:column: error|warning|hint: message for every finding. An error cannot be used, a warning
    acts otherwise than it looks, a hint may well be meant. Exit code 1 when there are errors or warnings.

    Args:
        files: The rule bases, in any format; - reads standard input.
        json: Print the findings as JSON.
    """
    if not files:
        from app.commands.failure import UsageError

        raise UsageError("check needs at least one FILE")
    findings = [(str(file), finding) for file in files for finding in _findings(file)]
    if json:
        import msgspec

        listed = [{"file": file, **msgspec.to_builtins(finding)} for file, finding in findings]
        print(msgspec.json.format(msgspec.json.encode({"files": len(files), "findings": listed})).decode())
    else:
        for file, found in findings:
            print(f"{file}:{found.line}:{found.column}: {found.level}: {found.message}")
    return 1 if any(finding.level != "hint" for _, finding in findings) else 0


def _findings(file: Path) -> list[Finding]:
    from app.commands.rulebases import read
    from fuzzy.check import Finding, located
    from fuzzy.check import check as examine
    from fuzzy.errors import FormatError

    try:
        imported = read(file)
        remarks = [Finding("hint", entry.message, line=entry.line, column=entry.column) for entry in imported.remarks]
        return remarks + located(examine(imported.system), imported.places)
    except FormatError as error:
        message = f"{error.path}: {error.message}" if error.path else error.message
        return [Finding("error", message, error.path, line=error.line, column=error.column)]
