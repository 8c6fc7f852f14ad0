"""Files that survive a crash: whole or not at all, and on the disk before anybody is told so."""

from __future__ import annotations

import contextlib
import os
import re
import secrets
import shutil
import time
from collections.abc import Iterator
from pathlib import Path

_STALE_SECONDS = 60.0
"""Age from which an unfinished file is one that a crash left behind."""
_UNFINISHED = re.compile(r"\.[0-9a-f]{16}(\.\w+)?")


@contextlib.contextmanager
def replacing(path: Path, *, keeps_backup: bool = False) -> Iterator[Path]:
    """Yield a file to write beside ``path``, which takes its place at the end if nothing went wrong until then.

    Whatever happens meanwhile, the power failing included, ``path`` is the old file or the new one, never a mixture
    and never missing. The new one has the old one's permissions.

    Args:
        path: The file, not a link.
        keeps_backup: Whether the old file stays beside the new one, its name followed by ``.bak``.

    Raises:
        OSError: The folder cannot be written, or the disk is full; ``path`` is as it was.
    """
    temporary = path.with_name(f".{secrets.token_hex(8)}{path.suffix}")
    try:
        yield temporary
        _synchronize(temporary)
        if path.exists():
            temporary.chmod(path.stat().st_mode & 0o777)
            if keeps_backup:
                _back_up(path)
        temporary.replace(path)
        _synchronize(path.parent)
    except BaseException:
        with contextlib.suppress(OSError):
            temporary.unlink()
        raise


def clear_unfinished(folder: Path) -> None:
    """Delete what a crash left of files that were being written; what is younger may still be finished."""
    with contextlib.suppress(OSError):
        for entry in folder.iterdir():
            if _UNFINISHED.fullmatch(entry.name) and time.time() - entry.stat().st_mtime > _STALE_SECONDS:
                entry.unlink()


def _back_up(path: Path) -> None:
    """Keep the present content under another name: by a second link to it, or a copy where there are no links."""
    second = path.with_name(f".{secrets.token_hex(8)}")
    try:
        try:
            os.link(path, second)
        except OSError:
            shutil.copy2(path, second)
            _synchronize(second)
        second.replace(path.with_name(f"{path.name}.bak"))
    except BaseException:
        with contextlib.suppress(OSError):
            second.unlink()
        raise


def _synchronize(path: Path) -> None:
    """Wait until a file, or a folder's list of names, is on the disk."""
    if path.is_dir() and os.name != "posix":
        return  # only POSIX opens folders
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
