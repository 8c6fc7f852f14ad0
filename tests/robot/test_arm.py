"""Parameters: equal by value, loaded from presets, refused when no arm can have them."""

from __future__ import annotations

import math
from typing import Any

import msgspec
import numpy as np
import pytest

from robot.arm import Arm, parameters
from robot.errors import InvalidArmError, UnknownNameError

VALID: dict[str, Any] = {
    "mass": [0.3, 0.2],
    "inertia": [0.0005, 0.0004],
    "rod_length": 0.08,
    "rest_length": [0.11, 0.1],
    "stiffness": [[200, 210], [190, 205]],
    "damping": np.full((2, 2), 4.0),
    "gravity": 9.81,
}


def test_sequences_arrays_and_single_numbers_make_equal_arms() -> None:
    arm = Arm(**VALID)
    same = Arm(**{**VALID, "mass": np.array([0.3, 0.2]), "rod_length": (0.08, 0.08), "damping": [[4, 4], [4, 4]]})
    assert arm == same
    assert hash(arm) == hash(same)
    assert parameters(arm) is parameters(same)
    assert arm.n_modules == 2
    assert arm.coordinates == ("s1", "s2", "theta1", "theta2")
    assert arm.actuators == ("F11", "F21", "F12", "F22")


def test_kernels_see_read_only_arrays() -> None:
    arrays = [value for value in parameters(Arm(**VALID)) if isinstance(value, np.ndarray)]
    assert len(arrays) == 7
    for array in arrays:
        assert not array.flags.writeable
        assert array.flags.c_contiguous


def test_the_presets_hold_the_documented_values() -> None:
    soft = Arm.preset("soft")
    assert soft.mass == (0.30, 0.25, 0.20)
    np.testing.assert_allclose(parameters(soft).inertia, np.array(soft.mass) * (3 * 0.05**2 + 0.11**2) / 12, rtol=1e-15)
    assert msgspec.structs.replace(soft, stiffness=[[1500] * 3] * 2, damping=[[15] * 3] * 2) == Arm.preset("stiff")


def test_an_unknown_preset_is_refused_with_the_valid_names() -> None:
    with pytest.raises(UnknownNameError, match=r"no arm is called 'sotf'; did you mean 'soft'\? valid: soft, stiff"):
        Arm.preset("sotf")


def test_scaling_a_group_changes_that_group_alone() -> None:
    arm = Arm(**VALID)
    heavy = arm.scaled(mass=1.3)
    np.testing.assert_allclose(parameters(heavy).mass, np.array([0.3, 0.2]) * 1.3)
    np.testing.assert_allclose(parameters(heavy).inertia, np.array([0.0005, 0.0004]) * 1.3)
    assert heavy.stiffness == arm.stiffness
    with pytest.raises(InvalidArmError, match="mass"):
        arm.scaled(mass=0.0)


@pytest.mark.parametrize(
    ("field", "value", "path"),
    [
        ("mass", [], "mass"),
        ("mass", [0.1] * 9, "mass"),
        ("mass", [0.3, -0.2], "mass[1]"),
        ("mass", [0.3, math.nan], "mass[1]"),
        ("mass", [0.3, "0.2"], "mass[1]"),
        ("mass", [0.3, True], "mass[1]"),
        ("mass", "heavy", "mass"),
        ("mass", 0.3, "mass"),
        ("mass", [[0.3], [0.2]], "mass[0]"),
        ("inertia", [0.0, 0.1], "inertia[0]"),
        ("inertia", [0.1], "inertia"),
        ("rod_length", 0, "rod_length[0]"),
        ("rod_length", math.inf, "rod_length"),
        ("rest_length", [0.1, 0.0], "rest_length[1]"),
        ("stiffness", [[200, 200]], "stiffness"),
        ("stiffness", [200, 200], "stiffness[0]"),
        ("stiffness", 200, "stiffness"),
        ("stiffness", [[200, 200], [200]], "stiffness[1]"),
        ("stiffness", [[200, 200], [200, -1]], "stiffness[1][1]"),
        ("damping", [[4, 4], [4, math.nan]], "damping[1][1]"),
        ("damping", [[4, 4], [4, -0.1]], "damping[1][1]"),
        ("gravity", math.nan, "gravity"),
        ("gravity", None, "gravity"),
        ("friction", -0.1, "friction[0][0]"),
        ("friction", [[0.1, 0.1], [0.1, math.nan]], "friction[1][1]"),
        ("payload", -1.0, "payload"),
        ("payload", math.inf, "payload"),
        ("payload_offset", -0.1, "payload_offset"),
    ],
)
def test_unphysical_parameters_are_refused_with_field_found_and_valid(field: str, value: object, path: str) -> None:
    with pytest.raises(InvalidArmError, match=r"found .*; valid: ") as refused:
        Arm(**{**VALID, field: value})
    assert refused.value.path == path
