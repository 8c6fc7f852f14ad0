"""The control laws of the table, their Lyapunov functions, and what learning is good for."""

from __future__ import annotations

import math
from typing import Any

import msgspec
import numpy as np
import pytest

from robot import controllers, dynamics
from robot.controllers import (
    AdaptiveFuzzyFlc,
    AdaptiveFuzzyPid,
    FuzzyPid,
    Parallel,
    PdFlc,
    Pid,
    PidFlc,
    PidGravity,
    ScaledPid,
)
from robot.errors import InvalidControllerError
from robot.run import Run
from robot.scenario import Mismatch
from robot.simulation import Simulation, simulate
from tests.robot.test_simulation import CONTROLLER, SOFT, STEP, law

SCALE = STEP.scale(3)


def errors(run: Run) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """e, its rate, and its integral as it was never held back."""
    e, de = run.reference - run.q, run.dreference - run.dq
    return e, de, 0.001 * (np.cumsum(e, axis=0) - e)


def inverse(run: Run, v: np.ndarray) -> np.ndarray:
    return np.array([dynamics.inverse_dynamics(SOFT, *row) for row in zip(run.q, run.dq, v, strict=True)])


def test_pid_with_gravity_is_as_written() -> None:
    rubbing = msgspec.structs.replace(SOFT, friction=0.2)
    gains = PidGravity.default(rubbing, SCALE)
    run = simulate(rubbing, msgspec.structs.replace(gains, band=[math.inf] * 6), STEP)
    e, de, integral = errors(run)
    expected = np.array(gains.kp) * e + np.array(gains.kd) * de + np.array(gains.ki) * integral
    expected += [dynamics.gravity_vector(SOFT, q) for q in run.q]
    expected += [dynamics.friction_vector(rubbing, dq) for dq in run.dq]
    np.testing.assert_allclose(run.control, expected, rtol=1e-9, atol=1e-9)


def test_series_and_parallel_are_as_written() -> None:
    series = msgspec.structs.replace(PidFlc.default(SOFT, SCALE), band=[math.inf] * 6)
    run = simulate(SOFT, series, STEP)
    e, de, integral = errors(run)
    np.testing.assert_allclose(run.control, inverse(run, 144 * e + 24 * de + 172.8 * integral), rtol=1e-9, atol=1e-9)
    both = law("parallel")
    assert isinstance(both, Parallel)
    run = simulate(SOFT, both, STEP)
    e, de, integral = errors(run)
    pid = both.pid
    expected = np.array(pid.kp) * e + np.array(pid.kd) * de + np.array(pid.ki) * integral
    np.testing.assert_allclose(run.control, expected + inverse(run, 144 * e + 24 * de), rtol=1e-9, atol=1e-9)


def test_blocks_on_forces_add_or_scale() -> None:
    for name, kind in (("fuzzy_pid", FuzzyPid), ("scaled_pid", ScaledPid)):
        gains = law(name)
        assert isinstance(gains, FuzzyPid | ScaledPid)
        assert isinstance(gains, kind)
        run = simulate(SOFT, gains, STEP)
        e, de, integral = errors(run)
        linear = np.array(gains.pid.kp) * e + np.array(gains.pid.kd) * de + np.array(gains.pid.ki) * integral
        share = np.array(gains.gu) * run.output / 85.0
        expected = linear + share if kind is FuzzyPid else linear * (1 + np.abs(share))
        np.testing.assert_allclose(run.control, expected, rtol=1e-9, atol=1e-9)
        np.testing.assert_allclose(run.output[:, 0], CONTROLLER.batch(run.inputs[:, 0])[:, 0], rtol=1e-9, atol=1e-9)


def test_a_scale_never_turns_the_force_round() -> None:
    """The product of an odd block with an odd PID is even: it would push away from the target on one side."""
    gains = law("scaled_pid")
    assert isinstance(gains, ScaledPid)
    run = simulate(SOFT, gains, STEP)
    e, de, integral = errors(run)
    linear = np.array(gains.pid.kp) * e + np.array(gains.pid.kd) * de + np.array(gains.pid.ki) * integral
    assert (run.control * linear >= 0).all()


@pytest.mark.parametrize("basis", ["sets", "gaussians"])
def test_adapted_blocks_follow_their_equations(basis: Any) -> None:
    gains = msgspec.structs.replace(AdaptiveFuzzyFlc.default(SOFT, CONTROLLER, SCALE), basis=basis, leak=[0.5] * 6)
    run = simulate(SOFT, gains, msgspec.structs.replace(STEP, duration=0.3))
    e, de, _ = errors(run)
    theta = np.zeros(49)
    for k in range(len(run.t)):
        x = np.clip(run.inputs[k, 0], [-1, -6], [1, 6])
        # Triangles or Gaussians over seven even places; neighbours cross at one half.
        distance = np.abs(x[:, np.newaxis] - np.linspace([-1, -6], [1, 6], 7).T) / [[1 / 3], [2]]
        degrees = np.maximum(1 - distance, 0) if basis == "sets" else 0.5 ** (4 * distance**2)
        xi = np.outer(*degrees).ravel()
        xi /= xi.sum()
        assert run.output[k, 0] == pytest.approx(theta @ xi, rel=1e-9, abs=1e-12)
        assert run.learned[k, 0] == pytest.approx(theta @ theta, rel=1e-9, abs=1e-12)
        rate = e[k, 0] / (2 * 144) + de[k, 0] / (144 * 24)
        theta = theta + 0.001 * (12.0**5 * xi * rate - 0.5 * theta)
    assert np.abs(theta).max() > 0.1
    np.testing.assert_allclose(run.control, inverse(run, 144 * e + 24 * de + run.output), rtol=1e-9, atol=1e-9)


