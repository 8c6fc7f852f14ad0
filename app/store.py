"""The one place where state changes: events go through ``update`` on viser's event loop, then every view renders."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Callable
from typing import Protocol

import msgspec

from app.logs import log_event
from app.state import AppState, Event, Notice, update

_log = logging.getLogger(__name__)

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
        log_event(event)
        try:
            self.state = update(self.state, event)
        except Exception as error:
            _log.exception("%s cannot be applied", type(event).__name__)
            notice = Notice(f"Not done, an error of the program: {error!r}.", is_error=True)
            self.state = msgspec.structs.replace(self.state, notice=notice)
        for view in self._views:
            try:
                view.render(self.state)
            except Exception:  # the others go on, and so does the program
                _log.exception("%s cannot show %s", type(view).__name__, type(event).__name__)

    def post(self, event: Event) -> None:
        """Apply an event from any thread, in the order of posting."""
        self._loop.call_soon_threadsafe(self.dispatch, event)
