"""What an arm may have beyond the paper's: payload, friction, stops, valves, and a filtered reference."""

from __future__ import annotations

from typing import Any

import msgspec
import numpy as np
import pytest

from robot import dynamics
from robot.arm import Arm
from robot.controllers import PdFlc, Pid, PidGravity
from robot.disturbance import Pulse
from robot.errors import InvalidScenarioError
from robot.kernels.dynamics import SLIP_SPEED
from robot.run import Run
from robot.scenario import Hold, Payload, Scenario
from robot.simulation import Simulation, simulate
from tests.robot.arms import random_state, uneven_arm

SOFT = Arm.preset("soft")
STEP = Scenario.preset("step")
FREE = Pid(*[(0.0,) * 6] * 3)


def loaded(n: int, offset: float) -> Arm:
    return msgspec.structs.replace(uneven_arm(n), payload=0.4, payload_offset=offset)


@pytest.mark.parametrize("offset", [0.0, 0.07])
@pytest.mark.parametrize("n", [1, 2, 3, 8])
def test_recursions_and_matrices_agree_with_a_payload(n: int, offset: float) -> None:
    """The recursions know the payload as a link that cannot slide, the matrices as one more module."""
    arm = loaded(n, offset)
    q, dq = random_state(n)
    force, load = np.random.default_rng(1).normal(size=2 * n), np.random.default_rng(2).normal(size=(n, 2))
    ddq = dynamics.acceleration(arm, q, dq, force)
    D, C = dynamics.mass_matrix(arm, q), dynamics.coriolis_matrix(arm, q, dq)
    resisting = C @ dq + dynamics.damping_vector(arm, dq) + dynamics.gravity_vector(arm, q)
    np.testing.assert_allclose(D @ ddq + resisting, force, rtol=1e-9, atol=1e-10)
    np.testing.assert_allclose(dynamics.inverse_dynamics(arm, q, dq, ddq), force, rtol=1e-9, atol=1e-10)
    assert np.linalg.eigvalsh(D)[0] > 0
    # A load on the masses does not depend on what the arm carries.
    bare = uneven_arm(n)
    difference = D @ (dynamics.acceleration(arm, q, dq, force, load) - ddq)
    plain = dynamics.acceleration(bare, q, dq, force, load) - dynamics.acceleration(bare, q, dq, force)
    np.testing.assert_allclose(difference, dynamics.mass_matrix(bare, q) @ plain, rtol=1e-8, atol=1e-10)


def test_gravity_and_stiffness_are_derivatives_of_the_energy_with_a_payload() -> None:
    arm = loaded(3, 0.07)
    q, _ = random_state()
    steps = 1e-6 * np.eye(6)

    def potential(place: np.ndarray) -> float:
        return dynamics.energy(arm, place, np.zeros(6)).potential

    slope = [(potential(q + step) - potential(q - step)) / 2e-6 for step in steps]
    np.testing.assert_allclose(dynamics.gravity_vector(arm, q), slope, rtol=1e-6, atol=1e-7)
    rows = [(dynamics.gravity_vector(arm, q + s) - dynamics.gravity_vector(arm, q - s)) / 2e-6 for s in steps]
    np.testing.assert_allclose(dynamics.stiffness_matrix(arm, q), rows, rtol=1e-6, atol=1e-6)


def test_a_payload_at_the_rods_centre_is_a_heavier_rod() -> None:
    carried = msgspec.structs.replace(SOFT, payload=0.1)
    heavy = msgspec.structs.replace(SOFT, mass=[0.3, 0.25, 0.3])
    q, dq = random_state()
    np.testing.assert_allclose(
        dynamics.acceleration(carried, q, dq, np.zeros(6)), dynamics.acceleration(heavy, q, dq, np.zeros(6)), rtol=1e-12
    )


def test_an_undamped_arm_with_a_payload_keeps_its_energy() -> None:
    arm = msgspec.structs.replace(SOFT, payload=0.2, payload_offset=0.05).scaled(damping=0.0)
    q = dynamics.equilibrium(arm) + np.array([0.01, -0.01, 0.01, 0.3, -0.2, 0.3])
    run = free(arm, q, 2.0)
    total = [dynamics.energy(arm, *row).total for row in zip(run.q[::100], run.dq[::100], strict=True)]
    assert np.abs(run.dq).max() > 0.5
    np.testing.assert_allclose(total, total[0], atol=2e-6)


def test_the_controller_does_not_know_the_scenarios_payload() -> None:
    scenario = msgspec.structs.replace(STEP, payload=Payload(0.1, 0.03))
    error = simulate(SOFT, PdFlc.default(SOFT), scenario).metrics().steady_state_error["worst"]
    known = msgspec.structs.replace(SOFT, payload=0.1, payload_offset=0.03)
    assert error > 1.0
    assert simulate(known, PdFlc.default(known), STEP).metrics().steady_state_error["worst"] < 0.01


def free(arm: Arm, q: np.ndarray, seconds: float, **changes: Any) -> Run:
    scenario = msgspec.structs.replace(STEP, **changes)
    simulation = Simulation(arm, FREE, scenario, q=q, history=seconds)
    simulation.advance(round(seconds * 1000))
    return simulation.run()


