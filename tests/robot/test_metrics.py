"""Figures of merit on responses whose figures are known in closed form."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest

from robot import metrics
from robot.metrics import Metrics, measure

T = np.linspace(0.0, 10.0, 100_001)


def second_order(damping_ratio: float, frequency: float = 2.0) -> np.ndarray:
    """Unit step response of ωn² / (s² + 2 ζ ωn s + ωn²)."""
    if damping_ratio == 1.0:
        return 1.0 - (1.0 + frequency * T) * np.exp(-frequency * T)
    damped = frequency * math.sqrt(1.0 - damping_ratio**2)
    decay = np.exp(-damping_ratio * frequency * T)
    return 1.0 - decay * (np.cos(damped * T) + damping_ratio * frequency / damped * np.sin(damped * T))


def measured(
    y: np.ndarray, amplitude: float = 1.0, *, constant: bool = True, forces: np.ndarray | None = None
) -> Metrics:
    """One module: s follows y, θ is not asked to move and does not."""
    q = np.stack([0.5 + amplitude * y, np.zeros_like(y)], axis=1)
    return measure(
        T,
        q,
        np.tile([0.5 + amplitude, 0.0], (len(y), 1)),
        np.zeros((len(y), 2)) if forces is None else forces,
        np.array([0.5, 0.0]),
        np.array([amplitude, 0.0]),
        np.array([abs(amplitude), 0.3]),
        constant=constant,
        force_limits=(-2.0, 2.0),
    )


@pytest.mark.parametrize("ratio", [0.2, 0.5, 0.7])
def test_overshoot_of_a_second_order_step_response(ratio: float) -> None:
    expected = 100.0 * math.exp(-math.pi * ratio / math.sqrt(1 - ratio**2))
    assert measured(second_order(ratio)).overshoot["s1"] == pytest.approx(expected, rel=1e-6)
    assert metrics.overshoot(second_order(1.0)) == 0.0


def test_a_downward_step_is_measured_like_an_upward_one() -> None:
    up, down = measured(second_order(0.3), 0.04), measured(second_order(0.3), -0.04)
    for name in Metrics._fields:
        assert getattr(up, name) == pytest.approx(getattr(down, name), nan_ok=True, rel=1e-9)


def test_integrals_of_the_critically_damped_step_response() -> None:
    """With ωn: ∫(1+ωt)e^{-ωt} dt = 2/ω, of its square 5/(4ω), times t 3/ω²."""
    m = measured(second_order(1.0, 2.0), 0.03)
    assert m.iae["s1"] == pytest.approx(2 / 2.0, rel=1e-6)
    assert m.ise["s1"] == pytest.approx(5 / (4 * 2.0), rel=1e-6)
    assert m.itae["s1"] == pytest.approx(3 / 2.0**2, rel=1e-6)
    assert m.rms_error["s1"] == pytest.approx(100 * math.sqrt(5 / 8 / 10), rel=1e-6)


def test_rise_and_settling_of_a_first_order_lag() -> None:
    m = measured(1.0 - np.exp(-T))
    assert m.rise_time["s1"] == pytest.approx(math.log(9), rel=1e-6)
    assert m.settling_time["s1"] == pytest.approx(math.log(50), rel=1e-6)
    assert m.steady_state_error["s1"] == pytest.approx(100 * math.exp(-9) * (1 - math.exp(-1)), rel=1e-3)


def test_what_is_never_reached_is_infinite_and_none_in_json() -> None:
    m = measured(np.full_like(T, 0.5))
    assert m.rise_time["s1"] == math.inf
    assert m.settling_time["worst"] == math.inf
    assert m.steady_state_error["s1"] == pytest.approx(50)
    written = m.to_dict()
    assert written["settling_time"] == {"s1": None, "theta1": None, "worst": None}
    json.dumps(written, allow_nan=False)


def test_a_coordinate_that_is_not_asked_to_move_has_no_step_figures() -> None:
    m = measured(second_order(0.5))
    for name in ("overshoot", "rise_time", "settling_time", "steady_state_error"):
        assert math.isnan(getattr(m, name)["theta1"])
        assert getattr(m, name)["worst"] == getattr(m, name)["s1"]
    assert m.iae["theta1"] == 0.0


def test_a_sinus_has_error_figures_only() -> None:
    m = measured(np.sin(T), constant=False)
    assert math.isnan(m.overshoot["worst"])
    assert m.iae["s1"] > 0


def test_figures_of_the_forces() -> None:
    forces = np.stack([np.full_like(T, -1.5), np.where(T < 2.5, 2.0, 0.0)], axis=1)
    m = measured(second_order(1.0), forces=forces)
    assert m.effort["F11"] == pytest.approx(1.5**2 * 10)
    assert m.peak_force == {"F11": 1.5, "F21": 2.0, "worst": 2.0}
    assert m.saturation == pytest.approx({"F11": 0.0, "F21": 25.0, "worst": 25.0}, rel=1e-3)


def test_a_run_without_rows_defines_nothing() -> None:
    nothing = np.zeros((0, 2))
    m = measure(T[:0], nothing, nothing, nothing, np.zeros(2), np.ones(2), np.ones(2), constant=True, force_limits=None)
    assert all(value is None for values in m.to_dict().values() for value in values.values())
