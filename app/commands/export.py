"""What ``convert`` writes besides rule bases: C and Python code, tables."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from fuzzy.system import FuzzySystem

_TABLE_POINTS = 101


def export(
    system: FuzzySystem, kind: Literal["c", "py", "csv", "npz"], target: Path, table: int | None, *, is_single: bool
) -> int:
    """Write code or a table; the exit code of the command is returned."""
    from app.commands.failure import UsageError
    from app.commands.rulebases import STANDARD

    if is_single and kind != "c":
        raise UsageError("--single is for c only")
    if target == STANDARD and kind in ("c", "npz"):
        raise UsageError(f"{kind} cannot be written to standard output")
    if kind == "c":
        _write_c(system, target, table, is_single=is_single)
    elif kind == "py":
        if table is not None:
            raise UsageError("--table is for c, csv and npz only")
        from fuzzy.export.python_code import python_file

        _write(target, python_file(system))
    else:
        _write_table(system, kind, target, _TABLE_POINTS if table is None else table)
    return 0


def _write(target: Path, text: str) -> None:
    from app.commands.rulebases import STANDARD
    from fuzzy.formats.files import write_bytes

    if target == STANDARD:
        sys.stdout.write(text)
    else:
        write_bytes(target, text.encode())


def _write_c(system: FuzzySystem, target: Path, table: int | None, *, is_single: bool) -> None:
    from fuzzy.export.c_code import c_files

    files = c_files(system, target.stem, is_single=is_single, table=table)
    _write(target.with_suffix(".h"), files.header)
    _write(target, files.source)
    for output, bound in zip(system.outputs, files.bounds, strict=False):
        print(f"{target}: the table is off by at most {bound:.3g} in {output.name}")


def _write_table(system: FuzzySystem, kind: str, target: Path, points: int) -> None:
    from app.commands.files import output, write_columns
    from fuzzy.export.surface_table import surface_table

    found = surface_table(system, points)
    if kind == "csv":
        write_columns(target, found.names, found.rows)
        return
    import numpy as np

    n_in = len(system.inputs)
    shape = (points,) * n_in
    arrays = {f"input_{i}": axis for i, axis in enumerate(found.axes)}
    arrays |= {f"output_{k}": found.rows[:, n_in + k].reshape(shape) for k in range(len(system.outputs))}
    with output(target) as temporary, temporary.open("wb") as file:
        np.savez_compressed(file, names=np.array(found.names), **arrays)  # type: ignore[arg-type]
