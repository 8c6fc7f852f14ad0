"""CSV files in, and files out that are written whole or not at all."""

from __future__ import annotations

import contextlib
import csv
import io
import math
import sys
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import NamedTuple, TextIO

import numpy as np
from numpy.typing import ArrayLike, NDArray

from app.commands.failure import CommandError, failure
from app.commands.rulebases import STANDARD
from fuzzy import durable
from fuzzy.errors import expected, shown


class Columns(NamedTuple):
    """Numbers of a CSV file.

    Attributes:
        values: (n, n_names) the numbers, in the order of the names that were asked for.
        lines: (n,) line of every row in the file, from 1.
    """

    values: NDArray[np.float64]
    lines: NDArray[np.intp]


def read_columns(path: Path, names: Sequence[str]) -> Columns:
    """Read a CSV file whose header names exactly ``names``, in any order; empty lines are skipped.

    Raises:
        CommandError: With line and column of the first field that is missing, unknown or not a finite number.
    """
    try:
        with _opened(path) as file:
            return _read(path, file, names)
    except UnicodeDecodeError as error:
        raise failure(f"byte 0x{error.object[error.start]:02x} is not UTF-8 text", path) from None
    except (OSError, ValueError) as error:
        raise failure(f"the file cannot be read: {_reason(error)}", path) from None


def _opened(path: Path) -> contextlib.AbstractContextManager[TextIO]:
    """Return the file, or standard input for `-`."""
    if path == STANDARD:
        return contextlib.nullcontext(io.TextIOWrapper(sys.stdin.buffer, encoding="utf-8-sig", newline=""))
    return path.open(encoding="utf-8-sig", newline="")


def _read(path: Path, file: TextIO, names: Sequence[str]) -> Columns:
    reader = csv.reader(file, strict=True)
    lines: list[int] = []
    rows: list[list[float]] = []
    order: list[int] | None = None
    try:
        for row in reader:
            line = reader.line_num
            if not any(field.strip() for field in row):
                continue
            if order is None:
                order = _order(path, line, row, names)
                continue
            if len(row) != len(names):
                raise failure(f"{len(row)} fields; valid: {len(names)} ({', '.join(names)})", path, line, 1)
            numbers = [_number(path, line, row, place) for place in range(len(row))]
            rows.append([numbers[place] for place in order])
            lines.append(line)
    except csv.Error as error:
        raise failure(str(error), path, reader.line_num, 1) from None
    if order is None:
        raise failure(f"the file is empty; the first line names the inputs: {','.join(names)}", path)
    return Columns(np.array(rows, dtype=np.float64).reshape(-1, len(names)), np.array(lines, dtype=np.intp))


def _order(path: Path, line: int, header: list[str], names: Sequence[str]) -> list[int]:
    """Return the place of every name in the header."""
    found = [field.strip() for field in header]
    for place, name in enumerate(found):
        if name not in names:
            raise failure(f"the header names {expected(name, names)}", path, line, _column(header, place))
        if name in found[:place]:
            raise failure(f"the header names '{name}' twice", path, line, _column(header, place))
    for name in names:
        if name not in found:
            raise failure(f"the header does not name '{name}'; valid: {','.join(names)}", path, line, 1)
    return [found.index(name) for name in names]


def _number(path: Path, line: int, row: list[str], place: int) -> float:
    try:
        number = float(row[place])
    except ValueError:
        number = math.nan
    if math.isfinite(number) and "_" not in row[place]:
        return number
    raise failure(
        f"field {place + 1} is '{shown(row[place])}'; valid is a finite number", path, line, _column(row, place)
    )


def _column(row: list[str], place: int) -> int:
    """Return the column of a field, counted from 1; quotes do not count."""
    return sum(len(field) + 1 for field in row[:place]) + 1


def write_columns(path: Path, names: Sequence[str], values: ArrayLike) -> None:
    """Write a CSV file: the names, then the rows of ``values`` (n, n_names) with 17 digits, NaN as ``nan``.

    Raises:
        CommandError: The file cannot be written.
    """
    if path == STANDARD:
        _write(sys.stdout, names, values)
        return
    with output(path) as temporary, temporary.open("w", encoding="utf-8", newline="") as file:
        _write(file, names, values)


def _write(file: TextIO, names: Sequence[str], values: ArrayLike) -> None:
    writer = csv.writer(file, lineterminator="\n")
    writer.writerow(names)
    writer.writerows(_digits(np.asarray(values, dtype=np.float64)))


def _digits(values: NDArray[np.float64]) -> Iterable[list[str]]:
    return ([format(value, ".17g") for value in row] for row in values.tolist())


@contextlib.contextmanager
def output(path: Path) -> Iterator[Path]:
    """Yield a file to write that takes the place of ``path`` at the end, if nothing went wrong until then.

    A pipe or a device, such as /dev/stdout, is written directly.

    Raises:
        CommandError: The file cannot be written.
    """
    try:
        if path.is_dir():
            raise failure("this is a folder, not a file", path)
        if (path.exists() and not path.is_file()) or path.is_relative_to("/dev"):
            yield path
            return
        with durable.replacing(path.resolve()) as temporary:
            yield temporary
    except CommandError:
        raise
    except (OSError, ValueError) as error:
        raise failure(f"the file cannot be written: {_reason(error)}", path) from None


def _reason(error: Exception) -> str:
    return error.strerror if isinstance(error, OSError) and error.strerror else str(error)
