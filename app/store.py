"""The one place where state changes: events go through ``update`` on viser's event loop, then the views render."""

from __future__ import annotations

import asyncio
import logging
import time
from collections.abc import Callable
from typing import Protocol

import msgspec

from app.logs import log_event
from app.state import AppState, Event, Notice, update

_log = logging.getLogger(__name__)

Dispatch = Callable[[Event], None]

TURN_SECONDS = 0.004
"""After how long the views let others have the event loop; one that has begun ends first."""

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

    def render(self, state: AppState) -> bool | None:
        """Show ``state``; sends nothing where that is shown already.

        Returns:
            Whether more is left to do: what takes some milliseconds is done in parts, others having their turn between.
        """
        ...


class Store:
    """Holds the state.

    Args:
        state: The state to begin with.
        loop: The event loop that all events are applied on.
        turn_seconds: After how long the views let others have the loop.

    Attributes:
        state: The present state; replaced, never changed.
    """

    def __init__(self, state: AppState, loop: asyncio.AbstractEventLoop, *, turn_seconds: float = TURN_SECONDS) -> None:
        self.state = state
        self._loop = loop
        self._turn_seconds = turn_seconds
        self._views: dict[View, Shown] = {}
        self._stale: dict[View, str] = {}  # with the event that made it so; who waits longest is first
        self._is_called = False
        self._is_closed = False

    def add(self, *views: View) -> None:
        """Render the state in new views too, from now on."""
        for view in views:
            while view.render(self.state):
                pass
            self._views[view] = view.shows(self.state)

    def dispatch(self, event: Event) -> None:
        """Apply an event and render the views whose part of the state it changed; on viser's event loop only.

        An event that changes nothing was refused, or asks for what is so already. The widget that sent it shows
        something else: then every view is rendered, which puts the widget back.

        Most events are shown when this returns. What takes longer goes on in later turns of the loop, with the state
        that is the newest by then.
        """
        if self._is_closed:
            return
        log_event(event)
        name = type(event).__name__
        before = self.state
        try:
            self.state = update(before, event)
        except Exception as error:
            _log.exception("%s cannot be applied", name)
            notice = Notice(f"Not done, an error of the program: {error!r}.", is_error=True)
            self.state = msgspec.structs.replace(before, notice=notice)
        if self.state is before:
            return
        is_answered = any(getattr(self.state, field) is not getattr(before, field) for field in _ANSWERS)
        for view, shown in self._views.items():
            if not is_answered or not self._is_shown(view, shown):
                self._stale.setdefault(view, name)
        self._render()

    def _is_shown(self, view: View, shown: Shown) -> bool:
        try:
            return is_same(view.shows(self.state), shown)
        except Exception:
            _log.exception("%s does not know what it shows", type(view).__name__)
            return True

    def _render(self) -> None:
        """Render what is stale for one turn of the loop, and order another if that was not all."""
        begin = time.perf_counter()
        while self._stale and not self._is_closed:
            view = next(iter(self._stale))
            name = self._stale.pop(view)
            try:
                if view.render(self.state):
                    self._stale[view] = name  # behind the others
                else:
                    self._views[view] = view.shows(self.state)
            except Exception:  # the others go on, and so does the program
                _log.exception("%s cannot show %s", type(view).__name__, name)
            if self._stale and time.perf_counter() - begin > self._turn_seconds:
                if not self._is_called:
                    self._is_called = True
                    self._loop.call_soon(self._go_on)
                return

    def _go_on(self) -> None:
        self._is_called = False
        self._render()

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
