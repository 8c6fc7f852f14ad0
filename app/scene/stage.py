"""Where things stand in the scene, and the ways between the arm's plane and the scene's axes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from robot.arm import Arm, parameters

Array = NDArray[np.float64]
Place = tuple[float, float, float]

BOARD: Place = (-0.235, -0.30, 0.0)
"""Middle of the rule board, m."""
SURFACE: Place = (0.235, -0.30, 0.0)
"""Middle of the control surface's floor, m."""
SIDE = 0.40
"""Side of the board and of the surface, m."""
RISE = 0.16
"""Height of the surface over the range of the output, m."""

_STRETCH = 1.65
_CLEARANCE = 0.02
"""The base hangs as high over the floor as the arm is long when stretched so much, and this much higher (m)."""


def base_height(arm: Arm) -> float:
    """Return how high the arm's base hangs over the floor, m."""
    return _STRETCH * sum(parameters(arm).rest_length) + _CLEARANCE


def to_scene(points: Array, height: float, across: Array | float = 0.0) -> Array:
    """Return places (n1, n3) in m as (x, y, z) of the scene, whose z points up: n3 is gravity's direction."""
    return np.stack([points[..., 0], np.broadcast_to(across, points.shape[:-1]), height - points[..., 1]], axis=-1)


def to_plane(place: Place, height: float) -> tuple[float, float]:
    """Return (n1, n3) of a place in the scene, m."""
    return place[0], height - place[2]


def shares_to_floor(shares: Array, middle: Place) -> Array:
    """Return places on a square of side ``SIDE``: (row share, column share) from its far left corner, as in a table.

    Args:
        shares: (..., 2) in [0, 1].
        middle: Of the square.

    Returns:
        (..., 2) x and y, m.
    """
    return np.stack(
        [middle[0] + (shares[..., 1] - 0.5) * SIDE, middle[1] - (shares[..., 0] - 0.5) * SIDE],
        axis=-1,
    )


def label_text(name: str, most: int = 12) -> str:
    """Return a name in at most so many letters: a long one would cover others, or half of the scene."""
    return name if len(name) <= most else f"{name[: most - 1]}…"