def test_learning_takes_away_what_a_wrong_model_leaves() -> None:
    scenario = msgspec.structs.replace(STEP, mismatch=Mismatch(mass=1.2, stiffness=1.3), prefilter=12.0, duration=5.0)
    static = simulate(SOFT, PdFlc.default(SOFT, 30.0), scenario).metrics().steady_state_error["worst"]
    learning = AdaptiveFuzzyFlc.default(SOFT, CONTROLLER, SCALE, 30.0)
    adapted = simulate(SOFT, learning, scenario).metrics().steady_state_error["worst"]
    assert static > 10
    assert adapted < 0.5
    model_free = simulate(SOFT, law("adaptive_fuzzy_pid"), scenario).metrics().steady_state_error["worst"]
    assert model_free < 2


def test_what_was_learned_stays_when_an_equal_law_takes_over_and_goes_with_another() -> None:
    one, other = (Simulation(SOFT, law("adaptive_fuzzy_flc"), STEP) for _ in range(2))
    one.advance(300)
    other.advance(200)
    other.use(law("adaptive_fuzzy_flc"))
    other.advance(100)
    np.testing.assert_array_equal(one.q, other.q)
    other.use(law("pd_flc"))
    other.use(law("adaptive_fuzzy_flc"))
    other.advance(1)
    sample = other.sample()
    assert sample is not None
    np.testing.assert_array_equal(sample.output, 0.0)


def test_the_energy_function_never_grows_under_pd_with_gravity_but_does_under_pid() -> None:
    """Equations (37), (38): proved for PD + G(q), claimed by the paper for PID, whose integral V does not hold."""
    gains = msgspec.structs.replace(PidGravity.default(SOFT, SCALE), ki=[0.0] * 6)
    V = simulate(SOFT, gains, STEP).lyapunov()
    assert (np.diff(V) <= 1e-9 * V[0]).all()
    assert V[-1] < 1e-4 * V[0]
    V = simulate(SOFT, Pid.default(SOFT), STEP).lyapunov()
    assert np.diff(V).max() > 1e-6 * V[0]


def test_the_error_function_never_grows_under_exact_linearization() -> None:
    V = simulate(SOFT, PdFlc.default(SOFT), STEP).lyapunov()
    assert (np.diff(V) <= 1e-9 * V[0]).all()
    assert V[-1] < 1e-9 * V[0]


@pytest.mark.parametrize("basis", ["sets", "gaussians"])
def test_the_adaptive_function_never_grows_with_an_exact_model_and_no_leak(basis: Any) -> None:
    gains = AdaptiveFuzzyFlc.default(SOFT, CONTROLLER, SCALE)
    run = simulate(SOFT, msgspec.structs.replace(gains, leak=[0.0] * 6, basis=basis), STEP)
    V = run.lyapunov()
    assert run.learned[-1].max() > 0.01
    # Forces that hold for 1 ms and Euler's rule for θ leave a trace.
    assert np.diff(V).max() <= 2e-4 * V[0]
    assert V[-1] < V[0]


def test_a_law_without_a_known_function_says_so() -> None:
    with pytest.raises(InvalidControllerError, match="found ScaledPid; valid"):
        simulate(SOFT, law("scaled_pid"), STEP).lyapunov()


def test_names_say_what_a_law_needs() -> None:
    for name in controllers.NAMES:
        made = law(name)
        assert controllers.needs_rules(name) == (controllers.inference_of(made) is not None)
        model = controllers.model_of(made)
        assert (model is None) == (name.endswith("pid"))
        assert controllers.has_natural_frequency(name) == (model is not None and name != "pid_gravity")


@pytest.mark.parametrize(
    "make",
    [
        lambda: msgspec.structs.replace(PidGravity.default(SOFT, SCALE), kd=[-1.0] * 6),
        lambda: msgspec.structs.replace(PidFlc.default(SOFT, SCALE), ki=[1.0] * 5),
        lambda: Parallel(PdFlc.default(SOFT), Pid((1.0,) * 4, (1.0,) * 4, (1.0,) * 4)),
        lambda: msgspec.structs.replace(law("fuzzy_pid"), gu=[math.inf] * 6),
        lambda: msgspec.structs.replace(law("scaled_pid"), gu=[-0.1] * 6),
        lambda: msgspec.structs.replace(law("adaptive_fuzzy_flc"), kp=[0.0] * 6),
        lambda: msgspec.structs.replace(law("adaptive_fuzzy_flc"), basis="splines"),
        lambda: msgspec.structs.replace(law("adaptive_fuzzy_pid"), gamma=[math.nan] * 6),
        lambda: AdaptiveFuzzyPid.default(Pid((0.0,) * 6, (0.0,) * 6, (0.0,) * 6), CONTROLLER, SCALE),
        lambda: controllers.default("adaptive_fuzzy_flc", SOFT, STEP, CONTROLLER, natural_frequency=0.0),
        lambda: controllers.default("scaled_pid", SOFT, STEP),
    ],
)
def test_laws_that_cannot_be_are_refused(make: Any) -> None:
    with pytest.raises(InvalidControllerError, match=r"found .*; valid: "):
        make()
