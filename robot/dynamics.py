"""Dynamics of an arm: D(q) q̈ + C(q, q̇) q̇ + B q̇ + F(q̇) + G(q) = F_coeff(q) tau + Q_ext.

Thin wrappers over :mod:`robot.kernels`, for one configuration at a time. Positions are q = [s1 .. sN, θ1 .. θN]
(m, rad); n3 points along gravity, n1 is horizontal.
"""

from __future__ import annotations

import functools
import math
from typing import Literal, NamedTuple

import msgspec
import numpy as np
from numpy.typing import ArrayLike, NDArray

from robot.arm import Arm, parameters, read_only
from robot.errors import NoEquilibriumError, RobotError
from robot.kernels import actuation, matrices
from robot.kernels import dynamics as kernels

Array = NDArray[np.float64]

Reading = Literal["internal", "paper"]
"""Where an actuator force on rod i reacts: on rod i-1 (``internal``, realistic) or on the ground (``paper``, (14))."""

READINGS: dict[Reading, int] = {"internal": actuation.INTERNAL, "paper": actuation.PAPER}
"""Both readings and the kernels' codes for them."""


class Energy(NamedTuple):
    """Mechanical energy, J."""

    kinetic: float
    potential: float
    """Of gravity (0 at the base) and of the springs."""

    @property
    def total(self) -> float:
        """Kinetic plus potential energy."""
        return self.kinetic + self.potential


def mass_matrix(arm: Arm, q: ArrayLike) -> Array:
    """Return D(q) (2N, 2N), symmetric positive definite; equation (15) with its errata."""
    position = _lengthened(arm, _coordinates(arm, q, "q"), arm.payload_offset)
    D = np.empty((position.size, position.size))
    matrices.mass_matrix(_with_payload(arm), position, _directions(position), D)
    return _own(arm, D)


def coriolis_matrix(arm: Arm, q: ArrayLike, dq: ArrayLike) -> Array:
    """Return the Christoffel matrix C(q, q̇) (2N, 2N), for which Ḋ - 2C is skew."""
    position = _lengthened(arm, _coordinates(arm, q, "q"), arm.payload_offset)
    velocity = _lengthened(arm, _coordinates(arm, dq, "dq"), 0.0)
    C = np.empty((position.size, position.size))
    matrices.coriolis_matrix(_with_payload(arm), position, velocity, _directions(position), C)
    return _own(arm, C)


def coriolis_vector(arm: Arm, q: ArrayLike, dq: ArrayLike) -> Array:
    """Return C(q, q̇) q̇ (2N,): centrifugal and Coriolis forces, without dampers."""
    position = _coordinates(arm, q, "q")
    force = np.empty(position.size)
    kernels.rigid_body_force(
        parameters(arm),
        position,
        _coordinates(arm, dq, "dq"),
        np.zeros(position.size),
        0.0,
        _directions(position),
        force,
    )
    return force


def damping_vector(arm: Arm, dq: ArrayLike) -> Array:
    """Return B q̇ (2N,), the forces of the dampers."""
    velocity = _coordinates(arm, dq, "dq")
    force = np.zeros(velocity.size)
    # At rest length and straight, only the dampers push.
    relaxed = np.concatenate([parameters(arm).rest_length, np.zeros(arm.n_modules)])
    kernels.add_passive_force(parameters(arm)._replace(has_friction=0), relaxed, velocity, 1.0, force)
    return force


def friction_vector(arm: Arm, dq: ArrayLike) -> Array:
    """Return F(q̇) (2N,), the actuators' Coulomb friction with a smooth sign; F of equation (36)."""
    velocity = _coordinates(arm, dq, "dq")
    force = np.zeros(velocity.size)
    kernels.add_friction(parameters(arm), velocity, 1.0, force)
    return force


def gravity_vector(arm: Arm, q: ArrayLike) -> Array:
    """Return G(q) (2N,): what holds the arm at rest in q against gravity and springs; equation (17)."""
    position = _coordinates(arm, q, "q")
    rest = np.zeros(position.size)
    force = np.empty(position.size)
    kernels.inverse_dynamics(parameters(arm), position, rest, rest, _directions(position), force)
    return force


