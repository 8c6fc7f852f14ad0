"""Files in and out: the workbench's YAML, MATLAB's .fis, fuzzylite's .fll, IEC 61131-7 .fcl, IEEE 1855 FML .xml."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path, PurePath
from typing import assert_never

from fuzzy.errors import FormatError, InvalidSystemError
from fuzzy.formats import detection, source, writing, yaml
from fuzzy.formats.assembly import Imported, Remark
from fuzzy.formats.detection import Format, detect, format_of
from fuzzy.formats.fcl import reader as fcl
from fuzzy.formats.files import MAX_BYTES, bounded, read_bytes, write_bytes
from fuzzy.formats.fis import reader as fis
from fuzzy.formats.fll import reader as fll
from fuzzy.formats.fml import reader as fml
from fuzzy.formats.writing import Written
from fuzzy.system import FuzzySystem

__all__ = [
    "MAX_BYTES",
    "READABLE",
    "SUFFIXES",
    "Format",
    "Imported",
    "Remark",
    "Written",
    "detect",
    "dumps",
    "format_of",
    "from_bytes",
    "imported",
    "load",
    "loads",
    "positions",
    "save",
    "write",
]

SUFFIXES = (".yaml", ".yml")
"""Suffixes of the workbench's own files."""

READABLE = tuple(detection.SUFFIXES)
"""Suffixes of all files that can be read and written."""


def load(path: str | os.PathLike[str]) -> FuzzySystem:
    """Read a fuzzy system from a file in any format.

    Args:
        path: The file; its content tells the format, or else its suffix.

    Raises:
        FormatError: If the file cannot be read or is not valid, with the line and column of the first mistake.
    """
    return imported(path).system


def imported(path: str | os.PathLike[str]) -> Imported:
    """Read a fuzzy system, with what was left out or taken otherwise on the way.

    Raises:
        FormatError: As :func:`load`.
    """
    return from_bytes(read_bytes(path), str(path))


def from_bytes(content: bytes, name: str) -> Imported:
    """Read the content of a file, such as of an upload or of standard input.

    Args:
        content: The bytes.
        name: Name for errors; its suffix counts where the content does not tell the format.

    Raises:
        FormatError: As :func:`load`.
    """
    bounded(content, name)
    is_yaml = PurePath(name).suffix.lower() in SUFFIXES
    if is_yaml and detect(content.decode("latin-1"), name) == "yaml":
        return _read(_utf8(content, name), name, "yaml")
    text = source.decode(content, name)
    return _read(text, name, detect(text, name))


def loads(text: str, name: str = "rulebase.yaml") -> FuzzySystem:
    """Read a fuzzy system from a text.

    Args:
        text: The content of a file.
        name: Name for errors; its suffix counts where the content does not tell the format.

    Raises:
        FormatError: If the text is not valid, with the line and column of the first mistake.
    """
    if len(text) > MAX_BYTES:
        raise FormatError(f"the file is larger than {MAX_BYTES} bytes", name)
    text = text.removeprefix("\ufeff")
    return _read(text, name, detect(text, name)).system


def positions(path: str | os.PathLike[str]) -> Mapping[str, tuple[int, int]]:
    """Return line and column, counted from 1, of the paths of a file, such as ``inputs.e.terms.NB``."""
    return imported(path).places


def write(system: FuzzySystem, kind: Format, *, lossy: bool = False) -> Written:
    """Return a system as the text of a file, which can be read again.

    Args:
        system: A valid system.
        kind: The format.
        lossy: Whether something else may be written for what the format cannot say.

    Raises:
        InvalidSystemError: If the system is not valid, too large to be read again, or the format cannot say it.
    """
    written = writing.write(system, kind, lossy=lossy)
    if kind != "yaml":
        try:
            _read(written.text, f"written.{kind}", kind)
        except FormatError as error:
            message = f"{detection.TITLES[kind]} cannot say this: written, it would be refused ({error.message})"
            raise InvalidSystemError(message, error.path) from None
    return written


def dumps(system: FuzzySystem) -> str:
    """Return a system as the text of a YAML file.

    Raises:
        InvalidSystemError: If the system is not valid, or so large that the file could not be read again.
    """
    return write(system, "yaml").text


def save(system: FuzzySystem, path: str | os.PathLike[str]) -> None:
    """Write a system to a file, whole or not at all.

    A YAML file is written anew: comments that it held outside ``notes`` are lost.

    Args:
        system: A valid system.
        path: The file; its suffix names the format. Its folder must exist.

    Raises:
        InvalidSystemError: If the system is not valid, or the format cannot say it; the file stays as it was.
        FormatError: If the suffix is unknown or the file cannot be written.
    """
    kind = format_of(str(path))
    write_bytes(Path(path), write(system, kind).text.encode())


def _read(text: str, name: str, kind: Format) -> Imported:
    match kind:
        case "yaml":
            return yaml.read(text, name)
        case "fis":
            return fis.read(text, name)
        case "fll":
            return fll.read(text, name)
        case "fcl":
            return fcl.read(text, name)
        case "fml":
            return fml.read(text, name)
        case _:
            assert_never(kind)


def _utf8(content: bytes, name: str) -> str:
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        before = content[: error.start]
        line, column = before.count(b"\n") + 1, error.start - before.rfind(b"\n")
        raise FormatError(f"byte 0x{content[error.start]:02x} is not UTF-8 text", name, line, column) from None
