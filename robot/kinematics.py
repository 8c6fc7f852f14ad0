"""Where the arm is: rods, a smooth backbone and the actuators, for drawing.

All places are (n1, n3) in metres: n1 is horizontal, n3 points down along gravity, the base is the origin. Angles count
from n3 towards n1. Positions q may have leading dimensions, such as time; results then have them too.
"""

from __future__ import annotations

import functools
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from robot.arm import Arm, parameters
from robot.errors import RobotError

Array = NDArray[np.float64]


class Rods(NamedTuple):
    """The rigid rods that the actuators end on: the base plate first, then one a module.

    Attributes:
        position: (..., N + 1, 2) centre, where a module's mass is.
        angle: (..., N + 1) direction of the rod's normal, rad; 0 for the base, then θ1, θ1 + θ2, ...
        ends: (..., N + 1, 2, 2) places where actuator 1 and actuator 2 are fixed; a positive angle stretches actuator
            1, which is therefore on the side of negative n1. The base is as long as module 1's rod.
    """

    position: Array
    angle: Array
    ends: Array


class Curve(NamedTuple):
    """A smooth curve in the n1-n3 plane.

    Attributes:
        points: (..., m, 2) places, from the base on.
        tangents: (..., m, 2) unit vectors along the curve.
        normals: (..., m, 2) unit vectors across it, (cos, -sin) where the tangent is (sin, cos).
    """

    points: Array
    tangents: Array
    normals: Array


def rods(arm: Arm, q: ArrayLike) -> Rods:
    """Return the poses of the base and of every rod at q (..., 2N)."""
    position = _coordinates(arm, q)
    n = arm.n_modules
    angle = np.zeros((*position.shape[:-1], n + 1))
    np.cumsum(position[..., n:], axis=-1, out=angle[..., 1:])
    d = _direction(angle)
    center = np.zeros((*position.shape[:-1], n + 1, 2))
    np.cumsum(position[..., :n, np.newaxis] * d[..., :n, :], axis=-2, out=center[..., 1:, :])
    lever = np.concatenate([parameters(arm).half_rod[:1], parameters(arm).half_rod])[:, np.newaxis] * _across(d)
    return Rods(center, angle, np.stack([center - lever, center + lever], axis=-2))


def backbone(arm: Arm, q: ArrayLike, n_points: int = 33, *, cap: bool = True) -> Curve:
    """Return the arm's centre line as a quadratic B-spline over the polygon of the rods' centres.

    Its curvature is about θ/s, and it passes the rods within 6 mm at the bends of the standard step; arcs of constant
    curvature from module to module would miss the tip by 65 mm, because the model bends at the rods.

    Args:
        arm: The arm.
        q: (..., 2N) position.
        n_points: Number of points, 2 or more, evenly spread over the modules.
        cap: Whether the curve goes on for half a module behind the last rod, so that it shows the last θ.
    """
    end = arm.n_modules + (0.5 if cap else 0.0)
    return _spline(_polygon(arm, _coordinates(arm, q)), tuple(np.linspace(0.0, end, n_points).tolist()))


def actuators(arm: Arm, q: ArrayLike, n_points: int = 9) -> tuple[Curve, ...]:
    """Return the curves of the 2N actuators in the order F11, F21, F12, ...

    They run alongside the backbone at ±l/2 from rod to rod and end exactly on the rods.

    Args:
        arm: The arm.
        q: (..., 2N) position.
        n_points: Number of points of each curve, 2 or more.
    """
    polygon = _polygon(arm, _coordinates(arm, q))
    ends = rods(arm, q).ends
    share = np.linspace(0.0, 1.0, n_points)
    curves = []
    for module in range(arm.n_modules):
        middle = _spline(polygon, tuple((module + share).tolist()))
        for actuator, side in enumerate((-1.0, 1.0)):
            points = middle.points + side * parameters(arm).half_rod[module] * middle.normals
            # The backbone passes the rods at a small distance; a share of it that varies linearly closes the gap.
            first = ends[..., module, actuator, :] - points[..., 0, :]
            last = ends[..., module + 1, actuator, :] - points[..., -1, :]
            correction = (1.0 - share)[:, np.newaxis] * first[..., np.newaxis, :]
            correction = correction + share[:, np.newaxis] * last[..., np.newaxis, :]
            curves.append(Curve(points + correction, middle.tangents, middle.normals))
    return tuple(curves)


def shortest_actuator(arm: Arm, q: ArrayLike) -> Array:
    """Return the length (...) of the shortest actuator, s - (l/2)|θ|; what is not positive no real arm can do."""
    position = _coordinates(arm, q)
    n = arm.n_modules
    lengths = position[..., :n] - parameters(arm).half_rod * np.abs(position[..., n:])
    return lengths.min(axis=-1)


def _coordinates(arm: Arm, q: ArrayLike) -> Array:
    position = np.asarray(q, dtype=np.float64)
    if position.ndim == 0 or position.shape[-1] != 2 * arm.n_modules:
        raise RobotError(f"found shape {position.shape}; valid: (..., {2 * arm.n_modules}), s before theta", "q")
    return position


def _direction(angle: Array) -> Array:
    return np.stack([np.sin(angle), np.cos(angle)], axis=-1)


def _across(direction: Array) -> Array:
    """Return (cos, -sin) for (sin, cos)."""
    return np.stack([direction[..., 1], -direction[..., 0]], axis=-1)


def _polygon(arm: Arm, q: Array) -> Array:
    """Return the control points (..., N + 3, 2): a mirrored one before the base, the rods, and one behind the tip."""
    n = arm.n_modules
    poses = rods(arm, q)
    before = -poses.position[..., 1:2, :]
    tip = _direction(poses.angle[..., n:])
    behind = poses.position[..., n:, :] + q[..., n - 1 : n, np.newaxis] * tip
    return np.concatenate([before, poses.position, behind], axis=-2)


def _spline(polygon: Array, parameter: tuple[float, ...]) -> Curve:
    place, rate = _basis(polygon.shape[-2], parameter)
    points = place @ polygon
    tangents = rate @ polygon
    length = np.linalg.norm(tangents, axis=-1, keepdims=True)
    # Only a module without any length leaves no direction; it is drawn as hanging straight.
    tangents = np.where(length > 1e-12, tangents / np.maximum(length, 1e-12), [0.0, 1.0])
    return Curve(points, tangents, _across(tangents))


@functools.lru_cache(maxsize=64)
def _basis(n_controls: int, parameter: tuple[float, ...]) -> tuple[Array, Array]:
    """Return the uniform quadratic B-spline's weights and their derivatives, (m, n_controls) each.

    Parameter u = i is where the curve is nearest to control point i + 1, which is rod i; the base is 0.
    """
    place = np.zeros((len(parameter), n_controls))
    rate = np.zeros((len(parameter), n_controls))
    for row, u in enumerate(parameter):
        center = min(int(u + 0.5), n_controls - 3)
        t = u + 0.5 - center
        place[row, center : center + 3] = 0.5 * (1 - t) ** 2, 0.5 + t - t**2, 0.5 * t**2
        rate[row, center : center + 3] = t - 1, 1 - 2 * t, t
    return place, rate
