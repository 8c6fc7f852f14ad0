"""The example scripts run, from the project's folder, and print what they promise."""

from __future__ import annotations

import runpy
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]


@pytest.mark.parametrize(
    ("name", "arguments", "promised"),
    [
        ("simulate_a_step", (), "overshoot 0.00 %"),
        ("simulate_a_step", ("rulebases/piltan.yaml",), "settled after"),
        ("compare_controllers", (), "adaptive_fuzzy_pid"),
        ("fit_an_approximator", (), "121 rules"),
        ("study_robustness", ("4",), "fuzzy_flc"),
    ],
)
def test_it_runs(
    name: str,
    arguments: tuple[str, ...],
    promised: str,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(ROOT)
    monkeypatch.setattr(sys, "argv", [name, *arguments])
    runpy.run_path(str(ROOT / "examples" / f"{name}.py"), run_name="__main__")
    assert promised in capsys.readouterr().out


def test_every_example_is_run() -> None:
    names = {path.stem for path in (ROOT / "examples").glob("*.py")}
    assert names == {"simulate_a_step", "compare_controllers", "fit_an_approximator", "study_robustness"}
