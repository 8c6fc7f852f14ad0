"""Gains by name: every law has some, and multiplying one group changes that group only."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from fuzzy import compile_system
from fuzzy.formats import load
from robot import controllers
from robot.arm import Arm
from robot.errors import UnknownNameError
from robot.scenario import Scenario

CONTROLLER = compile_system(load(Path(__file__).parents[2] / "rulebases" / "diagonal.yaml"))
ARM = Arm.preset("soft")


def law(name: str) -> controllers.ControlLaw:
    return controllers.default(name, ARM, Scenario.preset("step"), CONTROLLER)


@pytest.mark.parametrize("name", controllers.NAMES)
def test_doubling_a_group_doubles_it_and_leaves_the_others(name: str) -> None:
    before = controllers.gains(law(name))
    assert {"kp", "kd"} <= set(before)
    assert controllers.needs_rules(name) == ("ge" in before)
    for gain in before:
        after = controllers.gains(controllers.scaled(law(name), {gain: 2.0}))
        for other, values in before.items():
            expected = 2.0 * np.array(values) if other == gain else np.array(values)
            np.testing.assert_allclose(after[other], expected)


@pytest.mark.parametrize("name", controllers.NAMES)
def test_what_the_kernel_reads_follows_the_gains(name: str) -> None:
    plain, strong = law(name).law(), controllers.scaled(law(name), {"kp": 3.0}).law()
    assert (strong.Kp >= plain.Kp).all()
    assert (strong.Kp > plain.Kp).any()
    np.testing.assert_array_equal(strong.scale, plain.scale)


def test_ones_change_nothing_and_unknown_groups_are_named() -> None:
    pid = law("pid")
    assert controllers.scaled(pid, dict.fromkeys(controllers.GAINS, 1.0)) is pid
    assert controllers.scaled(pid, {"gu": 5.0}) == pid, "a PID has no blocks"
    with pytest.raises(UnknownNameError, match="gamma"):
        controllers.scaled(pid, {"gama": 2.0})  # pyright: ignore[reportArgumentType]
