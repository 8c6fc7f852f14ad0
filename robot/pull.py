"""A hand that pulls a point of the arm with a spring, for live simulations."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from robot import kinematics
from robot.arm import Arm
from robot.errors import InvalidScenarioError

Array = NDArray[np.float64]

STIFFNESS = 60.0
"""Default stiffness of the spring, N/m: as soft as the soft arm."""

MOST_FORCE = 30.0
"""Default limit of its force, N."""

_PLACES = 97
"""Places along the arm among which the nearest is looked for."""


class Pull(NamedTuple):
    """A spring from a point of the arm to a place.

    Attributes:
        point: Which point, in modules from the base, as in :class:`robot.disturbance.Push`.
        place: (2,) where the hand is, along n1 and n3, m.
        stiffness: N/m.
    """

    point: float
    place: tuple[float, float]
    stiffness: float = STIFFNESS

    def held(self, arm: Arm, q: ArrayLike) -> Array:
        """Return where the point is at q (2N,), (2,) along n1 and n3, m."""
        return _points(arm, q, np.array([self.point]))[0]

    def force(self, arm: Arm, q: ArrayLike) -> Array:
        """Return the spring's force (2,) on the arm at q (2N,), N; it is not drawn out beyond ``MOST_FORCE``."""
        force = self.stiffness * (np.asarray(self.place) - self.held(arm, q))
        size = float(np.hypot(*force))
        return force * (MOST_FORCE / size) if size > MOST_FORCE else force

    def load(self, arm: Arm, q: ArrayLike) -> Array:
        """Return the force as a load (N, 2) on the masses, as :class:`robot.simulation.Simulation` takes it.

        Raises:
            InvalidScenarioError: A point that the arm does not have.
        """
        n = arm.n_modules
        if not 0.0 <= self.point <= n:
            raise InvalidScenarioError(f"found {self.point:g}; valid: 0 to {n}", "pull.point")
        module = min(int(self.point), n - 1)
        share = self.point - module
        load = np.zeros((n, 2))
        force = self.force(arm, q)
        load[module] = share * force
        if module > 0:
            load[module - 1] = (1.0 - share) * force
        return load


def nearest_point(arm: Arm, q: ArrayLike, place: ArrayLike) -> float:
    """Return the point of the arm, in modules from the base, that is nearest to a place (2,) along n1 and n3."""
    candidates = np.linspace(0.0, arm.n_modules, _PLACES)
    distance = np.linalg.norm(_points(arm, q, candidates) - np.asarray(place), axis=1)
    return float(candidates[int(distance.argmin())])


def _points(arm: Arm, q: ArrayLike, point: Array) -> Array:
    """Return places (n, 2) of points between the rods' centres."""
    position = kinematics.rods(arm, q).position
    rods = np.arange(len(position))
    return np.stack([np.interp(point, rods, position[:, axis]) for axis in (0, 1)], axis=1)
