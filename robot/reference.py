"""The target's motion as the kernel reads it, and inverse kinematics for a circle of the tip."""

from __future__ import annotations

import functools
import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from robot import kinematics
from robot.arm import Arm, read_only
from robot.errors import InvalidScenarioError, RobotError
from robot.kernels import control
from robot.scenario import (
    STANDARD_BEND,
    STANDARD_EXTENSION,
    STEP,
    Hold,
    Scenario,
    Sequence,
    Sinus,
    Step,
    TipCircle,
    amplitude,
)

Array = NDArray[np.float64]

TOLERANCE = 1e-6
"""m; a place is reached when the tip is so near to it."""

_ROUND = 64
"""Places on a circle for which the inverse kinematics is solved; between them runs a Fourier series."""


def tip_position(arm: Arm, q: ArrayLike) -> Array:
    """Return the centre (2,) of the last rod along n1 and n3, m."""
    return kinematics.rods(arm, q).position[..., -1, :]


def tip_jacobian(arm: Arm, q: Array) -> Array:
    """Return d(tip position)/dq (2, 2N)."""
    n = arm.n_modules
    phi = np.concatenate([[0.0], np.cumsum(q[n:-1])])
    along = np.stack([np.sin(phi), np.cos(phi)])
    links = q[:n] * np.stack([np.cos(phi), -np.sin(phi)])
    # Joint j turns every link behind it.
    turned = np.cumsum(links[:, ::-1], axis=1)[:, ::-1] - links
    return np.concatenate([along, turned], axis=1)


def inverse_kinematics(arm: Arm, place: ArrayLike, near: Array) -> Array:
    """Return the position (2N,) with the tip at a place, as little as possible away from ``near``.

    Least squares: Gauss-Newton on the smallest (q - near) W (q - near) under the tip's two equations, W in units of
    the standard step.

    Args:
        arm: The arm.
        place: (2,) along n1 and n3, m.
        near: (2N,) position.

    Raises:
        RobotError: The place cannot be reached; the message says by how much it is missed.
    """
    goal = np.asarray(place, dtype=np.float64)
    n = arm.n_modules
    weight = np.repeat([STANDARD_EXTENSION, STANDARD_BEND], n) ** 2
    q = near.copy()
    for _ in range(50):
        J = tip_jacobian(arm, q)
        miss = goal - tip_position(arm, q) + J @ (q - near)
        q = near + weight * (J.T @ np.linalg.lstsq(J * weight @ J.T, miss, rcond=1e-12)[0])
        # Far away the step is no longer small: keep lengths and angles where the geometry means something.
        q = np.clip(q, np.repeat([0.0, -math.pi], n), np.repeat([10.0 * max(near[:n]), math.pi], n))
        if np.abs(goal - tip_position(arm, q)).max() < TOLERANCE / 10:
            break
    distance = float(np.linalg.norm(goal - tip_position(arm, q)))
    shortest = float(kinematics.shortest_actuator(arm, q))
    if not distance <= TOLERANCE or shortest <= TOLERANCE:
        why = (
            f"missed by {1e3 * distance:.3g} mm" if distance > TOLERANCE else f"an actuator of {1e3 * shortest:.3g} mm"
        )
        raise RobotError(
            f"found ({goal[0]:.4g}, {goal[1]:.4g}) m, {why}; valid: a place within the arm's reach", "place"
        )
    return q


def circle(arm: Arm, start: Array, reference: TipCircle) -> Array:
    """Return the target on a circle of the tip and its two time derivatives (rows, 3, 2N), one row a control step.

    Raises:
        InvalidScenarioError: A part of the circle is out of reach.
    """
    angle = np.arange(_ROUND) * 2 * math.pi / _ROUND
    places = tip_position(arm, start) + reference.radius * np.stack([np.sin(angle), np.cos(angle) - 1.0], axis=1)
    try:
        corners = np.stack([inverse_kinematics(arm, place, start) for place in places])
    except RobotError as error:
        raise InvalidScenarioError(f"unreachable: {error.message}", "reference.radius") from None
    series = np.fft.rfft(corners, axis=0) / _ROUND
    series[1:-1] *= 2.0
    order = np.arange(len(series))
    rate = 2 * math.pi / reference.period
    turn = np.exp(1j * np.outer(np.arange(round(reference.period / STEP)) * STEP * rate, order))
    return np.stack([(turn @ ((1j * rate * order[:, np.newaxis]) ** d * series)).real for d in range(3)], axis=1)


@functools.lru_cache(maxsize=16)
def _circle(arm: Arm, start: tuple[float, ...], reference: TipCircle) -> Array:
    return read_only(circle(arm, np.array(start), reference))


def reference_arrays(arm: Arm, start: Array, scenario: Scenario) -> control.ReferenceArrays:
    """Return the target's motion of a scenario.

    Args:
        arm: The arm that the target is meant for.
        start: (2N,) q0.
        scenario: The experiment.

    Raises:
        InvalidScenarioError: Amplitudes for another number of modules, or a circle that is out of reach.
    """
    n = arm.n_modules
    nothing = control.ReferenceArrays(
        kind=control.STEP,
        start=read_only(start),
        amplitude=read_only(np.zeros(2 * n)),
        rate=0.0,
        table=read_only(np.zeros((1, 3, 2 * n))),
        dwell=1,
        cyclic=0,
        prefilter=scenario.prefilter or 0.0,
    )
    match scenario.reference:
        case Hold():
            return nothing
        case Step():
            return nothing._replace(amplitude=read_only(scenario.amplitude(n)))
        case Sinus(frequency=frequency):
            moving = read_only(scenario.amplitude(n))
            return nothing._replace(kind=control.SINUS, amplitude=moving, rate=2 * math.pi * frequency)
        case Sequence(steps=steps, dwell=dwell):
            table = np.zeros((len(steps), 3, 2 * n))
            table[:, 0] = start + np.stack([amplitude(step, n) for step in steps])
            rows = max(1, round(dwell / STEP))
            return nothing._replace(kind=control.TABLE, table=read_only(table), dwell=rows)
        case TipCircle():
            table = _circle(arm, tuple(start.tolist()), scenario.reference)
            return nothing._replace(kind=control.TABLE, table=table, cyclic=1)
