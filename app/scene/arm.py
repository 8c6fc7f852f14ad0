"""The arm as a smooth tube with its rods and actuators; its target and kept runs as ghosts."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import viser
from numpy.typing import NDArray

from app.palette import KEPT, RGB
from app.runner import Frame
from app.scene.stage import base_height
from app.scene.tube import tube_faces, tube_vertices
from app.state import MAX_KEPT, AppState
from app.store import Shown
from app.widgets import put
from robot import kinematics
from robot.arm import Arm, parameters

_BODY_RADIUS = 0.020
_GHOST_RADIUS = 0.018
_KEPT_RADIUS = 0.013
"""So thin that a kept run shows only where it differs: two skins at one place would flicker."""
_ACTUATOR_RADIUS = 0.0045
_ROD_RADIUS = 0.005
_POINTS = 33
_SIDES = 20
_ACTUATOR_POINTS = 9
_ACTUATOR_SIDES = 8

_BODY = (88, 148, 226)
_GHOST = (190, 198, 214)
_ROD = (205, 209, 218)
_PLATE = (112, 118, 132)
_PULL = np.array([56, 122, 232])
_REST = np.array([150, 154, 164])
_PUSH = np.array([238, 132, 48])
_FORCE_FOR_FULL_COLOR = 15.0
"""Actuator force at which its colour is as strong as it gets, N."""

_COLOR_STEPS = 24

_PLATE_THICKNESS = 0.016
_ROD_OVERHANG = 0.006

Array = NDArray[np.float64]
Vertices = NDArray[np.float32]


class ArmView:
    """Meshes of the arm, made anew only when the number of modules changes."""

    def __init__(self, scene: viser.SceneApi, on_body: Callable[[viser.MeshHandle], None] | None = None) -> None:
        self._scene = scene
        self._on_body = on_body
        self._meshes: list[Any] = []
        self._modules = 0
        self._height = 0.0
        self._target: Array | None = None
        self._hides_target = False
        self._hides_kept = False

    def shows(self, state: AppState) -> Shown:
        """Return the parts that are shown."""
        return (state.hidden,)

    def render(self, state: AppState) -> None:
        """Show or hide the ghosts."""
        self._hides_target = "target" in state.hidden
        self._hides_kept = "baselines" in state.hidden
        if self._modules:
            self._ghost.visible = not self._hides_target

    def show(self, frame: Frame) -> None:
        """Move the meshes to the frame's position and target."""
        arm = frame.arm
        if arm.n_modules != self._modules:
            self._build(arm)
        self._body.vertices = self._tube(kinematics.backbone(arm, frame.q, _POINTS), _BODY_RADIUS, _SIDES)
        if self._target is None or not np.array_equal(frame.target, self._target):
            self._target = frame.target.copy()
            self._ghost.vertices = self._tube(kinematics.backbone(arm, frame.target, _POINTS), _GHOST_RADIUS, _SIDES)
        curves = kinematics.actuators(arm, frame.q, _ACTUATOR_POINTS)
        points, normals = np.array([curve.points for curve in curves]), np.array([curve.normals for curve in curves])
        tubes = tube_vertices(points, normals, _ACTUATOR_RADIUS, _ACTUATOR_SIDES, self._height)
        for vertices, mesh, force in zip(tubes, self._actuators, frame.forces, strict=True):
            mesh.vertices = vertices
            color = force_color(float(force))
            if tuple(mesh.color) != color:
                mesh.color = color
        ghosts = {} if self._hides_kept else {ghost.slot: ghost.q for ghost in frame.ghosts}
        for slot, mesh in enumerate(self._kept):
            put(mesh, visible=slot in ghosts)
            if slot in ghosts:
                mesh.vertices = self._tube(kinematics.backbone(arm, ghosts[slot], _POINTS), _KEPT_RADIUS, _SIDES)
        for vertices, mesh in zip(self._rod_tubes(kinematics.rods(arm, frame.q).ends[1:]), self._rods, strict=True):
            mesh.vertices = vertices

    def _build(self, arm: Arm) -> None:
        """Make the meshes of an arm with as many modules."""
        for mesh in self._meshes:
            mesh.remove()
        self._modules = arm.n_modules
        self._target = None
        self._height = base_height(arm)
        body = tube_faces(_POINTS, _SIDES)
        self._body = self._mesh("/arm/body", _POINTS, _SIDES, body, _BODY)
        self._ghost = self._mesh("/arm/target", _POINTS, _SIDES, body, _GHOST, opacity=0.38)
        self._ghost.visible = not self._hides_target
        self._kept = [
            self._mesh(f"/arm/kept/{slot + 1}", _POINTS, _SIDES, body, KEPT[slot], opacity=0.6)
            for slot in range(MAX_KEPT)
        ]
        for mesh in self._kept:
            mesh.visible = False
        if self._on_body is not None:
            self._on_body(self._body)
        faces = tube_faces(_ACTUATOR_POINTS, _ACTUATOR_SIDES)
        self._actuators = [
            self._mesh(f"/arm/actuators/{name}", _ACTUATOR_POINTS, _ACTUATOR_SIDES, faces, force_color(0.0))
            for name in arm.actuators
        ]
        faces = tube_faces(2, _SIDES)
        self._rods = [self._mesh(f"/arm/rods/{n + 1}", 2, _SIDES, faces, _ROD) for n in range(arm.n_modules)]
        width = 3.0 * parameters(arm).half_rod[0]
        plate = self._scene.add_box(
            "/arm/base", dimensions=(width, width, _PLATE_THICKNESS), color=_PLATE,
            position=(0.0, 0.0, self._height + 0.5 * _PLATE_THICKNESS),
        )  # fmt: skip
        self._meshes = [self._body, self._ghost, *self._kept, *self._actuators, *self._rods, plate]

    def _mesh(
        self, name: str, n_points: int, n_sides: int, faces: Any, color: RGB, opacity: float | None = None
    ) -> viser.MeshHandle:
        vertices = np.zeros((n_points * n_sides + 2, 3), dtype=np.float32)
        return self._scene.add_mesh_simple(
            name, vertices, faces, color=color, opacity=opacity, side="double" if opacity else "front",
            cast_shadow=opacity is None, receive_shadow=False,
        )  # fmt: skip

    def _tube(self, curve: kinematics.Curve, radius: float, n_sides: int) -> Vertices:
        return tube_vertices(curve.points, curve.normals, radius, n_sides, self._height)

    def _rod_tubes(self, ends: Array) -> Vertices:
        """Return rods (N, 2, 2) as short tubes across the arm, a little longer than the actuators are apart."""
        along = ends[:, 1] - ends[:, 0]
        along /= np.linalg.norm(along, axis=-1, keepdims=True)
        points = ends + _ROD_OVERHANG * np.array([[-1.0], [1.0]]) * along[:, np.newaxis]
        normals = np.broadcast_to((along[:, ::-1] * [-1.0, 1.0])[:, np.newaxis], points.shape)
        return tube_vertices(points, normals, _ROD_RADIUS, _SIDES, self._height)


def force_color(force: float) -> RGB:
    """Return the colour of an actuator: blue pulls, orange pushes, grey rests. In steps, so that few are sent."""
    share = round(max(-1.0, min(1.0, force / _FORCE_FOR_FULL_COLOR)) * _COLOR_STEPS) / _COLOR_STEPS
    end = _PUSH if share > 0.0 else _PULL
    red, green, blue = (_REST + abs(share) * (end - _REST)).round().astype(int).tolist()
    return red, green, blue
