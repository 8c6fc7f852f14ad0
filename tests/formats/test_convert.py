"""``convert``, and the other commands on every format and on standard streams."""

from __future__ import annotations

import io
import sys
from pathlib import Path

import numpy as np
import pytest

from app.__main__ import main
from fuzzy import compile_system, formats
from fuzzy.system import FuzzySystem

RULEBASE = Path(__file__).parents[2] / "rulebases" / "diagonal.yaml"


class _Stdin:
    """Standard input that holds bytes."""

    def __init__(self, content: bytes) -> None:
        self.buffer = io.BytesIO(content)


@pytest.fixture
def diagonal() -> FuzzySystem:
    return formats.load(RULEBASE)


@pytest.mark.parametrize("suffix", ["fis", "fll", "fcl", "xml"])
def test_to_another_format_and_back(tmp_path: Path, suffix: str, diagonal: FuzzySystem) -> None:
    there, back = tmp_path / f"d.{suffix}", tmp_path / "d.yaml"
    assert main(["convert", str(RULEBASE), str(there)]) == 0
    assert main(["convert", str(there), str(back)]) == 0
    again = formats.load(back)
    assert again.rules == diagonal.rules
    grid = np.random.default_rng(0).uniform((-1, -6), (1, 6), (200, 2))
    np.testing.assert_allclose(compile_system(again).batch(grid), compile_system(diagonal).batch(grid), atol=1e-11)


def test_what_cannot_be_said_fails_and_leaves_no_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    source, target = tmp_path / "d.yaml", tmp_path / "d.fcl"
    text = RULEBASE.read_text(encoding="utf-8").replace("implication: min", "implication: kleene_dienes")
    source.write_text(text, encoding="utf-8")
    assert main(["convert", str(source), str(target)]) == 1
    assert "cannot say 'kleene_dienes'; --lossy writes 'min'" in capsys.readouterr().err
    assert not target.exists()
    assert main(["convert", str(source), str(target), "--lossy"]) == 0
    warnings = capsys.readouterr().err.splitlines()
    assert "written is 'min'" in warnings[0]
    assert "the outputs differ by at most" in warnings[1]
    assert formats.load(target).inference.implication == "min"


def test_pipes(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    monkeypatch.setattr(sys, "stdin", _Stdin(RULEBASE.read_bytes()))
    assert main(["convert", "-", "-", "--to", "fll"]) == 0
    fll = capsys.readouterr().out
    assert fll.startswith("# fuzzy-workbench/1 resolution: exact\nEngine: diagonal\n")
    monkeypatch.setattr(sys, "stdin", _Stdin(fll.encode()))
    assert main(["check", "-"]) == 0
    monkeypatch.setattr(sys, "stdin", _Stdin(fll.encode()))
    assert main(["explain", "-", "e=0.2", "de=-1"]) == 0
    assert "rules fire" in capsys.readouterr().out
    for word in ("fml", "xml"):  # the format, and its suffix
        monkeypatch.setattr(sys, "stdin", _Stdin(fll.encode()))
        assert main(["convert", "-", "-", "--to", word]) == 0
        assert "<fuzzySystem" in capsys.readouterr().out
    path = tmp_path / "d.fll"
    path.write_text(fll, encoding="utf-8")
    monkeypatch.setattr(sys, "stdin", _Stdin(b"e,de\n0.2,-1\n"))
    assert main(["infer", str(path), "--inputs", "-", "--output", "-"]) == 0
    header, value = capsys.readouterr().out.split()
    assert (header, float(value)) == ("T", compile_system(formats.load(path))(0.2, -1))


def test_wrong_use(capsys: pytest.CaptureFixture[str]) -> None:
    for words, message in (
        (["-", "-"], "--to names what to write"),
        ([str(RULEBASE), "x.docx"], "unknown suffix '.docx'"),
        ([str(RULEBASE), "x.fis", "--table", "5"], "--table is for c, csv and npz only"),
        ([str(RULEBASE), "x.py", "--single"], "--single is for c only"),
    ):
        assert main(["convert", *words]) == 2
        assert message in capsys.readouterr().err
    assert main(["infer", "-", "--inputs", "-", "--output", "x.csv"]) == 2


def test_the_check_names_places_in_every_format(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "d.fll"
    text = formats.write(formats.load(RULEBASE), "fll").text
    path.write_text(text.replace("  term: LL ", "  term: unused Triangle -80 0 80\n  term: LL "), encoding="utf-8")
    main(["check", str(path)])
    line = next(number for number, line in enumerate(path.read_text().splitlines(), 1) if "unused" in line)
    assert f"{path}:{line}:" in capsys.readouterr().out


def test_a_table_of_the_surface(tmp_path: Path, diagonal: FuzzySystem) -> None:
    csv, npz = tmp_path / "d.csv", tmp_path / "d.npz"
    assert main(["convert", str(RULEBASE), str(csv), "--table", "5"]) == 0
    rows = np.loadtxt(csv, delimiter=",", skiprows=1)
    np.testing.assert_array_equal(rows[:, 2:], compile_system(diagonal).batch(rows[:, :2]))
    assert main(["convert", str(RULEBASE), str(npz), "--table", "5"]) == 0
    with np.load(npz) as found:
        assert found["names"].tolist() == ["e", "de", "T"]
        np.testing.assert_array_equal(found["output_0"].ravel(), rows[:, 2])
