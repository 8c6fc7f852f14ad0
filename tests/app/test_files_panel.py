"""Design › Files without a browser: duplicates, uploads and downloads in every format, any step of the history."""

from __future__ import annotations

import asyncio
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any, cast

import pytest
import viser

from app import guard
from app.state import AppState, Edit, Imported, Undo
from app.views.files.exchange import file_stem, read_upload
from fuzzy import edits, formats
from fuzzy.errors import FormatError
from fuzzy.formats import load, save
from fuzzy.system import FuzzySystem
from tests.app.test_views import DIAGONAL, PILTAN, Screen, hostile


@pytest.fixture
def screen(tmp_path: Path) -> Iterator[Screen]:
    save(DIAGONAL, tmp_path / "mine.yaml")
    server = guard.start_server(port=0)
    yield Screen(server, tmp_path, DIAGONAL)
    server.stop()


class Browser:
    """A browser that keeps what it is sent."""

    def __init__(self) -> None:
        self.files: dict[str, bytes] = {}

    def send_file_download(self, name: str, content: bytes, save_immediately: bool = False) -> None:
        assert save_immediately
        self.files[name] = content


def call(screen: Screen, callback: Any, value: object, client: object) -> AppState:
    """Do what viser does when a browser presses or uploads."""
    event = cast("Any", viser.GuiEvent)(client=client, client_id=0, target=type("Target", (), {"value": value})())
    asyncio.run_coroutine_threadsafe(callback(event), screen.loop).result(60)
    return screen.store.state


def upload(screen: Screen, name: str, content: bytes) -> AppState:
    file = type("File", (), {"name": name, "content": content})()
    return call(screen, screen.view("ExchangeView")._receive, file, object())


def error(state: AppState) -> str:
    assert state.notice is not None
    assert state.notice.is_error
    return state.notice.text


def painted(row: int) -> Edit:
    return Edit(f"paint {row}", partial(edits.set_cell, row=row, column=0, consequent="LR"))


def test_a_duplicate_is_a_new_file_and_the_open_one(screen: Screen, tmp_path: Path) -> None:
    screen.dispatch(painted(0))
    for name in ("mine-copy.yaml", "mine-copy-copy.yaml"):
        state = screen.send(screen.find("file"), "duplicate")
        assert (state.file, state.is_unsaved) == (name, False)
        assert load(tmp_path / name) == state.document
    assert load(tmp_path / "mine.yaml") == DIAGONAL


@pytest.mark.parametrize("suffix", [".yaml", ".fis", ".fll", ".fcl", ".xml"])
def test_what_is_downloaded_can_be_uploaded_in_every_format(screen: Screen, suffix: str) -> None:
    browser = Browser()
    state = call(screen, screen.view("ExchangeView")._download, suffix, browser)
    assert state.notice is not None
    assert not state.notice.is_error
    content = browser.files[f"mine{suffix}"]
    state = upload(screen, f"other{suffix}", content)
    assert state.upload is not None
    assert state.document is DIAGONAL, "nothing is replaced before the answer"
    assert [v.name for v in state.upload.document.inputs] == ["e", "de"]
    state = screen.send(screen.view("ExchangeView")._answer, "replace the document")
    assert (state.document.rules, state.file, state.is_unsaved) == (DIAGONAL.rules, None, True)
    assert (state.new_name, state.upload) == ("other", None)
    assert "choose a name" in error(screen.send(screen.find("file"), "save"))
    state = screen.dispatch(Undo())
    assert (state.document, state.file) == (DIAGONAL, "mine.yaml")


def test_an_upload_can_be_discarded(screen: Screen) -> None:
    upload(screen, "other.yaml", formats.dumps(PILTAN).encode())
    state = screen.send(screen.view("ExchangeView")._answer, "discard")
    assert state.upload is None
    assert state.document is DIAGONAL
    assert screen.dispatch(Imported()).document is DIAGONAL, "there is nothing to import"


def test_what_the_import_left_out_and_the_check_finds_stand_in_the_page(screen: Screen) -> None:
    document = edits.clear_table(DIAGONAL)
    state = upload(screen, "other.yaml", formats.dumps(document).encode())
    assert state.upload is not None
    assert state.upload.findings
    assert "no rule tests" in screen.view("ExchangeView")._found.content
    assert "more</span>" in screen.view("ExchangeView")._found.content


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("a.exe", b"x", "Refused: the file name"),
        ("../a.yaml", b"x", "Refused: the file name"),
        ("a.yaml", b"x" * (2 << 20), "valid are at most 1048576"),
        ("a.yaml", b"\xff\xfe\x00", "Not read: a.yaml"),
        ("a.yaml", b"schema: fuzzy-workbench/1\nname: [", "Not read: a.yaml"),
        ("a.fis", b"nothing of the kind", "Not read: a.fis"),
        ("a.xml", b"<!DOCTYPE x [<!ENTITY a 'b'>]><fuzzySystem/>", "Not read: a.xml"),
    ],
)
def test_an_upload_that_cannot_be_read_is_refused(screen: Screen, name: str, content: bytes, message: str) -> None:
    state = upload(screen, name, content)
    assert message in error(state)
    assert state.upload is None


def test_a_click_in_the_history_leads_there(screen: Screen) -> None:
    documents: list[FuzzySystem] = [DIAGONAL, *(screen.dispatch(painted(row)).document for row in range(3))]
    assert "as it was opened" in screen.view("HistoryView")._rows.content
    state = screen.send(screen.find("step 3 of the history"), True)
    assert state.document == documents[1], "the newest stands above"
    assert (len(state.past), len(state.future)) == (1, 2)
    state = screen.send(screen.find("step 1 of the history"), True)
    assert state.document == documents[3]
    state = screen.send(screen.find("step 4 of the history"), True)
    assert state.document == documents[0]
    before = screen.store.state
    assert screen.send(screen.find("step 4 of the history"), True) is before, "that is where it is"
    assert screen.send(screen.find("step 19 of the history"), True) is before, "there are not so many"


def test_a_title_is_edited_and_its_file_stem_is_plain(screen: Screen) -> None:
    assert screen.send(screen.find("title"), "my own").document.name == "my own"
    assert "the title" in error(screen.send(screen.find("title"), ""))
    state = screen.open(hostile(DIAGONAL))
    assert file_stem(state) == "other"
    upload(screen, "x.yaml", formats.dumps(hostile(DIAGONAL)).encode())
    state = screen.dispatch(Imported())
    assert all(letter.isalnum() or letter == "-" for letter in file_stem(state))


def test_reading_an_upload_names_the_place_of_a_mistake() -> None:
    with pytest.raises(FormatError, match=r"a\.yaml:\d+:\d+: .*heap"):
        read_upload("a.yaml", formats.dumps(DIAGONAL).replace("triangle:", "heap:", 1).encode())
