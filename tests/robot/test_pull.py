"""A hand that pulls the arm: the force of a spring, as a load on the masses."""

from __future__ import annotations

import msgspec
import numpy as np
import pytest

from robot import dynamics, kinematics
from robot.arm import Arm
from robot.controllers import PdFlc
from robot.errors import InvalidScenarioError
from robot.pull import MOST_FORCE, Pull, nearest_point
from robot.scenario import Mismatch, Scenario
from robot.simulation import Simulation, simulate

ARM = Arm.preset("soft")
Q = dynamics.equilibrium(ARM) + np.array([0.01, 0.02, 0.0, 0.1, -0.2, 0.3])


@pytest.mark.parametrize("point", [0.3, 1.0, 1.5, 2.25, 3.0])
def test_the_load_has_the_forces_sum_and_moves_the_point_towards_the_hand(point: float) -> None:
    held = Pull(point, (0.0, 0.0)).held(ARM, Q)
    pull = Pull(point, (float(held[0]) + 0.05, float(held[1]) - 0.02))
    load = pull.load(ARM, Q)
    share = min(point, 1.0)  # below the first rod the base carries the rest
    np.testing.assert_allclose(load.sum(axis=0), share * pull.force(ARM, Q))
    nothing = np.zeros(Q.size)
    free = dynamics.acceleration(ARM, Q, nothing, nothing)
    pulled = dynamics.acceleration(ARM, Q, nothing, nothing, load)
    h = 1e-5
    moved = (pull.held(ARM, Q + h * pulled) - pull.held(ARM, Q + h * free)) / h
    assert moved @ pull.force(ARM, Q) > 0.0


def test_the_force_is_that_of_a_spring_up_to_its_limit() -> None:
    held = Pull(2.0, (0.0, 0.0)).held(ARM, Q)
    near = Pull(2.0, (float(held[0]) + 0.1, float(held[1])), stiffness=50.0)
    np.testing.assert_allclose(near.force(ARM, Q), [5.0, 0.0], atol=1e-12)
    far = Pull(2.0, (float(held[0]), float(held[1]) + 1e6))
    np.testing.assert_allclose(far.force(ARM, Q), [0.0, MOST_FORCE], atol=1e-3)


def test_the_nearest_point_is_where_the_hand_grips() -> None:
    for module, place in enumerate(kinematics.rods(ARM, Q).position):
        assert nearest_point(ARM, Q, place) == pytest.approx(module, abs=0.04)


def test_a_point_beyond_the_arm_is_refused() -> None:
    with pytest.raises(InvalidScenarioError, match="0 to 3"):
        Pull(3.5, (0.0, 0.0)).load(ARM, Q)


def test_going_on_under_other_conditions_is_the_same_plant_from_there_on() -> None:
    law, scenario = PdFlc.default(ARM), Scenario.preset("step")
    other = msgspec.structs.replace(scenario, mismatch=Mismatch(stiffness=1.4, friction=1.0))
    live = Simulation(ARM, law, scenario)
    live.advance(200)
    q, dq = live.q, live.dq
    live.go_on(other)
    np.testing.assert_array_equal(live.q, q)
    live.advance(300)
    unchanged = Simulation(ARM, law, scenario)
    unchanged.advance(500)
    assert not np.allclose(live.q, unchanged.q)
    assert live.time == unchanged.time
    same = Simulation(ARM, law, scenario)
    same.advance(200)
    same.go_on(scenario)
    same.advance(300)
    np.testing.assert_array_equal(same.q, unchanged.q)
    assert dq.shape == q.shape


def test_unknown_friction_slows_the_plant_and_the_model_does_not_know() -> None:
    scenario = msgspec.structs.replace(Scenario.preset("step"), mismatch=Mismatch(friction=2.0))
    assert np.all(np.array(scenario.plant(ARM).friction) == 2.0)
    run = simulate(ARM, PdFlc.default(ARM), scenario)
    plain = simulate(ARM, PdFlc.default(ARM), Scenario.preset("step"))
    assert run.metrics().steady_state_error["worst"] > plain.metrics().steady_state_error["worst"] + 1.0
    for friction in (-1.0, float("nan"), 1e3):
        with pytest.raises(InvalidScenarioError, match=r"mismatch\.friction"):
            Mismatch(friction=friction)


def test_a_thinned_run_has_the_same_rows_but_fewer() -> None:
    run = simulate(ARM, PdFlc.default(ARM), Scenario.preset("step"))
    thin = run.thinned(600)
    assert len(thin.t) <= 601
    np.testing.assert_array_equal(thin.q, run.q[::5])
    np.testing.assert_allclose(thin.lyapunov(), run.lyapunov()[::5])
    assert run.thinned(10**6).t.size == run.t.size
