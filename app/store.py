"""The one place where state changes: events go through ``update`` on viser's event loop, then every view renders."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from typing import Protocol

from app.state import AppState, Event, update

Dispatch = Callable[[Event], None]


class View(Protocol):
    """Something that shows the state, or acts on it."""

    def render(self, state: AppState) -> None:
        """Show ``state``; cheap when nothing that it shows has changed."""
        ...


class Store:
    """Holds the state.

    Attributes:
        state: The present state; replaced, never changed.
    """

    def __init__(self, state: AppState, loop: asyncio.AbstractEventLoop) -> None:
        self.state = state
        self._loop = loop
        self._views: list[View] = []

    def add(self, *views: View) -> None:
        """Render the state in new views too, from now on."""
        for view in views:
            self._views.append(view)
            view.render(self.state)

    def dispatch(self, event: Event) -> None:
        """Apply an event and render; on viser's event loop only."""
        self.state = update(self.state, event)
        for view in self._views:
            view.render(self.state)

    def post(self, event: Event) -> None:
        """Apply an event from any thread, in the order of posting."""
        self._loop.call_soon_threadsafe(self.dispatch, event)
