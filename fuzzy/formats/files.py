"""Bytes in, bounded, and bytes out, whole or not at all."""

from __future__ import annotations

import os
import stat
from pathlib import Path

from fuzzy import durable
from fuzzy.errors import FormatError

MAX_BYTES = 1 << 20
"""Greatest size of a file: 1 MiB, some hundred times a usual rule base."""


def read_bytes(path: str | os.PathLike[str]) -> bytes:
    """Return the content of a file.

    Raises:
        FormatError: If there is none, it is a folder or a device, or larger than ``MAX_BYTES``.
    """
    source = str(path)
    try:
        # Path.open takes no opener. Without O_NONBLOCK a pipe that nobody writes to would be waited for.
        with open(path, "rb", opener=_opener) as file:
            if not stat.S_ISREG(os.fstat(file.fileno()).st_mode):
                raise FormatError("this is no regular file ('-' reads standard input)", source)
            content = file.read(MAX_BYTES + 1)
    except IsADirectoryError:
        raise FormatError("this is a folder, not a file", source) from None
    except (OSError, ValueError) as error:
        if isinstance(error, FormatError):
            raise
        reason = error.strerror if isinstance(error, OSError) else None
        raise FormatError(f"the file cannot be read: {reason or error}", source) from error
    return bounded(content, source)


def _opener(path: str, flags: int) -> int:
    return os.open(path, flags | getattr(os, "O_NONBLOCK", 0))


def bounded(content: bytes, source: str) -> bytes:
    """Return the content unless it is too large to be a rule base."""
    if len(content) > MAX_BYTES:
        raise FormatError(f"the file is larger than {MAX_BYTES} bytes", source)
    return content


def write_bytes(path: Path, content: bytes) -> None:
    """Write beside ``path`` and then rename, so that a crash leaves the old file or the new one.

    Raises:
        FormatError: The file cannot be written; it is as it was.
    """
    try:
        with durable.replacing(path.resolve()) as temporary:
            temporary.write_bytes(content)
    except OSError as error:
        raise FormatError(f"the file cannot be written: {error.strerror or error}", str(path)) from error
