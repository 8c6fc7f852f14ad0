"""Targets that move in other ways than steps and sinuses, and disturbances of every kind."""

from __future__ import annotations

import math
from typing import Any

import msgspec
import numpy as np
import pytest

from robot import dynamics, kinematics
from robot.arm import Arm
from robot.controllers import PdFlc, Pid
from robot.disturbance import BandLimitedNoise, Pulse, Push
from robot.errors import InvalidScenarioError, RobotError
from robot.reference import circle, inverse_kinematics, tip_jacobian, tip_position
from robot.scenario import Hold, Scenario, Sequence, Step, TipCircle
from robot.simulation import simulate
from tests.robot.arms import random_state, uneven_arm
from tests.robot.test_simulation import SOFT, STEP, assert_same, law

HOLD = Scenario(name="hold", reference=Hold(), duration=1.0)
FREE = Pid(*[(0.0,) * 6] * 3)


def test_a_held_target_stays_and_so_does_the_arm() -> None:
    run = simulate(SOFT, law("pd_flc", scenario=HOLD), HOLD)
    np.testing.assert_array_equal(run.reference, np.tile(run.start, (len(run.t), 1)))
    np.testing.assert_allclose(run.q, run.reference, atol=1e-12)
    assert math.isnan(run.metrics().overshoot["worst"])


def test_a_sequence_is_one_step_after_another_and_the_last_one_stays() -> None:
    steps = (Step(0.03, 0.3), Step([0.0, 0.01, -0.02], 0.0))
    scenario = Scenario(name="two", reference=Sequence(steps, dwell=0.4), duration=1.5)
    run = simulate(SOFT, law("pid", scenario=scenario), scenario)
    relative = run.reference - run.start
    np.testing.assert_allclose(relative[:400], np.tile([0.03] * 3 + [0.3] * 3, (400, 1)), atol=1e-15)
    np.testing.assert_allclose(relative[400:], np.tile([0, 0.01, -0.02, 0, 0, 0], (1101, 1)), atol=1e-15)
    np.testing.assert_array_equal(scenario.amplitude(3), [0.03, 0.03, 0.03, 0.3, 0.3, 0.3])
    assert_same(
        simulate(SOFT, law("pid"), msgspec.structs.replace(STEP, duration=0.3)),
        simulate(SOFT, law("pid"), msgspec.structs.replace(scenario, duration=0.3)),
    )


@pytest.mark.parametrize("n", [1, 3, 5])
def test_the_tips_jacobian_is_its_derivative(n: int) -> None:
    arm = uneven_arm(n)
    q, _ = random_state(n)
    columns = [(tip_position(arm, q + s) - tip_position(arm, q - s)) / 2e-6 for s in 1e-6 * np.eye(2 * n)]
    np.testing.assert_allclose(tip_jacobian(arm, q), np.transpose(columns), atol=1e-8)


def test_inverse_kinematics_finds_the_nearest_position() -> None:
    start = dynamics.equilibrium(SOFT)
    goal = tip_position(SOFT, start) + np.array([0.04, -0.03])
    q = inverse_kinematics(SOFT, goal, start)
    np.testing.assert_allclose(tip_position(SOFT, q), goal, atol=1e-6)
    # Stationary: no motion that leaves the tip in place comes nearer to the start.
    weight = 1.0 / STEP.scale(3) ** 2
    J = tip_jacobian(SOFT, q)
    gradient = weight * (q - start)
    remaining = gradient - J.T @ np.linalg.lstsq(J.T, gradient, rcond=None)[0]
    assert np.abs(remaining).max() < 2e-3 * np.abs(gradient).max()


@pytest.mark.parametrize("place", [(0.0, 9.0), (0.9, 0.1), (0.0, -0.5), (0.0, 0.0)])
def test_places_out_of_reach_are_reported(place: Any) -> None:
    short = Arm(mass=[0.2], rod_length=0.08, rest_length=0.1, stiffness=[[200]] * 2, damping=[[4]] * 2)
    with pytest.raises(RobotError, match=r"found .*; valid: a place within the arm's reach"):
        inverse_kinematics(short, place, dynamics.equilibrium(short))


