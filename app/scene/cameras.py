"""Views of the scene, fitted to the window of each browser."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import viser
from numpy.typing import NDArray

from app.scene.stage import Place

Array = NDArray[np.float64]


class Camera(NamedTuple):
    """Where a camera stands and looks, m, in a window of the aspect ``WIDE`` or more."""

    position: Place
    look_at: Place


CAMERAS: dict[str, Camera] = {
    "all": Camera((0.03, -0.95, 0.70), (0.01, -0.12, 0.235)),
    "arm": Camera((0.20, -0.74, 0.46), (0.06, 0.0, 0.33)),
    "board": Camera((-0.235, -0.62, 0.52), (-0.235, -0.285, 0.01)),
    "surface": Camera((0.36, -0.78, 0.52), (0.235, -0.285, 0.07)),
}
"""Views that can be chosen; the first is the one that the page opens with."""

WIDE = 0.92
"""Width over height from which a window shows all of a view."""
PHONE = 576
"""Pixels of width up to which viser's page has no docks: its panels then cover the lower half of the scene."""

_COVERED_BACK = 0.8
"""How much of the scene's width a phone shows: distance times aspect."""
_UP = 0.34
"""How far a phone's view goes down, so that the scene stands above the panels, in distances of the camera."""
_STEEP = 0.5
"""How much higher a phone's camera stands, in distances: the names along the board would cover each other."""
_NEAR = 1e-3
"""How far from its place a camera is that nobody has moved, m."""


class Window(NamedTuple):
    """Size of the scene in a browser, pixels."""

    width: int
    height: int

    @property
    def aspect(self) -> float:
        """Width over height."""
        return self.width / max(self.height, 1)


def fitted(camera: Camera, window: Window) -> tuple[Array, Array]:
    """Return where a camera stands and looks in a window: in a narrow one further back, on a phone also lower."""
    position, target = np.array(camera.position), np.array(camera.look_at)
    aspect = max(window.aspect, 0.2)
    if window.width > PHONE:
        return target + max(1.0, WIDE / aspect) * (position - target), target
    away = position - target
    distance = np.linalg.norm(away)
    away[2] += _STEEP * distance
    away *= max(1.0, _COVERED_BACK / aspect) * distance / np.linalg.norm(away)
    sideways = np.cross(away, (0.0, 0.0, 1.0))
    up = np.cross(sideways, away)
    down = -_UP * np.linalg.norm(away) / np.linalg.norm(up) * up
    return target + down + away, target + down


def look(client: viser.ClientHandle, name: str) -> None:
    """Move one browser's camera to a view.

    Args:
        client: The browser.
        name: Of ``CAMERAS``.
    """
    position, target = fitted(CAMERAS[name], _window(client))
    with client.atomic():
        client.camera.position = position
        client.camera.look_at = target
        client.camera.up_direction = (0.0, 0.0, 1.0)


async def follow(client: viser.ClientHandle) -> None:
    """Keep a view whole while panels are docked or the window changes, until a hand moves the camera."""
    window = _window(client)
    if window.width <= PHONE:
        look(client, "all")

    @client.camera.on_update
    async def _(camera: viser.CameraHandle) -> None:
        nonlocal window
        before, window = window, _window(client)
        if window == before:
            return
        for name, view in CAMERAS.items():
            if np.linalg.norm(fitted(view, before)[0] - camera.position) < _NEAR:
                look(client, name)


def _window(client: viser.ClientHandle) -> Window:
    return Window(client.camera.image_width, client.camera.image_height)
