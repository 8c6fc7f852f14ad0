"""Files in and out: the format follows from the suffix."""

from __future__ import annotations

import contextlib
import os
import secrets
from pathlib import Path

from fuzzy.errors import FormatError, InvalidSystemError, expected
from fuzzy.formats import yaml, yaml_writer
from fuzzy.system import FuzzySystem
from fuzzy.validation import validate

SUFFIXES = (".yaml", ".yml")
"""Suffixes of the files that can be read and written."""

MAX_BYTES = 1 << 20
"""Greatest size of a file: 1 MiB, some hundred times a usual rule base."""


def load(path: str | os.PathLike[str]) -> FuzzySystem:
    """Read a fuzzy system from a file.

    Args:
        path: The file; its suffix names the format.

    Raises:
        FormatError: If the file cannot be read or is not valid, with the line and column of the first mistake.
    """
    return loads(_text(path), str(path))


def loads(text: str, source: str = "rulebase.yaml") -> FuzzySystem:
    """Read a fuzzy system from a text.

    Args:
        text: The content of a file.
        source: Name for errors; its suffix names the format.

    Raises:
        FormatError: If the text is not valid, with the line and column of the first mistake.
    """
    _check_suffix(source)
    return yaml.read(_bounded(text, source), source)


def positions(path: str | os.PathLike[str]) -> dict[str, tuple[int, int]]:
    """Return line and column, counted from 1, of every path of a file, such as ``inputs.e.terms.NB``."""
    return yaml.positions(_text(path), str(path))


def dumps(system: FuzzySystem) -> str:
    """Return a system as the text of a YAML file.

    Raises:
        InvalidSystemError: If the system is not valid, or so large that the file could not be read again.
    """
    text = yaml_writer.write(validate(system))
    size = len(text.encode())
    if size > MAX_BYTES:
        raise InvalidSystemError(f"the system takes {size} bytes as a file: at most {MAX_BYTES} are read again")
    return text


def save(system: FuzzySystem, path: str | os.PathLike[str]) -> None:
    """Write a system to a file, whole or not at all.

    The file is written anew: comments that it held outside ``notes`` are lost.

    Args:
        system: A valid system.
        path: The file; its suffix names the format. Its folder must exist.

    Raises:
        InvalidSystemError: If the system is not valid; the file stays as it was.
        FormatError: If the suffix is unknown or the file cannot be written.
    """
    _check_suffix(path)
    content = dumps(system).encode()
    try:
        _write_atomically(Path(path).resolve(), content)
    except OSError as error:
        raise FormatError(f"the file cannot be written: {error.strerror or error}", str(path)) from error


def _check_suffix(path: str | os.PathLike[str]) -> None:
    suffix = Path(path).suffix
    if suffix.lower() not in SUFFIXES:
        raise FormatError(f"unknown suffix {expected(suffix, SUFFIXES)}", str(path))


def _text(path: str | os.PathLike[str]) -> str:
    _check_suffix(path)
    source = str(path)
    try:
        with Path(path).open("rb") as file:
            content = file.read(MAX_BYTES + 1)
    except IsADirectoryError:
        raise FormatError("this is a folder, not a file", source) from None
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) else None
        raise FormatError(f"the file cannot be read: {reason or error}", source) from error
    if len(content) > MAX_BYTES:
        raise FormatError(f"the file is larger than {MAX_BYTES} bytes", source)
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        before = content[: error.start]
        line, column = before.count(b"\n") + 1, error.start - before.rfind(b"\n")
        raise FormatError(f"byte 0x{content[error.start]:02x} is not UTF-8 text", source, line, column) from None


def _bounded(text: str, source: str) -> str:
    if len(text) > MAX_BYTES:
        raise FormatError(f"the file is larger than {MAX_BYTES} bytes", source)
    return text.removeprefix("\ufeff")


def _write_atomically(path: Path, content: bytes) -> None:
    """Write beside ``path`` and then rename, so that a crash leaves the old file or the new one."""
    temporary = path.with_name(f".{secrets.token_hex(8)}.part")
    try:
        with temporary.open("xb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        with contextlib.suppress(FileNotFoundError):
            temporary.chmod(path.stat().st_mode & 0o777)
        temporary.replace(path)
    except BaseException:
        with contextlib.suppress(OSError):
            temporary.unlink()
        raise