def test_the_tip_follows_a_circle() -> None:
    scenario = Scenario.preset("circle")
    reference = scenario.reference
    assert isinstance(reference, TipCircle)
    start = dynamics.equilibrium(SOFT)
    center = tip_position(SOFT, start) - [0.0, reference.radius]
    table = circle(SOFT, start, reference)
    tip = kinematics.rods(SOFT, table[:, 0]).position[:, -1]
    np.testing.assert_allclose(np.linalg.norm(tip - center, axis=1), reference.radius, atol=1e-6)
    np.testing.assert_allclose(table[0, 0], start, atol=1e-9)
    assert tip[: len(tip) // 2, 0].mean() > 0.01
    # Derivatives are those of the table, also from its end to its beginning.
    for order in (0, 1):
        slope = (np.roll(table[:, order], -1, axis=0) - np.roll(table[:, order], 1, axis=0)) / 0.002
        np.testing.assert_allclose(slope, table[:, order + 1], atol=2e-4 * np.abs(table[:, order + 1]).max())
    run = simulate(SOFT, PdFlc.default(SOFT, 30.0), scenario)
    late = kinematics.rods(SOFT, run.q[run.t > 1]).position[:, -1]
    np.testing.assert_allclose(np.linalg.norm(late - center, axis=1), reference.radius, atol=2e-3)


def test_a_circle_that_is_out_of_reach_is_refused() -> None:
    scenario = Scenario(name="large", reference=TipCircle(radius=0.9))
    with pytest.raises(InvalidScenarioError, match=r"reference.radius: unreachable: found .*; valid: "):
        simulate(SOFT, law("pid"), scenario)


def test_noise_on_the_measurement_is_what_the_controller_sees_and_not_what_the_arm_does() -> None:
    noise = BandLimitedNoise(share=0.01, hold_time=0.01, seed=3, channel="measurement")
    scenario = msgspec.structs.replace(HOLD, disturbance=noise)
    gains = Pid((10.0,) * 6, (0.0,) * 6, (0.0,) * 6)
    run = simulate(SOFT, gains, scenario)
    np.testing.assert_allclose(run.control, 10.0 * (run.reference - run.q - run.disturbance), atol=1e-12)
    assert run.disturbance[:, :3].std() == pytest.approx(0.1 * 0.03, rel=0.15)
    assert run.disturbance[:, 3:].std() == pytest.approx(0.1 * 0.3, rel=0.15)


def test_noise_on_the_reference_moves_the_target() -> None:
    noise = BandLimitedNoise(share=0.01, hold_time=0.01, seed=3, channel="reference")
    run = simulate(SOFT, Pid.default(SOFT), msgspec.structs.replace(HOLD, disturbance=noise))
    np.testing.assert_allclose(run.reference, run.start + run.disturbance, atol=1e-15)
    filtered = simulate(SOFT, Pid.default(SOFT), msgspec.structs.replace(HOLD, disturbance=noise, prefilter=20.0))
    assert 0 < filtered.reference.std(axis=0)[0] < 0.7 * run.reference.std(axis=0)[0]
    assert_same(filtered, simulate(SOFT, Pid.default(SOFT), filtered.scenario))


def test_a_pulse_acts_on_its_coordinate_for_its_time() -> None:
    run = simulate(SOFT, FREE, msgspec.structs.replace(HOLD, pulses=(Pulse("theta2", 0.2, 0.1, 0.05),)))
    expected = np.zeros_like(run.disturbance)
    expected[100:150, 4] = 0.2
    np.testing.assert_array_equal(run.disturbance, expected)
    assert np.abs(run.q - run.start)[:100].max() < 1e-12
    assert np.abs(run.q - run.start)[101:].max() > 1e-3


@pytest.mark.parametrize("point", [0.4, 1.0, 1.7, 3.0, None])
def test_a_push_on_a_point_works_on_the_coordinates_through_its_jacobian(point: float | None) -> None:
    force = np.array([0.7, -0.4])
    run = simulate(SOFT, FREE, msgspec.structs.replace(HOLD, pushes=(Push((0.7, -0.4), 0.0, 0.001, point),)))
    q = run.start

    def place(q: np.ndarray) -> np.ndarray:
        rods = kinematics.rods(SOFT, q).position
        at = 3.0 if point is None else point
        module = min(int(at), 2)
        return rods[module] + (at - module) * (rods[module + 1] - rods[module])

    steps = 1e-6 * np.eye(6)
    J = np.transpose([(place(q + s) - place(q - s)) / 2e-6 for s in steps])
    expected = dynamics.acceleration(SOFT, q, np.zeros(6), J.T @ force)
    # After a step of 1 ms the speed is the acceleration's work, but for dampers.
    np.testing.assert_allclose(run.dq[1], 0.001 * expected, atol=0.05 * np.abs(expected * 0.001).max())


@pytest.mark.parametrize(
    "make",
    [
        lambda: Sequence(()),
        lambda: Sequence((Step(),), dwell=math.nan),
        lambda: TipCircle(radius=0.0),
        lambda: TipCircle(period=math.inf),
        lambda: BandLimitedNoise(channel="voltage"),  # type: ignore[arg-type]
        lambda: Pulse("s1", math.nan, 0.0, 1.0),
        lambda: Pulse("s1", 1.0, -1.0, 1.0),
        lambda: Push((1.0, math.inf), 0.0, 1.0),
        lambda: Push((1.0, 0.0), 0.0, 1.0, point=9.0),
        lambda: simulate(SOFT, FREE, msgspec.structs.replace(HOLD, pulses=(Pulse("s4", 1.0, 0.0, 1.0),))),
        lambda: simulate(SOFT, FREE, msgspec.structs.replace(HOLD, pushes=(Push((1.0, 0.0), 0.0, 1.0, 4.0),))),
    ],
)
def test_what_cannot_be_is_refused(make: Any) -> None:
    with pytest.raises(InvalidScenarioError, match=r"found .*; valid: "):
        make()
