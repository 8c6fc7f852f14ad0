"""Where the shipped rule bases are edited: in place in a checkout, as a copy of one's own where they were installed."""

from __future__ import annotations

from pathlib import Path

import pytest

from app import shipped


def test_in_a_checkout_the_files_themselves_are_edited() -> None:
    assert shipped.is_checkout()
    assert shipped.editable() == shipped.SHIPPED


def test_of_an_installed_program_a_copy_is_edited_and_never_replaced(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))
    monkeypatch.setattr(shipped, "is_checkout", lambda: False)
    path = shipped.editable()
    assert path.is_relative_to(tmp_path)
    assert path.read_bytes() == shipped.SHIPPED.read_bytes()
    assert {file.name for file in path.parent.iterdir()} == {file.name for file in shipped.SHIPPED.parent.iterdir()}
    path.write_text("mine")
    (path.parent / "piltan.yaml").unlink()
    assert shipped.editable().read_text() == "mine"
    assert (path.parent / "piltan.yaml").is_file()
