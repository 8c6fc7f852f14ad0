"""Batches: the same figures as single runs, in any number of threads."""

from __future__ import annotations

import math

import msgspec
import numpy as np
import pytest

from robot import experiments
from robot.arm import Arm
from robot.batch import batch_simulate
from robot.controllers import PdFlc, Pid
from robot.disturbance import BandLimitedNoise
from robot.errors import RobotError
from robot.robustness import random_arms
from robot.scenario import Scenario
from robot.simulation import simulate
from tests.robot.test_simulation import CONTROLLER, SOFT, STEP, law

SHORT = msgspec.structs.replace(STEP, duration=1.1)


@pytest.mark.parametrize("name", ["pid", "fuzzy_flc", "adaptive_fuzzy_flc"])
def test_a_batch_has_the_figures_of_its_single_runs(name: str) -> None:
    arms = random_arms(SOFT, 5, seed=3)
    scenarios = [msgspec.structs.replace(SHORT, disturbance=BandLimitedNoise(0.1, 0.01, seed)) for seed in range(5)]
    controller = experiments.law(name, CONTROLLER)
    batch = batch_simulate(arms, controller, scenarios)
    for k, (arm, scenario) in enumerate(zip(arms, scenarios, strict=True)):
        run = simulate(arm, controller, scenario)
        metrics = run.metrics()
        for i, coordinate in enumerate(SOFT.coordinates):
            assert batch.overshoot[k, i] == metrics.overshoot[coordinate]
            assert batch.steady_state_error[k, i] == pytest.approx(metrics.steady_state_error[coordinate], abs=0.1)
            assert batch.rms_error[k, i] == pytest.approx(metrics.rms_error[coordinate], rel=0.01)
            settling = metrics.settling_time[coordinate]
            assert batch.settling_time[k, i] == pytest.approx(settling, abs=0.0015)
        np.testing.assert_array_equal(batch.peak_force[k], np.abs(run.forces).max(axis=0))
    assert not batch.stopped.any()


def test_the_number_of_threads_does_not_matter_and_progress_is_told() -> None:
    arms = random_arms(SOFT, 30, seed=1)
    told: list[int] = []
    one = batch_simulate(arms, law("pid"), SHORT, workers=1)
    many = batch_simulate(arms, law("pid"), SHORT, workers=3, progress=told.append)
    for left, right in zip(one, many, strict=True):
        np.testing.assert_array_equal(left, right)
    assert told == sorted(told)
    assert told[-1] == 30


def test_runs_that_run_away_have_infinite_figures() -> None:
    unstable = PdFlc(SOFT, (1e6,) * 6, (1e5,) * 6)
    batch = batch_simulate([SOFT, SOFT], unstable, STEP)
    assert batch.stopped.all()
    assert np.isinf(batch.overshoot).all()


def test_what_is_not_a_step_has_no_overshoot() -> None:
    sinus = msgspec.structs.replace(Scenario.preset("sinus"), duration=0.5)
    batch = batch_simulate(SOFT, law("pid"), sinus)
    assert np.isnan(batch.overshoot).all()
    assert np.isfinite(batch.rms_error).all()


def test_arms_and_scenarios_in_different_numbers_are_refused() -> None:
    for arms, scenarios in (([SOFT] * 2, [STEP] * 3), ([], [])):
        with pytest.raises(RobotError, match=r"found .* arms and .* scenarios; valid"):
            batch_simulate(arms, law("pid"), scenarios)


def test_a_run_that_does_not_fit_ends_the_batch() -> None:
    with pytest.raises(RobotError, match="found gains for 4 coordinates"):
        batch_simulate([SOFT] * 20, Pid((1.0,) * 4, (1.0,) * 4, (1.0,) * 4), STEP)


def test_random_arms_are_within_their_spread_and_repeat() -> None:
    arms = random_arms(SOFT, 50, 0.3, seed=9)
    assert arms == random_arms(SOFT, 50, 0.3, seed=9)
    assert len(set(arms)) == 50
    ratio = np.array([arm.mass for arm in arms]) / np.array(SOFT.mass)
    assert ratio.min() >= 0.7
    assert ratio.max() <= 1.3
    assert ratio.std() == pytest.approx(0.6 / math.sqrt(12), rel=0.2)
    assert all(isinstance(arm, Arm) and arm.rod_length == SOFT.rod_length for arm in arms)
