"""The journal: unsaved work survives a crash, a full disk in the rulebases folder and the end of the process.

Every running workbench keeps one file in the user's state folder, written anew within a second of every edit: the
document as text, and document, file and history as msgpack. A lock tells the journal of a running process from one
that was left behind; that is offered at the next start with the same folder, and deleted when it was decided upon.
"""

from __future__ import annotations

import contextlib
import hashlib
import logging
import os
import secrets
import threading
import time
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import IO

import msgspec

from app.state import AppState, Recovery, Source, Work
from app.store import Shown, is_same
from fuzzy import durable, formats
from fuzzy.errors import FuzzyError
from fuzzy.validation import validate

try:
    import fcntl
except ImportError:  # Windows: a journal then belongs to whoever finds it
    fcntl = None

_VERSION = 1
_PERIOD = 0.3
"""Seconds between two writings: less than the one that a crash may cost, and rare enough for a slow disk."""
_RETRY_SECONDS = 5.0
_PATIENCE = 1.0
_MOST_BYTES = 8 << 20
"""Greatest size before compression; of a longer history the oldest steps are left out."""

_log = logging.getLogger(__name__)


class Envelope(msgspec.Struct, frozen=True):
    """A journal's content.

    Attributes:
        version: Of this form.
        at: When it was written, s since 1970.
        text: The document as a YAML file, readable by whoever no longer understands ``work``.
        work: A :class:`Work` as msgpack.
    """

    version: int
    at: float
    text: str
    work: bytes


def folder() -> Path:
    """Return where journals are kept: below ``XDG_STATE_HOME``, by default ``~/.local/state``."""
    home = os.environ.get("XDG_STATE_HOME")
    return (Path(home) if home else Path.home() / ".local" / "state") / "fuzzy-workbench" / "journals"


class Journal:
    """Keeps the work of one workbench on the disk; a view of the store, written by a thread of its own.

    Args:
        rulebases: The folder that the work belongs to.
        warn: Called from the thread with a sentence when the journal cannot be written, once for each time.
    """

    def __init__(self, rulebases: Path, warn: Callable[[str], None]) -> None:
        self._folder = folder()
        self._prefix = hashlib.sha256(str(rulebases.resolve()).encode()).hexdigest()[:16]
        self._path = self._folder / f"{self._prefix}-{secrets.token_hex(8)}.journal"
        self._warn = warn
        self._lock_file: IO[bytes] | None = None
        self._wanted: Work | None = None
        self._latest: Work | None = None  # what was wanted last
        self._written: Work | None = None
        self._doomed: list[Path] = []  # to be deleted once what is wanted has been written
        self._is_closed = False
        self._changed = threading.Condition()
        self._known: Shown = ()
        self._answered: list[Path] = []
        self._thread = threading.Thread(target=self._run, name="journal", daemon=True)
        self._thread.start()

    def shows(self, state: AppState) -> Shown:
        """Return what must not be lost."""
        return tuple(getattr(state, name) for name in Work.__struct_fields__)

    def render(self, state: AppState) -> None:
        """Keep the state's work, if it is other than before."""
        known, self._known = self._known, self.shows(state)
        if is_same(known, self._known):
            return
        if not known and not state.work.is_unsaved:
            return  # nothing has happened yet
        with self._changed:
            self._wanted = self._latest = state.work
            self._doomed += self._answered
            self._changed.notify()
        self._answered = []

    def found(self) -> Recovery | None:
        """Return the newest unsaved work that was left for this folder; what holds nothing unsaved is deleted."""
        recoveries = []
        for path in self._orphans():
            try:
                recovery = read(path)
            except (OSError, ValueError, FuzzyError) as error:
                _log.warning("the journal %s cannot be read and is left where it is: %s", path, error)
                continue
            if recovery.work.is_unsaved:
                recoveries.append(recovery)
            else:
                _delete(path)
        return max(recoveries, key=lambda recovery: recovery.at, default=None)

    def forget(self, journal: str) -> None:
        """Delete a journal that was left, as soon as the state that is rendered next has been written to this one."""
        self._answered.append(Path(journal))

    def discard(self, journal: str) -> None:
        """Delete a journal that was left."""
        _delete(Path(journal))

    def close(self) -> bool:
        """Write what has not been written, and end the thread; a second call does nothing.

        Returns:
            Whether unsaved work is left for the next start; otherwise nothing remains.
        """
        with self._changed:
            self._is_closed = True
            self._changed.notify()
        self._thread.join(timeout=_PATIENCE)
        is_unsaved = self._latest is not None and self._latest.is_unsaved
        if not is_unsaved:
            _delete(self._path)
        if self._lock_file is not None:
            self._lock_file.close()
        return is_unsaved and self._written is self._latest

    def _run(self) -> None:
        is_well = True
        while True:
            with self._changed:
                while self._wanted is None and not self._is_closed:
                    self._changed.wait()
                work, self._wanted = self._wanted, None
                doomed, self._doomed = self._doomed, []
            if work is None:
                return
            try:
                self._write(work)
            except Exception as error:  # whatever it is: the thread must go on
                if is_well:
                    _log.error("edits are not journalled: %r", error)
                    self._warn(f"Edits would not survive a crash, the journal cannot be written: {_reason(error)}")
                is_well = False
                with self._changed:
                    if self._is_closed:
                        return
                    self._wanted = self._wanted or work
                    self._doomed = doomed + self._doomed
                    self._changed.wait_for(lambda: self._is_closed, _RETRY_SECONDS)
                continue
            self._written = work
            for path in doomed:
                _delete(path)
            if not is_well:
                is_well = True
                _log.info("edits are journalled again")
            with self._changed:
                self._changed.wait_for(lambda: self._is_closed, _PERIOD)

    def _write(self, work: Work) -> None:
        content = encode(work, time.time())
        if self._lock_file is None:
            self._folder.mkdir(parents=True, exist_ok=True, mode=0o700)
            durable.clear_unfinished(self._folder)
            self._lock_file = _locked(self._path.with_suffix(".lock"))
        with durable.replacing(self._path) as temporary:
            temporary.touch(mode=0o600)
            temporary.write_bytes(content)

    def _orphans(self) -> list[Path]:
        """Return the journals for this folder whose processes have ended."""
        try:
            found = sorted(self._folder.glob(f"{self._prefix}-*.journal"))
        except OSError:
            return []
        return [path for path in found if path != self._path and not _is_held(path.with_suffix(".lock"))]


