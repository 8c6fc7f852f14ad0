"""What has been found out about immutable objects, by their identity.

Hashing or comparing a document takes longer than an edit of it may: after painting a cell all variables are the same
objects as before. An object that is kept here keeps its identity for itself, so that the same identity is the same
object; and since it cannot change, what was found out about it still holds.
"""

from __future__ import annotations

import functools
import threading
from collections.abc import Callable, Iterable
from typing import Any, Generic, TypeVar, cast

Found = TypeVar("Found")


class ByIdentity(Generic[Found]):
    """A table from immutable objects to what was found out about them together, the newest ``most`` entries."""

    def __init__(self, most: int) -> None:
        self._most = most
        self._known: dict[tuple[int, ...], tuple[tuple[object, ...], Found]] = {}
        self._lock = threading.Lock()

    def get(self, *objects: object) -> Found | None:
        """Return what was found out about these very objects, or None."""
        kept = self._known.get(tuple(map(id, objects)))
        return None if kept is None else kept[1]

    def get_each(self, objects: Iterable[object]) -> list[Found | None]:
        """Return what was found out about each of several objects alone, or None."""
        kept = map(self._known.get, zip(map(id, objects)))
        return [None if one is None else one[1] for one in kept]

    def put(self, found: Found, *objects: object) -> None:
        """Keep what was found out about objects that cannot change; of others, which have no hash, nothing is kept."""
        try:
            hash(objects)
        except TypeError:
            return
        with self._lock:
            self._known[tuple(map(id, objects))] = (objects, found)
            while len(self._known) > self._most:
                del self._known[next(iter(self._known))]


def remembered(most: int) -> Callable[[Callable[..., Found]], Callable[..., Found]]:
    """Let a function of immutable objects compute its result once for the same objects."""

    def decorate(function: Callable[..., Found]) -> Callable[..., Found]:
        known: ByIdentity[Found] = ByIdentity(most)

        @functools.wraps(function)
        def find(*objects: Any) -> Found:
            found = known.get(*objects)
            if found is None:
                found = function(*objects)
                known.put(found, *objects)
            return cast("Found", found)

        return find

    return decorate
