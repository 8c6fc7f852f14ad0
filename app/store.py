"""The one place where state changes: events go through ``update`` on viser's event loop, then the views render."""

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

Shown = tuple[object, ...]
"""Parts of a state; the same objects look the same, since nothing in a state is ever changed."""

_ANSWERS = tuple(name for name in AppState.__struct_fields__ if name != "notice")
"""What an event may change; the notice only says something about it."""


class View(Protocol):
    """Something that shows a part of the state, or acts on it."""

    def shows(self, state: AppState) -> Shown:
        """Return the parts of the state that ``render`` uses: it is called when one of them is another object.

        Where a widget's event replaces a part as a whole, that is the part, not a field of it: a value that was
        cleaned to what was there before is then put back into the widget.
        """
        ...

    def render(self, state: AppState) -> None:
        """Show ``state``; sends nothing where that is shown already."""
        ...


class Store:
    """Holds the state.

    Attributes:
        state: The present state; replaced, never changed.
    """

    def __init__(self, state: AppState, loop: asyncio.AbstractEventLoop) -> None:
        self.state = state
        self._loop = loop
        self._views: dict[View, Shown] = {}
        self._is_closed = False

    def add(self, *views: View) -> None:
        """Render the state in new views too, from now on."""
        for view in views:
            view.render(self.state)
            self._views[view] = view.shows(self.state)

    def dispatch(self, event: Event) -> None:
        """Apply an event and render the views whose part of the state it changed; on viser's event loop only.

        An event that changes nothing was refused, or asks for what is so already. The widget that sent it shows
        something else: then every view is rendered, which puts the widget back.
        """
        if self._is_closed:
            return
        log_event(event)
        before = self.state
        try:
            self.state = update(before, event)
        except Exception as error:
            _log.exception("%s cannot be applied", type(event).__name__)
            notice = Notice(f"Not done, an error of the program: {error!r}.", is_error=True)
            self.state = msgspec.structs.replace(before, notice=notice)
        if self.state is before:
            return
        is_answered = any(getattr(self.state, name) is not getattr(before, name) for name in _ANSWERS)
        for view, shown in self._views.items():
            try:
                now = view.shows(self.state)
                if is_answered and is_same(now, shown):
                    continue
                view.render(self.state)
                self._views[view] = now
            except Exception:  # the others go on, and so does the program
                _log.exception("%s cannot show %s", type(view).__name__, type(event).__name__)

    def post(self, event: Event) -> None:
        """Apply an event from any thread, in the order of posting."""
        if not self._is_closed:
            self._loop.call_soon_threadsafe(self.dispatch, event)

    def close(self) -> None:
        """Take no more events: what threads still find out comes too late for a server that is being stopped."""
        self._is_closed = True


def is_same(parts: Shown, others: Shown) -> bool:
    """Return whether two tuples hold the same objects."""
    return len(parts) == len(others) and all(a is b for a, b in zip(parts, others, strict=True))