def test_friction_opposes_motion_with_its_force() -> None:
    arm = msgspec.structs.replace(SOFT, friction=[[0.5, 0.4, 0.3], [0.5, 0.4, 0.3]])
    fast = np.array([1.0, -1.0, 1.0, 0.0, 0.0, 0.0]) * 100 * SLIP_SPEED
    np.testing.assert_allclose(dynamics.friction_vector(arm, fast), [1.0, -0.8, 0.6, 0, 0, 0], rtol=1e-4)
    q, dq = random_state()
    assert dq @ dynamics.friction_vector(arm, dq) > 0
    difference = dynamics.inverse_dynamics(arm, q, dq, dq) - dynamics.inverse_dynamics(SOFT, q, dq, dq)
    np.testing.assert_allclose(difference, dynamics.friction_vector(arm, dq), rtol=1e-9, atol=1e-12)
    np.testing.assert_array_equal(dynamics.damping_vector(arm, dq), dynamics.damping_vector(SOFT, dq))


def test_friction_takes_energy_and_its_compensation_gives_it_back() -> None:
    rubbing = msgspec.structs.replace(SOFT, friction=0.5)
    q = dynamics.equilibrium(SOFT) + np.array([0.02, -0.02, 0.03, 0.5, -0.4, 0.3])
    run = free(rubbing, q, 1.0)
    total = np.array([dynamics.energy(SOFT, *row).total for row in zip(run.q[::10], run.dq[::10], strict=True)])
    assert (np.diff(total) <= 1e-12).all()
    plain = free(SOFT, q, 0.1)
    assert total[10] < dynamics.energy(SOFT, plain.q[-1], plain.dq[-1]).total
    law = PidGravity.default(rubbing, STEP.scale(3))
    ignorant = msgspec.structs.replace(law, model=SOFT)
    smooth = simulate(SOFT, ignorant, STEP)
    assert np.abs(simulate(rubbing, law, STEP).q - smooth.q).max() < 2e-3
    assert np.abs(simulate(rubbing, ignorant, STEP).q - smooth.q).max() > 5e-3


def test_stops_keep_actuators_longer_than_nothing() -> None:
    squeezed = Pulse("s1", -60.0, 0.1, 0.4)
    with_stops = simulate(SOFT, FREE, Scenario(name="x", reference=Hold(), duration=1.0, pulses=(squeezed,)))
    assert with_stops.is_physical
    assert with_stops.shortest_actuator().min() < 0.01
    open_ended = msgspec.structs.replace(with_stops.scenario, stops=False)
    without = simulate(SOFT, FREE, open_ended)
    assert not without.is_physical
    np.testing.assert_array_equal(with_stops.q[:100], without.q[:100])


def test_a_valve_lags_by_its_time_constant() -> None:
    instant = simulate(SOFT, Pid.default(SOFT), STEP)
    run = simulate(SOFT, Pid.default(SOFT), msgspec.structs.replace(STEP, valve_time=0.05))
    command = dynamics.actuator_forces(SOFT, run.q[0], run.control[0])
    np.testing.assert_allclose(run.forces[0], command * (1 - 50 * (1 - np.exp(-0.02))), rtol=1e-12)
    # The mean of a step answers as a first-order lag does, whatever the command.
    applied = np.zeros(6)
    for row in range(300):
        command = dynamics.actuator_forces(SOFT, run.q[row], run.control[row])
        np.testing.assert_allclose(run.forces[row], command + 50 * -np.expm1(-0.02) * (applied - command), atol=1e-9)
        applied = command + np.exp(-0.02) * (applied - command)
    assert run.metrics().overshoot["worst"] > instant.metrics().overshoot["worst"]
    barely = simulate(SOFT, Pid.default(SOFT), msgspec.structs.replace(STEP, valve_time=1e-6))
    np.testing.assert_allclose(barely.q, instant.q, atol=2e-4)


def test_the_prefilter_is_the_critically_damped_answer() -> None:
    run = simulate(SOFT, PdFlc.default(SOFT), msgspec.structs.replace(STEP, prefilter=12.0))
    x = 12.0 * run.t
    share = 1 - (1 + x) * np.exp(-x)
    expected = run.start + np.outer(share, STEP.amplitude(3))
    np.testing.assert_allclose(run.reference, expected, atol=1e-12)
    np.testing.assert_allclose(run.dreference[:, 0], 0.03 * 144 * run.t * np.exp(-x), atol=1e-12)
    # Its second derivative feeds the law: the arm follows from the start, but for the hold of the forces.
    assert np.abs(run.reference - run.q).max() < 0.02 * 0.3
    assert run.metrics().overshoot["worst"] < 0.01


@pytest.mark.parametrize(
    ("field", "value", "path"),
    [
        ("prefilter", 0.0, "prefilter"),
        ("prefilter", np.nan, "prefilter"),
        ("valve_time", -1.0, "valve_time"),
        ("valve_time", np.inf, "valve_time"),
    ],
)
def test_hostile_values_are_refused(field: str, value: float, path: str) -> None:
    with pytest.raises(InvalidScenarioError, match=r"found .*; valid: ") as refused:
        msgspec.structs.replace(STEP, **{field: value})
    assert refused.value.path == path
