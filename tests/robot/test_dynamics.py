"""The arm's equations of motion against Lagrange's equations, and against the laws of mechanics."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from scipy.integrate import solve_ivp

from robot import dynamics
from robot.arm import Arm, parameters
from robot.errors import NoEquilibriumError, RobotError
from tests.robot.arms import random_state, states, uneven_arm
from tests.robot.lagrange import derive

SEEDS = range(5)
SIZES = (1, 2, 3, 5, 8)


def arguments(arm: Arm, q: np.ndarray, dq: np.ndarray) -> list:
    return [q, dq, arm.mass, arm.inertia, arm.rod_length, arm.rest_length, *arm.stiffness, *arm.damping, arm.gravity]


@pytest.mark.parametrize("seed", SEEDS)
def test_every_term_equals_lagranges_equations(seed: int) -> None:
    arm = uneven_arm(seed=seed)
    q, dq = random_state(seed=seed)
    values, expected = arguments(arm, q, dq), derive()

    def close(ours: np.ndarray, symbolic: np.ndarray) -> None:
        np.testing.assert_allclose(ours, symbolic, rtol=1e-12, atol=1e-12 * np.abs(symbolic).max())

    close(dynamics.mass_matrix(arm, q), expected.D(*values))
    close(dynamics.coriolis_vector(arm, q, dq), expected.C_dq(*values))
    close(dynamics.coriolis_matrix(arm, q, dq) @ dq, expected.C_dq(*values))
    close(dynamics.damping_vector(arm, dq), expected.B_dq(*values))
    close(dynamics.gravity_vector(arm, q), expected.G(*values))
    close(dynamics.stiffness_matrix(arm, q), expected.K(*values))
    close(dynamics.force_matrix(arm, q, "paper"), expected.F_paper(*values))
    close(dynamics.force_matrix(arm, q, "internal"), expected.F_internal(*values))
    close(np.array(dynamics.energy(arm, q, dq)), expected.energy(*values))


def test_the_closed_forms_of_the_mass_matrix() -> None:
    """Equation (15) with its errata."""
    arm = uneven_arm()
    q, _ = random_state()
    (m1, m2, m3), (I1, I2, I3) = parameters(arm).mass, parameters(arm).inertia
    _, s2, s3, a, b, _ = q
    M = m2 + m3
    D55 = I2 + I3 + m3 * s3**2
    D45 = D55 + m3 * s2 * s3 * np.cos(b)
    D44 = I1 + M * s2**2 + 2 * m3 * s2 * s3 * np.cos(b) + D55
    D14 = -M * s2 * np.sin(a) - m3 * s3 * np.sin(a + b)
    D15, D24 = -m3 * s3 * np.sin(a + b), -m3 * s3 * np.sin(b)
    expected = [
        [m1 + M, M * np.cos(a), m3 * np.cos(a + b), D14, D15, 0],
        [M * np.cos(a), M, m3 * np.cos(b), D24, D24, 0],
        [m3 * np.cos(a + b), m3 * np.cos(b), m3, m3 * s2 * np.sin(b), 0, 0],
        [D14, D24, m3 * s2 * np.sin(b), D44, D45, I3],
        [D15, D24, 0, D45, D55, I3],
        [0, 0, 0, I3, I3, I3],
    ]
    np.testing.assert_allclose(dynamics.mass_matrix(arm, q), expected, rtol=1e-13, atol=1e-16)


def test_the_closed_forms_of_the_coriolis_forces() -> None:
    """Equation (16) with its errata."""
    arm = uneven_arm()
    q, dq = random_state()
    _, m2, m3 = arm.mass
    _, s2, s3, a, b, _ = q
    _, v2, v3, w1, w2, _ = dq
    M, w = m2 + m3, w1 + w2
    sin_b, cos_b, sin_ab, cos_ab = np.sin(b), np.cos(b), np.sin(a + b), np.cos(a + b)
    expected = [
        -2 * M * np.sin(a) * v2 * w1 - M * s2 * np.cos(a) * w1**2 - m3 * (2 * sin_ab * v3 * w + s3 * cos_ab * w**2),
        -M * s2 * w1**2 - m3 * (2 * sin_b * v3 * w + s3 * cos_b * w**2),
        m3 * (2 * sin_b * v2 * w1 - s2 * cos_b * w1**2 - s3 * w**2),
        2 * (M * s2 + m3 * s3 * cos_b) * v2 * w1
        + 2 * m3 * (s3 + s2 * cos_b) * v3 * w
        - m3 * s2 * s3 * sin_b * w2 * (2 * w1 + w2),
        m3 * s3 * (2 * cos_b * v2 * w1 + 2 * v3 * w + s2 * sin_b * w1**2),
        0,
    ]
    np.testing.assert_allclose(dynamics.coriolis_vector(arm, q, dq), expected, rtol=1e-12, atol=1e-15)


@pytest.mark.parametrize("n", SIZES)
def test_forward_and_inverse_dynamics_and_the_matrices_agree(n: int) -> None:
    arm = uneven_arm(n)
    q, dq = random_state(n)
    force, load = np.random.default_rng(1).normal(size=2 * n), np.random.default_rng(2).normal(size=(n, 2))
    ddq = dynamics.acceleration(arm, q, dq, force)
    resisting = (
        dynamics.coriolis_vector(arm, q, dq) + dynamics.damping_vector(arm, dq) + dynamics.gravity_vector(arm, q)
    )
    D = dynamics.mass_matrix(arm, q)
    np.testing.assert_allclose(D @ ddq + resisting, force, rtol=1e-10, atol=1e-11)
    np.testing.assert_allclose(dynamics.inverse_dynamics(arm, q, dq, ddq), force, rtol=1e-10, atol=1e-11)
    # A load works on the coordinates through the Jacobian of its mass.
    still = dynamics.acceleration(arm, q, dq, force, load) - ddq
    jacobian = np.array([mass_jacobian(arm, q, i) for i in range(n)])
    np.testing.assert_allclose(D @ still, np.einsum("nip,ni->p", jacobian, load), rtol=1e-9, atol=1e-10)


def mass_jacobian(arm: Arm, q: np.ndarray, i: int) -> np.ndarray:
    """d(p_i)/dq (2, 2N) as §2 of the model writes it."""
    n = arm.n_modules
    phi = np.concatenate([[0.0], np.cumsum(q[n:-1])])
    d, normal = np.array([np.sin(phi), np.cos(phi)]), np.array([np.cos(phi), -np.sin(phi)])
    J = np.zeros((2, 2 * n))
    for k in range(i + 1):
        J[:, k] = d[:, k]
    for j in range(i):
        J[:, n + j] = sum(q[k] * normal[:, k] for k in range(j + 1, i + 1))
    return J


@pytest.mark.parametrize("n", SIZES)
def test_forces_are_the_slopes_of_the_potential_energy(n: int) -> None:
    arm = uneven_arm(n)
    q, dq = random_state(n)
    rest, h = np.zeros(2 * n), 1e-5
    for i, unit in enumerate(np.eye(2 * n)):
        slope = (
            dynamics.energy(arm, q + h * unit, rest).potential - dynamics.energy(arm, q - h * unit, rest).potential
        ) / (2 * h)
        assert slope == pytest.approx(dynamics.gravity_vector(arm, q)[i], abs=1e-6)
        change = (dynamics.gravity_vector(arm, q + h * unit) - dynamics.gravity_vector(arm, q - h * unit)) / (2 * h)
        np.testing.assert_allclose(dynamics.stiffness_matrix(arm, q)[:, i], change, atol=1e-5)
    kinetic = dynamics.energy(arm, q, dq).kinetic
    assert kinetic == pytest.approx(dq @ dynamics.mass_matrix(arm, q) @ dq / 2, rel=1e-12)


@given(states())
def test_the_mass_matrix_is_symmetric_and_positive_definite_even_when_a_module_has_no_length(state: tuple) -> None:
    D = dynamics.mass_matrix(uneven_arm(), state[0])
    assert np.array_equal(D, D.T)
    assert np.linalg.eigvalsh(D)[0] > 0


@settings(max_examples=30)
@given(states())
def test_mass_matrix_rate_less_twice_coriolis_is_skew(state: tuple) -> None:
    arm = uneven_arm()
    q, dq = state
    h = 1e-6
    rate = (dynamics.mass_matrix(arm, q + h * dq) - dynamics.mass_matrix(arm, q - h * dq)) / (2 * h)
    S = rate - 2 * dynamics.coriolis_matrix(arm, q, dq)
    np.testing.assert_allclose(S + S.T, 0, atol=1e-8)


@given(states())
def test_both_force_readings_invert_in_every_configuration(state: tuple) -> None:
    arm = uneven_arm()
    q, force = state
    for reading in dynamics.READINGS:
        F = dynamics.force_matrix(arm, q, reading)
        assert np.linalg.det(F) == pytest.approx(np.prod(arm.rod_length), rel=1e-9)
        np.testing.assert_allclose(F @ dynamics.actuator_forces(arm, q, force, reading), force, atol=1e-10)


def test_the_last_angle_moves_only_its_own_rod() -> None:
    """θ3 eliminates exactly: a torque on rod 3 (which works on every angle) leaves the masses and other rods alone."""
    arm = uneven_arm()
    q, dq = random_state()
    torque = np.array([0, 0, 0, 0.01, 0.01, 0.01])
    change = dynamics.acceleration(arm, q, dq, torque) - dynamics.acceleration(arm, q, dq, np.zeros(6))
    np.testing.assert_allclose(change, [0, 0, 0, 0, 0, 0.01 / parameters(arm).inertia[2]], atol=1e-9)


@pytest.mark.parametrize("name", ["soft", "stiff"])
def test_the_equilibrium_of_a_preset_hangs_straight(name: str) -> None:
    arm = Arm.preset(name)
    q = dynamics.equilibrium(arm)
    np.testing.assert_allclose(dynamics.gravity_vector(arm, q), 0, atol=1e-11)
    np.testing.assert_allclose(q[3:], 0, atol=1e-12)
    carried = np.cumsum(arm.mass[::-1])[::-1] * 9.81
    np.testing.assert_allclose(q[:3], 0.11 + carried / np.sum(arm.stiffness, axis=0), rtol=1e-12)


def test_an_uneven_arm_hangs_crooked_but_at_rest() -> None:
    arm = uneven_arm()
    q = dynamics.equilibrium(arm)
    np.testing.assert_allclose(dynamics.acceleration(arm, q, np.zeros(6), np.zeros(6)), 0, atol=1e-8)
    assert np.abs(q[3:]).max() > 0.01


def test_an_arm_without_springs_has_no_equilibrium() -> None:
    arm = Arm(mass=[1.0], rod_length=0.1, rest_length=0.1, stiffness=[[0.0], [0.0]], damping=[[1.0], [1.0]])
    with pytest.raises(NoEquilibriumError):
        dynamics.equilibrium(arm)


def test_natural_frequencies_of_the_presets() -> None:
    def frequencies(name: str) -> np.ndarray:
        arm = Arm.preset(name)
        q = dynamics.equilibrium(arm)
        squares = np.linalg.eigvals(np.linalg.solve(dynamics.mass_matrix(arm, q), dynamics.stiffness_matrix(arm, q)))
        return np.sort(np.sqrt(squares)) / (2 * np.pi)

    np.testing.assert_allclose(frequencies("soft")[[0, -1]], [1.4, 11.4], rtol=0.05)
    np.testing.assert_allclose(frequencies("stiff")[[0, -1]], [2.9, 31], rtol=0.05)


def printed_coriolis_matrix(arm: Arm, q: np.ndarray, dq: np.ndarray) -> np.ndarray:
    """Equation (16) as printed, without its damping coefficients."""
    _, m2, m3 = arm.mass
    _, s2, s3, a, b, _ = q
    _, _, _, w1, w2, _ = dq
    sin, cos = np.sin, np.cos
    w = w1 + w2
    C = np.zeros((6, 6))
    C[0, 1] = -2 * m2 * sin(a) * w1 - 2 * m3 * sin(a) * w1
    C[0, 2] = -2 * m3 * sin(a + b) * w
    C[0, 3] = -m2 * s2 * cos(a) * w1 - m3 * s2 * cos(a) * w1 - m3 * s3 * cos(a + b) * w1
    C[0, 4] = -m3 * s3 * sin(a + b)
    C[1, 2] = -2 * m3 * sin(b) * w
    C[1, 3] = -m3 * s3 * w1 - m3 * s2 * w1
    C[1, 4] = -2 * m3 * s3 * cos(b) * w1 - m3 * s3 * cos(b) * w1
    C[2, 1] = 2 * m3 * sin(b) * w1
    C[2, 3] = -m3 * s3 * s2 * cos(b) * w1 - m3 * s3 * w1
    C[2, 4] = -2 * m3 * s3 * w1 - m3 * s3 * w2
    C[3, 1] = 2 * m3 * s3 * cos(b) * w1 - 2 * m3 * s2 * w1 + 2 * m2 * s2 * w1
    C[3, 2] = 2 * m3 * s3 * w - 2 * m3 * s2 * cos(b) * w
    C[3, 3] = 2 * m3 * s3 * s2 * sin(b) * w2
    C[3, 4] = m3 * s3 * s2 * sin(b) * w2
    C[4, 1] = 2 * m3 * s3 * cos(b) * w1
    C[4, 2] = 2 * m3 * s3 * w
    C[4, 3] = m3 * s3 * s2 * sin(b) * w1
    return C


def test_the_printed_coriolis_matrix_creates_energy_and_ours_does_not() -> None:
    """Equation (16) must not be restored: without forces and dampers its arm gains energy out of nothing."""
    arm = Arm.preset("soft").scaled(damping=0.0)
    start = dynamics.equilibrium(arm) + np.array([0.02, -0.02, 0.03, 0.6, -0.5, 0.4])

    def gain(printed: bool) -> float:
        def rate(_: float, x: np.ndarray) -> np.ndarray:
            q, dq = x[:6], x[6:]
            force = np.zeros(6)
            if printed:
                force = dynamics.coriolis_vector(arm, q, dq) - printed_coriolis_matrix(arm, q, dq) @ dq
            return np.concatenate([dq, dynamics.acceleration(arm, q, dq, force)])

        x = np.concatenate([start, np.zeros(6)])
        before = dynamics.energy(arm, x[:6], x[6:]).total
        end = solve_ivp(rate, (0, 1.0), x, rtol=1e-10, atol=1e-12, method="DOP853").y[:, -1]
        return dynamics.energy(arm, end[:6], end[6:]).total - before

    assert abs(gain(printed=False)) < 1e-8
    assert gain(printed=True) > 1e-2


def test_wrong_shapes_are_refused() -> None:
    arm = Arm.preset("soft")
    with pytest.raises(RobotError, match=r"q: found shape \(3,\); valid: \(6,\)"):
        dynamics.mass_matrix(arm, [0.1, 0.1, 0.1])
    with pytest.raises(RobotError, match="load"):
        dynamics.acceleration(arm, np.ones(6), np.ones(6), np.ones(6), load=np.ones(3))
