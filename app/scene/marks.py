"""What is drawn around the arm: the way of its tip, gravity, and the spring of a hand that pulls."""

from __future__ import annotations

from collections import deque
from typing import Any

import numpy as np
import viser
from numpy.typing import NDArray

from app.runner import Frame
from app.scene.stage import base_height, to_scene
from app.state import AppState
from app.store import Shown
from robot import kinematics

Array = NDArray[np.float64]

_TRAIL = 120
"""Points of the tip's way that stay."""
_TRAIL_COLOR = (126, 200, 255)
_GRAVITY_COLOR = (150, 158, 174)
_HAND_COLOR = (255, 214, 92)
_GRAVITY = np.array([[[-0.15, 0.0, -0.03], [-0.15, 0.0, -0.13]]])
"""The arrow of gravity, beside and below the base, m."""
_STILL = 2e-4
"""The tip must move so far (m) for another point."""
_SHORTEST = 0.004
"""A spring shorter than this (m) is not drawn."""


class MarksView:
    """Trail, gravity and the hand's spring; the trail is the picture's own memory and begins anew with the time."""

    def __init__(self, scene: viser.SceneApi) -> None:
        nothing = np.zeros((1, 2, 3), dtype=np.float32)
        self._places: deque[Array] = deque(maxlen=_TRAIL)
        self._time = 0.0
        self._hidden: frozenset[str] = frozenset()
        self._height: float | None = None
        self._scene = scene
        self._trail = scene.add_line_segments("/marks/trail", nothing, _TRAIL_COLOR, thickness=0.003, visible=False)
        self._gravity: list[Any] = []
        self._spring = scene.add_arrows(
            "/marks/hand", nothing, _HAND_COLOR, shaft_radius=0.004, head_radius=0.010, head_length=0.022, visible=False
        )
        self._force = scene.add_label("/marks/force", "", visible=False)

    def shows(self, state: AppState) -> Shown:
        """Return the parts that are shown."""
        return (state.hidden,)

    def render(self, state: AppState) -> None:
        """Show or hide the layers."""
        self._hidden = state.hidden
        for part in self._gravity:
            part.visible = "gravity" not in state.hidden
        if "trail" in state.hidden:
            self._trail.visible = False

    def show(self, frame: Frame) -> None:
        """Let the trail grow to the tip, and draw the spring."""
        height = base_height(frame.arm)
        if height != self._height:
            self._height = height
            self._draw_gravity(height)
        tip = to_scene(kinematics.backbone(frame.arm, frame.q, 2).points[-1], height)
        if frame.t < self._time:
            self._places.clear()
        self._time = frame.t
        if not self._places or float(np.abs(tip - self._places[-1]).max()) > _STILL:
            self._places.append(tip)
        if "trail" not in self._hidden and len(self._places) > 1:
            way = np.array(self._places)
            self._trail.points = np.stack([way[:-1], way[1:]], axis=1).astype(np.float32)
            self._trail.visible = True
        elif self._trail.visible:
            self._trail.visible = False
        self._draw_spring(frame, height)

    def _draw_gravity(self, height: float) -> None:
        for part in self._gravity:
            part.remove()
        points = (_GRAVITY + np.array([0.0, 0.0, height])).astype(np.float32)
        is_shown = "gravity" not in self._hidden
        arrow = self._scene.add_arrows(
            "/marks/gravity", points, _GRAVITY_COLOR, shaft_radius=0.003, head_radius=0.008, head_length=0.018,
            visible=is_shown,
        )  # fmt: skip
        label = self._scene.add_label(
            "/marks/gravity/g", "g", position=tuple(points[0, 1] - [0.0, 0.0, 0.012]), anchor="top-center",
            visible=is_shown,
        )  # fmt: skip
        self._gravity = [arrow, label]

    def _draw_spring(self, frame: Frame, height: float) -> None:
        if frame.pull is None:
            if self._spring.visible:
                self._spring.visible = self._force.visible = False
            return
        held = to_scene(frame.pull.held(frame.arm, frame.q), height)
        hand = to_scene(np.array(frame.pull.place), height)
        is_long = float(np.linalg.norm(hand - held)) > _SHORTEST
        self._spring.visible = self._force.visible = is_long
        if is_long:
            self._spring.points = np.stack([held, hand])[np.newaxis].astype(np.float32)
            self._force.text = f"{float(np.hypot(*frame.pull.force(frame.arm, frame.q))):.1f} N"
            self._force.position = tuple(hand)
