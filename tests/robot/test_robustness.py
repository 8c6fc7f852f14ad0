"""The study of robustness: the worst coordinate's figures, what is infinite stays so, and it can be given up."""

from __future__ import annotations

import math

import msgspec
import numpy as np
import pytest

from robot import experiments
from robot.controllers import PdFlc
from robot.robustness import histogram, percentile, random_arms, study
from robot.scenario import Scenario
from robot.simulation import simulate
from tests.robot.test_simulation import CONTROLLER, SOFT, STEP

SHORT = msgspec.structs.replace(STEP, duration=1.1)
ARMS = random_arms(SOFT, 4, seed=5)


def test_every_arm_counts_with_its_worst_coordinate() -> None:
    controller = experiments.law("pid", CONTROLLER)
    found = study(ARMS, controller, SHORT)
    for number, arm in enumerate(ARMS):
        metrics = simulate(arm, controller, SHORT).metrics()
        assert found.overshoot[number] == metrics.overshoot["worst"]
        assert found.rms_error[number] == pytest.approx(metrics.rms_error["worst"], rel=0.01)
    assert not found.stopped.any()


def test_a_task_without_a_step_has_no_overshoot_but_an_error() -> None:
    circle = msgspec.structs.replace(Scenario.preset("circle"), duration=0.5)
    found = study(ARMS[:2], experiments.law("pid", CONTROLLER), circle)
    assert np.isnan(found.overshoot).all()
    assert (found.rms_error > 0.0).all()
    assert math.isnan(percentile(found.overshoot, 50))


def test_arms_that_run_away_stay_infinite_in_percentiles_and_out_of_the_histogram() -> None:
    found = study(ARMS[:2], PdFlc(SOFT, (1e6,) * 6, (1e5,) * 6), STEP)
    assert found.stopped.all()
    assert percentile(found.overshoot, 50) == math.inf
    assert percentile(np.array([1.0, 2.0, math.inf]), 50) == 2.0
    assert percentile(np.array([1.0, 2.0, math.inf]), 95) == math.inf
    edges, (wild, tame) = histogram([found.overshoot, np.array([0.0, 1.0, 4.0, math.nan])], bins=4)
    assert edges[0] == 0.0
    assert edges[-1] == 4.0
    assert wild.sum() == 0
    assert tame.tolist() == [1, 1, 0, 1]


def test_what_progress_raises_ends_it() -> None:
    told: list[int] = []

    def give_up(runs: int) -> None:
        told.append(runs)
        raise InterruptedError

    with pytest.raises(InterruptedError):
        study(random_arms(SOFT, 200), experiments.law("pid", CONTROLLER), SHORT, progress=give_up, workers=1)
    assert len(told) == 1
    assert told[0] < 20
