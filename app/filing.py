"""What the page does with files: off the event loop, one after the other, and with an answer for every failure."""

from __future__ import annotations

import asyncio
from collections.abc import Callable

from app.state import AppState, Asked, Conflict, Event, Notice, Noticed, Opened, Saved
from app.storage import ChangedOnDiskError, Stamp, Storage, StorageError

_WATCH_SECONDS = 2.0
"""How often the opened file is looked at."""


class Filing:
    """Opens and saves for the page; every method returns the event that tells what came of it.

    Args:
        storage: The folder of rule bases.
        present: Returns the present state.
    """

    def __init__(self, storage: Storage, present: Callable[[], AppState]) -> None:
        self._storage = storage
        self._present = present
        self._lock = asyncio.Lock()

    async def save(self) -> Event:
        """Write the document to the file that it came from; asks if somebody else has changed that."""
        async with self._lock:
            state = self._present()
            source = state.source
            if source.file is None or source.stamp is None:
                return _failed("Not saved: choose a name in Files first")
            try:
                stamp = await asyncio.to_thread(self._storage.save, source.file, state.document, source.stamp)
            except ChangedOnDiskError as error:
                return Asked(Conflict(source.file, error.stamp))
            except StorageError as error:
                return _failed(f"Not saved: {error}")
            return await self._saved(state, source.file, stamp)

    async def save_as(self, name: str, *, overwrite: bool = False) -> Event:
        """Write the document to a file of another name, or over a file that somebody else has changed."""
        async with self._lock:
            state = self._present()
            try:
                stamp = await asyncio.to_thread(self._storage.save_as, name, state.document, overwrite=overwrite)
            except StorageError as error:
                return _failed(f"Not saved: {error}")
            return await self._saved(state, name, stamp)

    async def open(self, name: str | None) -> Event:
        """Read a file of the folder."""
        async with self._lock:
            try:
                opened = await asyncio.to_thread(self._storage.open, name or "")
            except StorageError as error:
                return _failed(f"Not opened: {error}")
            return Opened(opened.system, opened.name, opened.stamp, await self._names())

    async def watch(self, dispatch: Callable[[Event], None]) -> None:
        """Ask as soon as somebody else changes the opened file; once for each of their versions."""
        asked: Stamp | None = None
        while True:
            await asyncio.sleep(_WATCH_SECONDS)
            async with self._lock:
                state = self._present()
                source = state.source
                if source.file is None or source.stamp is None:
                    continue
                try:
                    now = await asyncio.to_thread(self._storage.changed, source.file, source.stamp)
                except StorageError:
                    continue  # whoever saves or opens will be told
                if now is not None and now != asked and self._present().source is source and state.question is None:
                    asked = now
                    dispatch(Asked(Conflict(source.file, now)))

    async def _saved(self, state: AppState, name: str, stamp: Stamp) -> Saved:
        return Saved(state.document, name, stamp, await self._names(), origin=state.source)

    async def _names(self) -> tuple[str, ...]:
        """Return the names in the folder, those known before if it cannot be read: the file itself was."""
        try:
            return await asyncio.to_thread(self._storage.names)
        except StorageError:
            return self._present().files


def _failed(text: str) -> Noticed:
    return Noticed(Notice(f"{text}.", is_error=True))
