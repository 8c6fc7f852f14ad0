"""Builds the scene: light, floor, arm, marks, board and surface; cameras; and the hand that pulls the arm."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import viser

from app.runner import Frame
from app.scene.arm import ArmView
from app.scene.board import BoardView
from app.scene.cameras import CAMERAS, follow
from app.scene.marks import MarksView
from app.scene.stage import base_height, to_plane
from app.scene.surface import SurfaceView
from app.store import Store
from robot.pull import Pull, nearest_point

_FARTHEST = 3.0
"""How far from the base (m) a hand can be."""

SetPull = Callable[[Pull | None], None]


class Scene:
    """All groups of the scene.

    Args:
        server: The server.
        store: Holds the state.
        pull: Lets a hand pull the arm, or let go.

    Attributes:
        views: The groups.
    """

    def __init__(self, server: viser.ViserServer, store: Store, pull: SetPull) -> None:
        light(server.scene)
        camera = server.initial_camera
        camera.position, camera.look_at = CAMERAS["all"]
        self._pull = pull
        self._point: float | None = None
        self._frame: Frame | None = None
        self._store = store
        self._arm = ArmView(server.scene, self._hold)
        self.views = (
            self._arm,
            MarksView(server.scene),
            BoardView(server.scene, store),
            SurfaceView(server.scene, store),
        )
        server.on_client_connect(follow)
        server.on_client_disconnect(self._let_go)

    def show(self, frame: Frame) -> None:
        """Show a frame in every group."""
        self._frame = frame
        for part in self.views:
            part.show(frame)

    def _hold(self, body: viser.MeshHandle) -> None:
        """Let the arm's body be dragged with Shift."""
        body.on_drag("left", modifier="shift")(self._dragged)

    async def _dragged(self, event: viser.SceneNodeDragEvent[Any]) -> None:
        frame, state = self._frame, self._store.state
        if frame is None or event.phase == "end" or state.playback.source != "live":
            self._point = None
            self._pull(None)
            return
        height = base_height(frame.arm)
        start, end = (to_plane(place, height) for place in (event.start_position, event.end_position))
        if not all(math.isfinite(value) and abs(value) <= _FARTHEST for value in (*start, *end)):
            return
        if event.phase == "start" or self._point is None:
            self._point = nearest_point(frame.arm, frame.q, np.array(start))
        self._pull(Pull(self._point, end))

    async def _let_go(self, _: viser.ClientHandle) -> None:
        """Nobody holds the arm for a browser that has gone."""
        if self._point is not None:
            self._point = None
            self._pull(None)


def light(scene: viser.SceneApi) -> None:
    """Set up light, floor and the direction up."""
    scene.set_up_direction("+z")
    scene.configure_default_lights(enabled=False)
    scene.configure_environment_map(hdri=None)
    scene.add_light_hemisphere("/lights/sky", sky_color=(255, 255, 255), ground_color=(120, 124, 140), intensity=1.6)
    scene.add_light_directional("/lights/sun", color=(255, 250, 242), intensity=1.7, position=(0.6, -1.2, 1.4))
    scene.add_grid(
        "/floor", width=2.0, height=2.0, cell_size=0.1, section_size=0.5, cell_color=(52, 55, 62),
        section_color=(74, 78, 88),
    )  # fmt: skip
