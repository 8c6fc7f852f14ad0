"""Logs: a line for what matters, on its line whatever names hold, and never a secret."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from pathlib import Path

import pytest

from app import guard, logs
from app.state import Asked, Conflict, Notice, Noticed, Opened, Progressed, Saved, Undo
from app.storage import Stamp
from fuzzy.formats import load
from tests.app.test_guard import TOKEN, get, open_websocket, running

DIAGONAL = load(Path(__file__).parents[2] / "rulebases" / "diagonal.yaml")
STAMP = Stamp(1, 2, "3")


@pytest.fixture
def log(tmp_path: Path) -> Iterator[Path]:
    root, names = logging.getLogger(), (*logs._PACKAGES, "app.guard.websockets")
    handlers, levels = root.handlers[:], [logging.getLogger(name).level for name in names]
    yield tmp_path / "workbench.log"
    for handler in root.handlers:
        if handler not in handlers:
            handler.close()
    root.handlers[:] = handlers
    for name, level in zip(names, levels, strict=True):
        logging.getLogger(name).setLevel(level)


def test_what_matters_has_a_line_each(log: Path, capsys: pytest.CaptureFixture[str]) -> None:
    logs.configure("info", log)
    for event in (
        Opened(DIAGONAL, "a.yaml", STAMP, ()),
        Saved(DIAGONAL, "a.yaml", STAMP, ()),
        Asked(Conflict("a.yaml", STAMP)),
        Noticed(Notice("Not saved: the disk is full.", is_error=True)),
        Noticed(Notice("Saved.")),
        Progressed("compiling"),
        Undo(),
    ):
        logs.log_event(event)
    lines = log.read_text(encoding="utf-8").splitlines()
    assert [line.split(": ", 1)[1] for line in lines] == [
        "opened a.yaml",
        "saved a.yaml",
        "a.yaml was changed on disk by somebody else",
        "Not saved: the disk is full.",
    ]
    assert capsys.readouterr().err.splitlines() == lines


def test_a_name_cannot_forge_a_line(log: Path) -> None:
    logs.configure("info", log)
    logs.log_event(Opened(DIAGONAL, "a\n2026-01-01 ERROR \x1b[31mforged", STAMP, ()))
    assert len(log.read_text(encoding="utf-8").splitlines()) == 1
    assert "\x1b" not in log.read_text(encoding="utf-8")


def test_no_secret_is_logged_at_any_level(log: Path) -> None:
    logs.configure("debug", log)
    with running(TOKEN) as server:
        assert get(server, f"/?token={TOKEN}").status == 303
        cookie = f"fuzzy_workbench_{server.get_port()}={TOKEN}"
        assert get(server, Cookie=cookie).status == 200
        assert get(server, "/?token=wrong-but-secret-0123").status == 403
        with open_websocket(server, Cookie=cookie) as websocket:
            assert websocket.recv(timeout=10)
    logging.getLogger("app").debug("written")
    text = log.read_text(encoding="utf-8")
    assert "written" in text
    assert TOKEN not in text
    assert "wrong-but-secret" not in text


def test_a_log_file_that_cannot_be_written_is_an_error(log: Path) -> None:
    with pytest.raises(OSError, match="No such file"):
        logs.configure("info", log.parent / "missing" / "workbench.log")


def test_the_logger_that_is_silenced_is_the_one_that_the_server_uses() -> None:
    assert guard._quiet_logger().name == "app.guard.websockets"
