"""Commands and the page's own script, without a browser: what is registered, and what goes to which browser."""

from __future__ import annotations

import asyncio
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import pytest
from viser import _messages

from app import guard
from app.filing import Filing
from app.page import add_commands, install
from app.page.texts import TABS
from app.state import Edit
from app.storage import Storage
from fuzzy import edits
from fuzzy.formats import save
from tests.app.test_views import DIAGONAL, Screen


class Browser:
    """A browser that notes the scripts that it is sent."""

    def __init__(self) -> None:
        self.scripts: list[str] = []
        self._websock_connection = SimpleNamespace(queue_message=self._take)

    def _take(self, message: _messages.Message) -> None:
        assert isinstance(message, _messages.RunJavascriptMessage)
        self.scripts.append(message.source)


@pytest.fixture
def screen(tmp_path: Path) -> Iterator[Screen]:
    save(DIAGONAL, tmp_path / "mine.yaml")
    server = guard.start_server(port=0)
    made = Screen(server, tmp_path, DIAGONAL)
    playback = next(view for view in made.views if type(view).__name__ == "PlaybackView")
    add_commands(server.gui, made.store, playback, Filing(Storage(tmp_path), lambda: made.store.state))
    yield made
    server.stop()


def trigger(screen: Screen, label: str, browser: Browser) -> None:
    handles = screen.server.gui._command_handle_from_uuid.values()
    handle = next(one for one in handles if one.label == label)
    for callback in handle._impl.trigger_cb:
        event = SimpleNamespace(client=browser, client_id=0, target=handle)
        asyncio.run_coroutine_threadsafe(cast("Any", callback)(event), screen.loop).result(60)


def test_every_hotkey_is_another_and_the_palette_names_them(screen: Screen) -> None:
    commands = screen.server.gui._command_handle_from_uuid.values()
    keys = [(one.hotkey, one.modifier) for one in commands if one.hotkey is not None]
    assert len(set(keys)) == len(keys)
    assert {(str(number), None) for number in range(1, 8)} <= set(keys)
    assert {("space", None), ("arrowleft", None), ("S", "cmd/ctrl"), ("Z", "cmd/ctrl"), ("Z", "cmd/ctrl+shift")} <= set(
        keys
    )


def test_what_concerns_one_browser_goes_to_it_alone_and_changes_nothing(screen: Screen) -> None:
    state, browser, other = screen.store.state, Browser(), Browser()
    for tab in TABS:
        trigger(screen, f"Show {tab}", browser)
    trigger(screen, "Help: keys, gestures, panels (?)", browser)
    trigger(screen, "Tour", browser)
    assert [script.partition("?.")[2] for script in browser.scripts] == [
        *(f'showTab("{tab}")' for tab in TABS),
        "help()",
        "tour()",
    ]
    assert other.scripts == []
    assert screen.store.state is state


def test_commands_act_on_the_document_and_on_the_file(screen: Screen, tmp_path: Path) -> None:
    screen.dispatch(Edit("name", lambda system: edits.set_name(system, "another")))
    trigger(screen, "Undo", Browser())
    assert screen.store.state.document == DIAGONAL
    trigger(screen, "Redo", Browser())
    assert screen.store.state.document.name == "another"
    trigger(screen, "Play or pause", Browser())
    assert not screen.store.state.playback.is_playing
    trigger(screen, "Step", Browser())
    assert screen.store.state.playback.source == "replay"


def test_the_script_brings_its_words_and_no_name_of_the_document(screen: Screen) -> None:
    hostile = "</script><script>alert(1)</script>"
    screen.dispatch(Edit("name", lambda system: edits.set_name(system, hostile)))
    browser = Browser()
    install(cast("Any", browser))
    (script,) = browser.scripts
    assert script.startswith("const content = {")
    assert "Shift + drag the arm" in script
    assert "An arm that answers" in script
    assert hostile not in script
