"""Places of rods, backbone and actuators against the model's own geometry."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given

from robot import kinematics
from robot.arm import Arm, parameters
from robot.errors import RobotError
from tests.robot.arms import states, uneven_arm

SOFT = Arm.preset("soft")
STANDARD_BEND = np.array([0.15, 0.14, 0.13, 0.3, 0.3, 0.3])


@given(states())
def test_rods_are_q_apart_and_turned_and_as_long_as_the_arm_says(state: tuple) -> None:
    arm = uneven_arm()
    q, _ = state
    rods = kinematics.rods(arm, q)
    sides = rods.ends[1:, 1] - rods.ends[1:, 0]
    np.testing.assert_allclose(np.linalg.norm(sides, axis=1), arm.rod_length, rtol=1e-12)
    np.testing.assert_allclose(rods.ends.mean(axis=1), rods.position, atol=1e-14)
    np.testing.assert_allclose(np.linalg.norm(np.diff(rods.position, axis=0), axis=1), q[:3], atol=1e-13)
    np.testing.assert_allclose(np.diff(rods.angle), q[3:], atol=1e-13)


def test_positive_angles_bend_towards_n1_and_stretch_actuator_one() -> None:
    rods = kinematics.rods(SOFT, STANDARD_BEND)
    assert (np.diff(rods.position[:, 0])[1:] > 0).all()
    first, second = (np.linalg.norm(np.diff(rods.ends[:, a], axis=0), axis=1) for a in (0, 1))
    assert (first > second).all()


def test_the_hanging_arm_is_a_straight_line_down() -> None:
    q = np.array([0.1, 0.2, 0.3, 0, 0, 0])
    curve = kinematics.backbone(SOFT, q, 20, cap=False)
    np.testing.assert_allclose(curve.points[:, 0], 0, atol=1e-15)
    assert (np.diff(curve.points[:, 1]) > 0).all()
    np.testing.assert_allclose(curve.points[0], 0, atol=1e-15)
    np.testing.assert_allclose(curve.tangents, np.tile([0.0, 1.0], (20, 1)), atol=1e-15)
    np.testing.assert_allclose(curve.normals, np.tile([1.0, 0.0], (20, 1)), atol=1e-15)


def test_the_backbone_starts_at_the_base_passes_the_rods_and_shows_the_last_angle() -> None:
    curve = kinematics.backbone(SOFT, STANDARD_BEND, 400)
    rods = kinematics.rods(SOFT, STANDARD_BEND)
    np.testing.assert_allclose(curve.points[0], 0, atol=1e-15)
    for place in rods.position:
        assert np.linalg.norm(curve.points - place, axis=1).min() < 0.006
    angle = np.arctan2(curve.tangents[:, 0], curve.tangents[:, 1])
    assert angle[0] == pytest.approx(0, abs=1e-12)
    assert angle[-1] == pytest.approx(0.9, abs=1e-12)
    step = np.linalg.norm(np.diff(curve.points, axis=0), axis=1)
    curvature = np.diff(angle) / step
    inside = curvature[200:300]
    np.testing.assert_allclose(inside, 0.3 / 0.14, rtol=0.15)


def test_tangents_are_the_slopes_of_the_curve() -> None:
    curve = kinematics.backbone(uneven_arm(), STANDARD_BEND, 2001)
    slope = np.diff(curve.points, axis=0)
    slope /= np.linalg.norm(slope, axis=1, keepdims=True)
    np.testing.assert_allclose(slope, (curve.tangents[1:] + curve.tangents[:-1]) / 2, atol=1e-4)
    np.testing.assert_allclose(np.sum(curve.tangents * curve.normals, axis=1), 0, atol=1e-15)


def test_actuators_end_on_the_rods_in_the_order_of_the_forces() -> None:
    arm = uneven_arm()
    ends = kinematics.rods(arm, STANDARD_BEND).ends
    curves = kinematics.actuators(arm, STANDARD_BEND, 7)
    assert len(curves) == len(arm.actuators)
    for number, curve in enumerate(curves):
        module, actuator = divmod(number, 2)
        np.testing.assert_allclose(curve.points[0], ends[module, actuator], atol=1e-15)
        np.testing.assert_allclose(curve.points[-1], ends[module + 1, actuator], atol=1e-15)


@pytest.mark.parametrize("n", [1, 2, 5, 8])
def test_many_positions_at_once_give_what_each_alone_gives(n: int) -> None:
    arm = uneven_arm(n)
    rng = np.random.default_rng(0)
    q = np.concatenate([rng.uniform(0.05, 0.2, (4, 5, n)), rng.uniform(-1, 1, (4, 5, n))], axis=-1)
    many, one = kinematics.backbone(arm, q, 11), kinematics.backbone(arm, q[2, 3], 11)
    for all_, alone in zip(many, one, strict=True):
        np.testing.assert_allclose(all_[2, 3], alone, atol=1e-15)
    for all_, alone in zip(kinematics.actuators(arm, q, 5), kinematics.actuators(arm, q[2, 3], 5), strict=True):
        np.testing.assert_allclose(all_.points[2, 3], alone.points, atol=1e-15)
    np.testing.assert_allclose(kinematics.shortest_actuator(arm, q)[2, 3], kinematics.shortest_actuator(arm, q[2, 3]))


def test_a_module_without_length_still_has_a_direction() -> None:
    curve = kinematics.backbone(SOFT, np.zeros(6))
    assert np.isfinite(curve.tangents).all()
    np.testing.assert_allclose(np.linalg.norm(curve.tangents, axis=1), 1)


def test_a_bend_can_be_too_sharp_for_a_real_arm() -> None:
    assert kinematics.shortest_actuator(SOFT, [0.1, 0.1, 0.1, 0, 0, 0]) == pytest.approx(0.1)
    too_sharp = [0.1, 0.1, 0.1, 0, -2.6, 0]
    assert kinematics.shortest_actuator(SOFT, too_sharp) == pytest.approx(0.1 - parameters(SOFT).half_rod[1] * 2.6)
    assert kinematics.shortest_actuator(SOFT, too_sharp) < 0


def test_wrong_shapes_are_refused() -> None:
    with pytest.raises(RobotError, match=r"found shape \(5,\)"):
        kinematics.rods(SOFT, np.zeros(5))
