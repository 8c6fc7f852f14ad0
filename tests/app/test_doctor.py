"""The doctor says what is wrong and what to do about it."""

from __future__ import annotations

import json
import socket
from pathlib import Path
from typing import Any

import pytest

from app.__main__ import main
from app.commands import doctor


@pytest.fixture(autouse=True)
def free_port(monkeypatch: pytest.MonkeyPatch) -> int:
    with socket.create_server(("127.0.0.1", 0)) as probe:
        port = probe.getsockname()[1]
    monkeypatch.setattr(doctor, "_PORT", port)
    return port


def examined(capsys: pytest.CaptureFixture[str], expected: int) -> dict[str, dict[str, Any]]:
    assert main(["doctor", "--json"]) == expected
    return {one["what"]: one for one in json.loads(capsys.readouterr().out)}


def test_a_healthy_machine_has_no_problem(capsys: pytest.CaptureFixture[str]) -> None:
    found = examined(capsys, 0)
    assert {"Python", "viser", "numba", "compiled kernels", "journals", "rule bases", "browser"} <= set(found)
    assert all(one["level"] == "ok" for one in found.values())
    assert main(["doctor"]) == 0
    assert "viser" in capsys.readouterr().out


def test_a_folder_that_cannot_be_written_and_a_busy_port_are_problems_with_advice(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path, free_port: int
) -> None:
    (tmp_path / "file").write_text("no folder")
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "file"))
    with socket.create_server(("127.0.0.1", free_port)):
        found = examined(capsys, 1)
    problems = {what: one["advice"] for what, one in found.items() if one["level"] == "problem"}
    assert set(problems) == {"journals", f"port {free_port}"}
    assert "XDG_STATE_HOME" in problems["journals"]
    assert "--port" in problems[f"port {free_port}"]


def test_work_that_was_left_is_mentioned(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    place = tmp_path / "fuzzy-workbench" / "journals"
    place.mkdir(parents=True)
    (place / "0123456789abcdef-0123456789abcdef.journal").write_bytes(b"x")
    assert "1 journals" in examined(capsys, 0)["unsaved work"]["found"]