def stiffness_matrix(arm: Arm, q: ArrayLike) -> Array:
    """Return ∂G/∂q (2N, 2N), symmetric."""
    position = _lengthened(arm, _coordinates(arm, q, "q"), arm.payload_offset)
    K = np.empty((position.size, position.size))
    matrices.stiffness_matrix(_with_payload(arm), position, _directions(position), K)
    return _own(arm, K)


def inverse_dynamics(arm: Arm, q: ArrayLike, dq: ArrayLike, ddq: ArrayLike) -> Array:
    """Return Q (2N,) = D q̈ + C q̇ + B q̇ + F + G, the generalized force that moves the arm so."""
    position = _coordinates(arm, q, "q")
    force = np.empty(position.size)
    kernels.inverse_dynamics(
        parameters(arm),
        position,
        _coordinates(arm, dq, "dq"),
        _coordinates(arm, ddq, "ddq"),
        _directions(position),
        force,
    )
    return force


def acceleration(
    arm: Arm, q: ArrayLike, dq: ArrayLike, generalized_force: ArrayLike, load: ArrayLike | None = None
) -> Array:
    """Return q̈ (2N,) under generalized forces Q (2N,) and external forces on the masses.

    Args:
        arm: The arm.
        q: (2N,) position.
        dq: (2N,) velocity.
        generalized_force: (2N,) N on every s and N m on every θ.
        load: (N, 2) forces in N on the masses along n1 and n3; none by default.
    """
    position = _coordinates(arm, q, "q")
    velocity = _coordinates(arm, dq, "dq")
    force = _coordinates(arm, generalized_force, "generalized_force").copy()
    forces = np.zeros((arm.n_modules, 2)) if load is None else np.ascontiguousarray(load, dtype=np.float64)
    if forces.shape != (arm.n_modules, 2):
        raise RobotError(f"found shape {forces.shape}; valid: {(arm.n_modules, 2)}", "load")
    ddq = np.empty(position.size)
    kernels.forward_dynamics(parameters(arm), position, velocity, force, forces, _directions(position), ddq)
    return ddq


def force_matrix(arm: Arm, q: ArrayLike, reading: Reading = "internal") -> Array:
    """Return F_coeff(q) (2N, 2N), which turns tau = [F11, F21, F12, ...] into generalized forces; equation (14)."""
    position = _coordinates(arm, q, "q")
    work = _directions(position)
    F = np.empty((position.size, position.size))
    column = np.empty(position.size)
    for i, tau in enumerate(np.eye(position.size)):
        actuation.generalized_force(parameters(arm), READINGS[reading], position, tau, work, column)
        F[:, i] = column
    return F


def actuator_forces(arm: Arm, q: ArrayLike, generalized_force: ArrayLike, reading: Reading = "internal") -> Array:
    """Return the tau (2N,) with F_coeff(q) tau = generalized_force."""
    position = _coordinates(arm, q, "q")
    force = _coordinates(arm, generalized_force, "generalized_force")
    tau = np.empty(position.size)
    actuation.actuator_forces(parameters(arm), READINGS[reading], position, force, _directions(position), tau)
    return tau


def energy(arm: Arm, q: ArrayLike, dq: ArrayLike) -> Energy:
    """Return the kinetic and potential energy; equations (4) and (5) corrected."""
    position = _lengthened(arm, _coordinates(arm, q, "q"), arm.payload_offset)
    velocity = _lengthened(arm, _coordinates(arm, dq, "dq"), 0.0)
    return Energy(*matrices.energy(_with_payload(arm), position, velocity, _directions(position)))


@functools.lru_cache(maxsize=4096)
def _equilibrium(arm: Arm) -> Array:
    q = np.concatenate([parameters(arm).rest_length, np.zeros(arm.n_modules)])
    for _ in range(50):
        force = gravity_vector(arm, q)
        scale = 1.0 + float(np.abs(force).max())
        try:
            step = np.linalg.solve(stiffness_matrix(arm, q), force)
        except np.linalg.LinAlgError:
            break
        q = q - step
        if not np.isfinite(q).all():
            break
        if np.abs(step).max() < 1e-13 * scale:
            if np.linalg.eigvalsh(stiffness_matrix(arm, q))[0] <= 0.0:
                break
            q.flags.writeable = False
            return q
    raise NoEquilibriumError("found springs that cannot hold the arm; valid: stiffness greater than its weight needs")


