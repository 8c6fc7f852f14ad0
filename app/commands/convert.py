"""``convert``: a rule base into another format, into code, or into a table."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import tyro

if TYPE_CHECKING:
    from fuzzy.formats import Written
    from fuzzy.system import FuzzySystem

Target = Literal["yaml", "fis", "fll", "fcl", "fml", "c", "py", "csv", "npz"]

_SUFFIXES: dict[str, Target] = {
    ".yaml": "yaml",
    ".yml": "yaml",
    ".fis": "fis",
    ".fll": "fll",
    ".fcl": "fcl",
    ".xml": "fml",
    ".fml": "fml",
    ".c": "c",
    ".py": "py",
    ".csv": "csv",
    ".npz": "npz",
}


def convert(
    source: tyro.conf.Positional[Annotated[Path, tyro.conf.arg(metavar="IN")]],
    target: tyro.conf.Positional[Annotated[Path, tyro.conf.arg(metavar="OUT")]],
    /,
    *,
    lossy: bool = False,
    to: Annotated[Target | Literal["xml"] | None, tyro.conf.arg(metavar="FORMAT", help_behavior_hint="")] = None,
    table: Annotated[int | None, tyro.conf.arg(metavar="N", help_behavior_hint="")] = None,
    single: bool = False,
) -> int:
    """Write a rule base in another format: .yaml .fis .fll .fcl .xml, as code: .c .py, or as a table: .csv .npz.

    IN is read by its content; the suffix of OUT names what is written. A .c file comes with its .h file. What OUT
    cannot say is an error.

    Args:
        source: The rule base; - reads standard input.
        target: The file to write, whole or not at all; - writes standard output and needs --to.
        lossy: Write something else for what OUT cannot say, with a warning and the largest difference of the outputs.
        to: What to write, whatever the suffix of OUT: yaml fis fll fcl xml (or fml) c py csv npz.
        table: Points of each input: of a lookup table in .c, instead of the exact computation; of .csv and .npz.
        single: Single precision (float) in .c.
    """
    from app.commands.rulebases import STANDARD, load

    kind = _kind(target, to)
    system = load(source)
    if kind in ("c", "py", "csv", "npz"):
        from app.commands.export import export

        return export(system, kind, target, table, is_single=single)
    _refuse(table is not None, "--table", "c, csv and npz")
    _refuse(single, "--single", "c")
    from fuzzy import formats

    written = formats.write(system, kind, lossy=lossy)
    _warn(system, written, target, kind)
    if target == STANDARD:
        sys.stdout.write(written.text)
    else:
        from fuzzy.formats.files import write_bytes

        if kind == "yaml":
            _keep_comments(target)
        write_bytes(target, written.text.encode())
    return 0


def _keep_comments(target: Path) -> None:
    """Keep a copy of a file whose comments would be lost, and say so."""
    import contextlib

    from fuzzy.formats.files import read_bytes, write_bytes
    from fuzzy.formats.yaml_comments import comments

    if not target.is_file():
        return
    content = read_bytes(target)
    with contextlib.suppress(UnicodeDecodeError):
        lost = comments(content.decode())
        if lost:
            kept = target.with_name(f"{target.name}.bak")
            write_bytes(kept, content)
            place = f"{target}:{lost[0][0]}:1"
            print(f"{place}: warning: comments are lost; the file before is kept as {kept.name}", file=sys.stderr)


def _kind(target: Path, to: Target | Literal["xml"] | None) -> Target:
    from app.commands.failure import UsageError
    from app.commands.rulebases import STANDARD
    from fuzzy.errors import expected

    if to is not None:
        return "fml" if to == "xml" else to
    if target == STANDARD:
        raise UsageError(f"standard output has no suffix: --to names what to write: {', '.join(_SUFFIXES.values())}")
    if target.suffix.lower() not in _SUFFIXES:
        raise UsageError(f"unknown suffix {expected(target.suffix, _SUFFIXES)}")
    return _SUFFIXES[target.suffix.lower()]


def _refuse(is_given: bool, option: str, where: str) -> None:
    if is_given:
        from app.commands.failure import UsageError

        raise UsageError(f"{option} is for {where} only")


def _warn(
    system: FuzzySystem, written: Written, target: Path, kind: Literal["yaml", "fis", "fll", "fcl", "fml"]
) -> None:
    """Print what was written instead of what the format cannot say, and how far the outputs differ."""
    if not written.substitutes:
        return
    from fuzzy import formats
    from fuzzy.formats.difference import difference

    for substitute in written.substitutes:
        print(f"{target}: warning: {substitute}", file=sys.stderr)
    again = formats.loads(written.text, f"written.{kind}")
    found = difference(system, again)
    where = ", ".join(f"{entry.name}={value:g}" for entry, value in zip(system.inputs, found.inputs, strict=True))
    print(
        f"{target}: warning: the outputs differ by at most {found.largest:.6g} over {found.points} points "
        f"({found.output} at {where})",
        file=sys.stderr,
    )
