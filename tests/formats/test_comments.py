"""Comments that saving would lose are seen; what is none, or our own, is not."""

from __future__ import annotations

from pathlib import Path

import pytest

from app.__main__ import main
from fuzzy import formats
from fuzzy.formats.yaml_comments import comments, has_comments

RULEBASE = Path(__file__).parents[2] / "rulebases" / "diagonal.yaml"
SAVED = formats.dumps(formats.load(RULEBASE))


def test_what_the_workbench_writes_has_no_comments() -> None:
    assert not has_comments(SAVED)


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        ("name: diagonal", "name: diagonal  # why", 2),
        ("schema", "# head\nschema", 1),
        ("    cells:\n", "    cells:  # why\n", SAVED[: SAVED.index("    cells:")].count("\n") + 1),
    ],
)
def test_comments_are_found(old: str, new: str, line: int) -> None:
    assert [found[0] for found in comments(SAVED.replace(old, new, 1))] == [line]


@pytest.mark.parametrize("name", ["'a #b'", '"# x"', "a#b"])
def test_a_sharp_in_a_text_is_no_comment(name: str) -> None:
    assert not has_comments(SAVED.replace("name: diagonal", f"name: {name}", 1))


def test_a_sharp_in_notes_is_no_comment() -> None:
    assert not has_comments("schema: fuzzy-workbench/1\nnotes: |\n  # a heading\n  text # more\nname: x\n")
    assert not has_comments("'no yaml # at all")


def test_converting_over_comments_says_so_and_keeps_them(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    target = tmp_path / "d.yaml"
    target.write_text("# precious\n" + SAVED, encoding="utf-8")
    assert main(["convert", str(RULEBASE), str(target)]) == 0
    assert "d.yaml:1:1: warning: comments are lost; the file before is kept as d.yaml.bak" in capsys.readouterr().err
    assert (tmp_path / "d.yaml.bak").read_text(encoding="utf-8").startswith("# precious")
    assert target.read_text(encoding="utf-8") == SAVED
