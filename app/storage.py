"""The folder of rule bases that the workbench opens from and saves to.

A browser names files, never paths: what is opened or replaced is one of the files that :meth:`Storage.names` lists,
and what is new has a plain name. Links that lead out of the folder are neither listed nor written through. Everything
here waits for the disk: the page calls it through :mod:`app.filing`, off the event loop.
"""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import NamedTuple

import msgspec

from app import clean
from fuzzy import durable, formats
from fuzzy.errors import FormatError, FuzzyError, expected
from fuzzy.system import FuzzySystem

_TRIES = 5
"""How often a file is read again that changes while it is read."""


class StorageError(Exception):
    """A file that cannot be opened or saved; the message is one sentence that can be shown."""


class Stamp(msgspec.Struct, frozen=True):
    """What a file looked like: two files with equal stamps have the same content.

    Attributes:
        modified_ns: Time of the last change.
        size: Bytes.
        digest: SHA-256 of the content.
    """

    modified_ns: int
    size: int
    digest: str


class ChangedOnDiskError(StorageError):
    """A file that would be overwritten is not the one that was opened; saving needs the user's word.

    Attributes:
        stamp: What the file looks like now.
    """

    def __init__(self, message: str, stamp: Stamp) -> None:
        super().__init__(message)
        self.stamp = stamp


class Opened(NamedTuple):
    """A file that was read: its name in the folder, what it holds, and what it looked like on disk."""

    name: str
    system: FuzzySystem
    stamp: Stamp


class Storage:
    """Rule bases in one folder.

    Attributes:
        folder: The folder, as an absolute path without links.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder.resolve()
        durable.clear_unfinished(self.folder)

    def names(self) -> tuple[str, ...]:
        """Return the names of the rule bases in the folder, sorted.

        Raises:
            StorageError: The folder cannot be read.
        """
        try:
            entries = sorted(self.folder.iterdir())
        except OSError as error:
            raise StorageError(f"the folder {self.folder} cannot be read: {error.strerror}") from error
        return tuple(entry.name for entry in entries if self._is_rule_base(entry))

    def open(self, name: str) -> Opened:
        """Read one of the listed files.

        Raises:
            StorageError: The name is not listed, or the file is not a valid rule base; with line and column.
        """
        path = self._listed(name)
        try:
            for _ in range(_TRIES):
                stamp = _stamp(path)
                system = formats.load(path)
                if _stamp(path) == stamp:
                    return Opened(name, system, stamp)
        except FormatError as error:
            raise StorageError(_place(name, error)) from error
        except OSError as error:
            raise StorageError(f"{name} cannot be read: {error.strerror}") from error
        raise StorageError(f"{name} keeps changing while it is read; try again")

    def changed(self, name: str, stamp: Stamp) -> Stamp | None:
        """Return what a file looks like now if it is no longer the one that had ``stamp``; None if it is, or is gone.

        A new time alone (``touch``, a checkout) is no change, and whoever deleted the file has nothing to lose.

        Raises:
            StorageError: The file cannot be read.
        """
        path = self.folder / self._known(name)
        try:
            status = path.stat()
            if (status.st_mtime_ns, status.st_size) == (stamp.modified_ns, stamp.size):
                return None
            now = _stamp(path)
        except FileNotFoundError:
            return None
        except OSError as error:
            raise StorageError(f"{name} cannot be read: {error.strerror}") from error
        return None if now.digest == stamp.digest else now

    def save(self, name: str, system: FuzzySystem, stamp: Stamp) -> Stamp:
        """Write a system to the file that it was read from, whole or not at all, and keep the old file as a .bak.

        Args:
            name: The file's name.
            system: A valid system.
            stamp: What the file looked like when it was read or last saved.

        Returns:
            What the file looks like now.

        Raises:
            ChangedOnDiskError: The file was changed meanwhile. ``save_as(..., overwrite=True)`` replaces it.
            StorageError: The system is not valid or the file cannot be written; the file is as it was.
        """
        now = self.changed(name, stamp)
        if now is not None:
            raise ChangedOnDiskError(f"{name} was changed on disk since it was opened", now)
        return self._write(self.folder / name, system)

    def save_as(self, name: str, system: FuzzySystem, *, overwrite: bool = False) -> Stamp:
        """Write a system to a file of this name, whole or not at all.

        Args:
            name: A plain name that ends in .yaml, or one of the listed files.
            system: A valid system.
            overwrite: Whether a file of that name is replaced; it is kept as a .bak.

        Returns:
            What the file looks like now.

        Raises:
            ChangedOnDiskError: There is a file of that name and ``overwrite`` is false.
            StorageError: The name or the system is not valid, or the file cannot be written; nothing has changed.
        """
        path = self.folder / self._known(name)
        if path.exists() and not overwrite:
            raise ChangedOnDiskError(f"there is a file {name} already", _stamp(path))
        return self._write(path, system)

    def _write(self, path: Path, system: FuzzySystem) -> Stamp:
        if path.is_symlink() and not self._is_rule_base(path):
            raise StorageError(f"{path.name} is a link that leads out of the folder")
        target = path.resolve()
        try:
            content = formats.write(system, formats.format_of(path.name)).text.encode()
            with durable.replacing(target, keeps_backup=True) as temporary:
                temporary.write_bytes(content)
            return _stamp(target)
        except FormatError as error:
            raise StorageError(f"{path.name}: {error.message}") from error
        except FuzzyError as error:
            raise StorageError(f"{path.name} is not saved, the rule base is not valid: {error}") from error
        except OSError as error:
            raise StorageError(f"{path.name}: the file cannot be written: {error.strerror}{self._gone()}") from error

    def _gone(self) -> str:
        return "" if self.folder.is_dir() else f"; the folder {self.folder} is gone"

    def _is_rule_base(self, entry: Path) -> bool:
        is_named_so = entry.suffix.lower() in formats.SUFFIXES and not entry.name.startswith(".")
        try:
            return is_named_so and entry.is_file() and entry.resolve().parent == self.folder
        except OSError:
            return False

    def _listed(self, name: str) -> Path:
        names = self.names()
        if name not in names:
            raise StorageError(f"no rule base {expected(str(name)[: clean.MAX_NAME], names)}")
        return self.folder / name

    def _known(self, name: str) -> str:
        """Return ``name`` if it is a listed file or could be a new one."""
        if self.folder.is_dir() and name in self.names():
            return name
        try:
            return clean.file_name(name)
        except clean.Refused as error:
            raise StorageError(str(error)) from error


def _stamp(path: Path) -> Stamp:
    with path.open("rb") as file:
        status = path.stat()
        return Stamp(status.st_mtime_ns, status.st_size, hashlib.file_digest(file, "sha256").hexdigest())


def _place(name: str, error: FormatError) -> str:
    place = f"{name}:{error.line}:{error.column}" if error.line else name
    return f"{place}: {error.path}: {error.message}" if error.path else f"{place}: {error.message}"
