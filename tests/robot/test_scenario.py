"""Scenarios and disturbances: values, presets, repeatability, refusals."""

from __future__ import annotations

import math
from typing import Any

import msgspec
import numpy as np
import pytest

import robot.scenario
from robot.arm import Arm, parameters
from robot.disturbance import BLOCK, BandLimitedNoise
from robot.errors import InvalidScenarioError, UnknownNameError
from robot.scenario import Mismatch, Scenario, Sinus, Step


def test_every_name_is_a_scenario_equal_to_itself() -> None:
    assert robot.scenario.names()[0] == "step"
    assert "sinus" in robot.scenario.names()
    for name in robot.scenario.names():
        assert Scenario.preset(name) == Scenario.preset(name)
        assert Scenario.preset(name).name == name


def test_the_standard_step() -> None:
    step = Scenario.preset("step")
    np.testing.assert_array_equal(step.amplitude(3), [0.03, 0.03, 0.03, 0.3, 0.3, 0.3])
    np.testing.assert_array_equal(step.amplitude(1), [0.03, 0.3])
    assert (step.duration, step.n_steps, step.disturbance) == (3.0, 3000, None)
    assert step.plant(Arm.preset("soft")) == Arm.preset("soft")


def test_amplitudes_of_single_modules() -> None:
    scenario = Scenario(name="one", reference=Step(extension=[0.03, 0, -0.02], bend=0.0))
    np.testing.assert_array_equal(scenario.amplitude(3), [0.03, 0, -0.02, 0, 0, 0])
    np.testing.assert_array_equal(scenario.scale(3), [0.03, 0.03, 0.02, 0.3, 0.3, 0.3])
    with pytest.raises(InvalidScenarioError, match=r"reference.extension: found 3 values; valid: 1, or 2"):
        scenario.amplitude(2)


def test_mismatch_makes_another_plant() -> None:
    arm = Arm.preset("soft")
    plant = msgspec.structs.replace(Scenario.preset("step"), mismatch=Mismatch(stiffness=1.3)).plant(arm)
    np.testing.assert_allclose(parameters(plant).stiffness, 260)
    assert plant.mass == arm.mass


def test_an_unknown_name_is_refused_with_the_valid_ones() -> None:
    with pytest.raises(UnknownNameError, match=r"no scenario is called 'stpe'; did you mean 'step'\? valid: step, "):
        Scenario.preset("stpe")


@pytest.mark.parametrize(
    ("field", "value", "path"),
    [
        ("duration", 0.0, "duration"),
        ("duration", -1.0, "duration"),
        ("duration", 600.1, "duration"),
        ("duration", math.nan, "duration"),
        ("duration", math.inf, "duration"),
        ("duration", "3", "duration"),
        ("force_limits", (1.0, 60.0), "force_limits"),
        ("force_limits", (0.0, 0.0), "force_limits"),
        ("force_limits", (-60.0, math.nan), "force_limits"),
        ("reading", "printed", "reading"),
    ],
)
def test_hostile_scenarios_are_refused(field: str, value: Any, path: str) -> None:
    with pytest.raises(InvalidScenarioError, match=r"found .*; valid: ") as refused:
        msgspec.structs.replace(Scenario.preset("step"), **{field: value})
    assert refused.value.path == path


@pytest.mark.parametrize(
    "make",
    [
        lambda: Step(extension=math.nan),
        lambda: Step(extension=[0.03, math.inf]),
        lambda: Step(bend=4.0),
        lambda: Sinus(frequency=0.0),
        lambda: Sinus(frequency=21.0),
        lambda: Mismatch(mass=0.0),
        lambda: Mismatch(damping=math.nan),
        lambda: BandLimitedNoise(share=-0.1),
        lambda: BandLimitedNoise(share=math.nan),
        lambda: BandLimitedNoise(hold_time=0.0),
        lambda: BandLimitedNoise(seed=-1),
        lambda: BandLimitedNoise(seed=0.5),  # type: ignore[arg-type]
    ],
)
def test_hostile_parts_are_refused(make: Any) -> None:
    with pytest.raises(InvalidScenarioError, match=r"found .*; valid: "):
        make()


def test_noise_has_the_stated_variance_and_repeats_with_its_seed() -> None:
    holding = np.array([10.0, -20.0, 0.0])
    noise = BandLimitedNoise(share=0.3, seed=7)
    blocks = noise.samples(holding)
    drawn = np.concatenate([next(blocks) for _ in range(40)])
    assert drawn.shape == (40 * BLOCK, 3)
    np.testing.assert_allclose(drawn.var(axis=0), 0.3 * holding**2, rtol=0.03)
    np.testing.assert_allclose(np.corrcoef(drawn[:, 0], drawn[:, 1])[0, 1], 0, atol=0.02)
    np.testing.assert_allclose(np.corrcoef(drawn[:-1, 0], drawn[1:, 0])[0, 1], 0, atol=0.02)
    assert np.array_equal(next(noise.samples(holding)), drawn[:BLOCK])
    assert not np.array_equal(next(msgspec.structs.replace(noise, seed=8).samples(holding)), drawn[:BLOCK])