def encode(work: Work, at: float) -> bytes:
    """Return the content of a journal; of a history that is too long only the newer half, or the half of that."""
    packed = _packed(work)
    while len(packed) > _MOST_BYTES and (work.past or work.future):
        newer = work.past[(len(work.past) + 1) // 2 :]
        work = msgspec.structs.replace(work, past=newer, future=work.future[: len(work.future) // 2])
        packed = _packed(work)
    envelope = Envelope(_VERSION, at, formats.dumps(work.document), packed)
    return zlib.compress(msgspec.msgpack.encode(envelope), 1)


def _packed(work: Work) -> bytes:
    return msgspec.msgpack.encode(work, enc_hook=float)  # numpy's numbers


def read(path: Path) -> Recovery:
    """Read a journal; one whose history this version does not understand gives the document alone, without a file.

    Raises:
        OSError: It cannot be read.
        ValueError: It is no journal, or damaged.
        FuzzyError: It holds no valid document.
    """
    try:
        envelope = msgspec.msgpack.decode(zlib.decompress(path.read_bytes()), type=Envelope)
    except zlib.error as error:
        raise ValueError(f"damaged: {error}") from error
    try:
        work = msgspec.msgpack.decode(envelope.work, type=Work)
        validate(work.document)
    except (ValueError, FuzzyError) as error:
        _log.warning("of the journal %s only the document can be read: %s", path, error)
        document = formats.loads(envelope.text, f"{path.stem}.yaml")
        work = Work(document, Source(msgspec.structs.replace(document, name="")))
    return Recovery(work, envelope.at, str(path))


def _locked(path: Path) -> IO[bytes]:
    """Return a file that is locked until it is closed, or the process ends in whatever way."""
    file = path.open("wb")
    if fcntl is not None:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    return file


def _is_held(path: Path) -> bool:
    """Tell whether a running process holds a lock."""
    if fcntl is None:
        return False
    with contextlib.suppress(FileNotFoundError), path.open("rb") as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            return True
    return False


def _delete(path: Path) -> None:
    for name in (path, path.with_suffix(".lock")):
        with contextlib.suppress(OSError):
            name.unlink()


def _reason(error: Exception) -> str:
    return (error.strerror or str(error)) if isinstance(error, OSError) else str(error)
