"""The paper's table, as the command prints it, within the tolerances that the project promises."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from app.__main__ import main
from robot import controllers, experiments
from robot.errors import RobotError
from tests.robot.test_simulation import CONTROLLER

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def report(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    import contextlib
    import io

    text = io.StringIO()
    with contextlib.redirect_stdout(text):
        assert main(["paper", "--seeds", "100", "--plants", "25", "--json"]) == 0
    return json.loads(text.getvalue())


def figure(report: dict[str, Any], case: str, variant: str, controller: str) -> dict[str, float]:
    (row,) = (
        row for row in report["rows"] if (row["case"], row["variant"], row["controller"]) == (case, variant, controller)
    )
    return row["overshoot"]


def test_the_calibration_meets_the_papers_four_figures(report: dict[str, Any]) -> None:
    assert figure(report, "clean", "raw", "pid")["mean"] == pytest.approx(2.8, abs=0.1)
    assert figure(report, "clean", "raw", "fuzzy_flc")["mean"] <= 0.05
    assert figure(report, "noisy", "raw", "pid")["mean"] == pytest.approx(16, abs=2)
    assert figure(report, "noisy", "raw", "fuzzy_flc")["mean"] == pytest.approx(2.3, abs=0.3)
    papers = {(row["case"], row["controller"]): row["paper"] for row in report["rows"]}
    assert papers["clean", "pid"] == 2.8
    assert papers["noisy", "pd_flc"] is None


def test_every_experiment_has_its_row_with_a_spread(report: dict[str, Any]) -> None:
    assert len(report["rows"]) == 12
    for row in report["rows"]:
        spread = row["overshoot"]
        assert spread["p5"] <= spread["mean"] <= spread["p95"]
        assert (spread["p5"] < spread["p95"]) == (row["case"] == "noisy")


def test_the_order_of_the_controllers_holds_where_the_step_is_feasible(report: dict[str, Any]) -> None:
    for variant in experiments.VARIANTS:
        pid, pd_flc, proposed = (
            figure(report, "noisy", variant, name)["mean"] for name in ("pid", "pd_flc", "fuzzy_flc")
        )
        assert proposed < pd_flc < pid


def test_the_calibration_is_printed_with_its_values(report: dict[str, Any]) -> None:
    calibration = report["calibration"]
    assert calibration["natural_frequency_rad_s"] == experiments.CALIBRATION.natural_frequency_rad_s
    assert calibration["seeds"] == 100
    text = (ROOT / "docs" / "reproduction.md").read_text(encoding="utf-8")
    for value in ("217", "36 ms", "8.65", "0.30", "48"):
        assert value in text


def test_robustness_lists_every_law(report: dict[str, Any]) -> None:
    rows = {row["controller"]: row for row in report["robustness"]["rows"]}
    assert tuple(rows) == controllers.NAMES
    assert report["robustness"]["plants"] == 25
    assert rows["adaptive_fuzzy_flc"]["error_median"] < 0.1 < rows["pd_flc"]["error_median"]


def test_the_raw_step_asks_for_kilonewtons_and_the_feasible_one_does_not() -> None:
    rows = experiments.overshoots(CONTROLLER, seeds=1)
    peak = {(row.case, row.variant, row.controller): row.peak_force for row in rows}
    assert peak["clean", "raw", "fuzzy_flc"] > 1000
    assert max(force for (_, variant, _), force in peak.items() if variant == "feasible") <= 60


def test_text_and_figures(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["paper", "--seeds", "2", "--plants", "0", "--plot", str(tmp_path / "new")]) == 0
    out = capsys.readouterr().out
    assert "Calibrated, not verified" in out
    assert "natural_frequency_rad_s" in out
    assert "robustness" not in out
    for name in ("figure5.png", "figure6.png", "sinus.png"):
        assert (tmp_path / "new" / name).read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize("words", [["--seeds", "0"], ["--seeds", "1000000"], ["--plants", "-1"]])
def test_hostile_numbers_are_refused(words: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["paper", *words]) == 2
    assert "valid is" in capsys.readouterr().err
    with pytest.raises(RobotError, match=r"seeds: found 0; valid: 1 to 100000"):
        experiments.overshoots(CONTROLLER, 0)
    with pytest.raises(RobotError, match=r"plants: found 0; valid: 1 to 100000"):
        experiments.robustness(CONTROLLER, 0)


def test_a_plot_that_cannot_be_written_is_a_failure_with_its_place(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "file"
    file.touch()
    assert main(["paper", "--seeds", "1", "--plants", "0", "--plot", str(file)]) == 1
    assert f"{file}:0:0: error: the folder cannot be made" in capsys.readouterr().err
