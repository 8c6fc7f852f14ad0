"""The commands of the palette, and their hotkeys."""

from __future__ import annotations

import logging
from collections.abc import Awaitable, Callable
from functools import partial
from typing import Any

import viser

from app.filing import Filing
from app.page.script import call
from app.page.texts import TABS
from app.state import Event, Notice, Noticed, PlaybackChanged, Redo, ResetRequested, RunKept, Undo
from app.store import Store
from app.views.playback import PlaybackView

_DIGITS = ("1", "2", "3", "4", "5", "6", "7")

_log = logging.getLogger(__name__)


def add_commands(gui: viser.GuiApi, store: Store, playback: PlaybackView, filing: Filing) -> None:
    """Register all commands.

    Args:
        gui: Where they are registered.
        store: Holds the state; where events go.
        playback: The controls of time.
        filing: Saves the document.
    """

    def add(label: str, to_event: Callable[[], Event | Awaitable[Event]], hotkey: Any, modifier: Any = None) -> None:
        async def act(_: viser.CommandEvent) -> None:
            try:
                meant = to_event()
                store.dispatch(await meant if isinstance(meant, Awaitable) else meant)
            except Exception as error:
                _log.exception("the command '%s' failed", label)
                store.dispatch(Noticed(Notice(f"Not done, an error of the program: {error!r}.", is_error=True)))

        gui.add_command(label, hotkey=hotkey, modifier=modifier).on_trigger(act)

    def play_or_pause() -> Event:
        return PlaybackChanged({"is_playing": not store.state.playback.is_playing})

    add("Undo", Undo, "Z", "cmd/ctrl")
    add("Redo", Redo, "Z", "cmd/ctrl+shift")
    add("Save", filing.save, "S", "cmd/ctrl")
    add("Play or pause", play_or_pause, "space")
    add("Reset", ResetRequested, "R")
    add("Step back", partial(playback.step, -1), "arrowleft")
    add("Step", partial(playback.step, 1), "arrowright")
    add("Keep the run as a baseline", RunKept, "K")

    def add_local(label: str, act: Callable[[viser.ClientHandle], None], hotkey: Any = None) -> None:
        """Register what happens in the one browser that asked for it."""

        async def local(event: viser.CommandEvent) -> None:
            if event.client is not None:
                act(event.client)

        gui.add_command(label, hotkey=hotkey).on_trigger(local)

    for digit, tab in zip(_DIGITS, TABS, strict=True):
        add_local(f"Show {tab}", partial(_show, tab), digit)
    add_local("Help: keys, gestures, panels (?)", lambda client: call(client, "help"))
    add_local("Tour", lambda client: call(client, "tour"))


def _show(tab: str, client: viser.ClientHandle) -> None:
    call(client, "showTab", tab)