def equilibrium(arm: Arm) -> Array:
    """Return the position (2N,) in which the arm hangs at rest without actuator forces, G(q) = 0 and stable.

    Raises:
        NoEquilibriumError: The springs cannot hold the arm.
    """
    return _equilibrium(arm).copy()


@functools.lru_cache(maxsize=4096)
def substeps(arm: Arm, step: float) -> int:
    """Return into how many Runge-Kutta steps a time ``step`` (s) is divided.

    The largest eigenvalue of the arm about its equilibrium, times the length of a Runge-Kutta step, stays below 0.1;
    the limit of stability is 2.8. Soft arm: 1, stiff arm: 2, at 1 ms.

    Raises:
        RobotError: An arm so stiff or so light that it needs more than 1000.
    """
    q = equilibrium(arm)
    n = q.size
    model = parameters(arm)
    steepest = msgspec.structs.replace(arm, damping=model.damping + model.friction / kernels.SLIP_SPEED)
    B = np.stack([damping_vector(steepest, unit) for unit in np.eye(n)], axis=1)
    D = mass_matrix(arm, q)
    system = np.zeros((2 * n, 2 * n))
    system[:n, n:] = np.eye(n)
    system[n:, :n] = -np.linalg.solve(D, stiffness_matrix(arm, q))
    system[n:, n:] = -np.linalg.solve(D, B)
    rate = float(np.abs(np.linalg.eigvals(system)).max())
    count = max(1, math.ceil(step * rate / 0.1))
    if count > 1000:
        raise RobotError(
            f"found an arm whose fastest motion takes {1 / rate:.2g} s (mass {model.mass.min():g} kg); "
            "valid: mass, inertia, stiffness and damping that 1000 steps in 1 ms can follow"
        )
    return count


def _coordinates(arm: Arm, values: ArrayLike, name: str) -> Array:
    vector = np.ascontiguousarray(values, dtype=np.float64)
    if vector.shape != (2 * arm.n_modules,):
        raise RobotError(f"found shape {vector.shape}; valid: {(2 * arm.n_modules,)}, s before theta", name)
    if not vector.flags.writeable:
        vector = vector.copy()
    return vector


@functools.lru_cache(maxsize=4096)
def _with_payload(arm: Arm) -> kernels.Parameters:
    """Return the arm's parameters with its payload as one more module, which cannot move, for the matrices."""
    model = parameters(arm)
    if arm.payload == 0.0:
        return model
    nothing = np.zeros((2, 1))
    return model._replace(
        mass=read_only([*model.mass, arm.payload]),
        inertia=read_only([*model.inertia, 0.0]),
        half_rod=read_only([*model.half_rod, 1.0]),
        rest_length=read_only([*model.rest_length, 1.0]),
        stiffness=read_only(np.hstack([model.stiffness, nothing])),
        damping=read_only(np.hstack([model.damping, nothing])),
        friction=read_only(np.hstack([model.friction, nothing])),
        payload=0.0,
    )


def _lengthened(arm: Arm, values: Array, length: float) -> Array:
    """Return positions or velocities (2N,) with those of the module that stands for the payload, if there is one."""
    if arm.payload == 0.0:
        return values
    return np.insert(values, [arm.n_modules, 2 * arm.n_modules], [length, 0.0])


def _own(arm: Arm, matrix: Array) -> Array:
    """Return a matrix without the rows and columns of the module that stands for the payload."""
    if arm.payload == 0.0:
        return matrix
    extra = [arm.n_modules, 2 * arm.n_modules + 1]
    return np.delete(np.delete(matrix, extra, axis=0), extra, axis=1)


def _directions(q: Array) -> kernels.Workspace:
    work = kernels.new_workspace(q.size // 2)
    kernels.directions(q, work)
    return work
