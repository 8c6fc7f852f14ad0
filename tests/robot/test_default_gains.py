"""The default gains do what the paper claims for its controller: better than PID, at rest and under noise."""

from __future__ import annotations

import msgspec
import pytest

import fuzzy
from robot import controllers
from robot.arm import Arm
from robot.disturbance import BandLimitedNoise
from robot.scenario import Scenario
from robot.simulation import simulate

_INFERENCE = fuzzy.compile_system(fuzzy.load("rulebases/diagonal.yaml"))
_SOFT = Arm.preset("soft")


def overshoot(name: str, scenario: Scenario) -> float:
    law = controllers.default(name, _SOFT, scenario, _INFERENCE)
    return simulate(_SOFT, law, scenario).metrics().overshoot["s1"]


def test_the_proposed_controller_does_not_overshoot_where_pid_does() -> None:
    step = Scenario.preset("step")
    assert overshoot("fuzzy_flc", step) == pytest.approx(0.0, abs=0.05)
    assert overshoot("pid", step) == pytest.approx(2.8, abs=0.1)


@pytest.mark.parametrize("seed", range(5))
def test_it_holds_against_noise_better_than_pid(seed: int) -> None:
    step = Scenario.preset("step")
    noisy = msgspec.structs.replace(step, disturbance=BandLimitedNoise(seed=seed))
    assert overshoot("fuzzy_flc", noisy) < 0.5 * overshoot("pid", noisy)
    slow = controllers.default("fuzzy_flc", _SOFT, noisy, _INFERENCE, natural_frequency=12.0)
    assert simulate(_SOFT, slow, noisy).metrics().overshoot["s1"] > overshoot("pid", noisy)


def test_the_bandwidth_follows_the_disturbance() -> None:
    step = Scenario.preset("step")
    noisy = Scenario.preset("step_noise")
    assert controllers.default_natural_frequency(step) == controllers.default_natural_frequency(
        Scenario.preset("sinus")
    )
    assert controllers.default_natural_frequency(Scenario.preset("hold")) == controllers.default_natural_frequency(
        noisy
    )
    seen = msgspec.structs.replace(step, disturbance=BandLimitedNoise(channel="measurement"))
    assert controllers.default_natural_frequency(seen) == controllers.default_natural_frequency(step)
    assert controllers.default_natural_frequency(noisy) > 10 * controllers.default_natural_frequency(step)
