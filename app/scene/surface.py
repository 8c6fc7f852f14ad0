"""The control surface T(e, ė) as a coloured mesh, with the run's ways on it and the present places."""

from __future__ import annotations

from typing import Any

import numpy as np
import viser
from numpy.typing import NDArray

from app.palette import COORDINATES, linear, scale_colors
from app.runner import Frame
from app.scene.glb import colored_mesh
from app.scene.stage import RISE, SURFACE, shares_to_floor
from app.state import AppState, Result
from app.store import Shown, Store, is_same
from app.widgets import coordinate_label
from fuzzy.analysis import Surface
from fuzzy.system import FuzzySystem, Variable
from robot import controllers

Array = NDArray[np.float64]

_WAY_POINTS = 240
_LIFT = 0.003
"""Height over the surface at which ways and places are drawn, m."""
_PLACE_RADIUS = 0.009
_FLOOR_GAP = 0.02
_SUN = np.array([0.22, -0.50, 0.84])
"""Where the light comes from that shades the surface; a unit vector."""
_DARK = 0.45
"""Brightness of what is turned away from it."""
_TO_GLTF = (0.70710678, 0.70710678, 0.0, 0.0)
"""Turns glTF's y axis, which points up, into the scene's z."""


class SurfaceView:
    """Mesh, ways and places; the mesh is sent again only for another document."""

    def __init__(self, scene: viser.SceneApi, store: Store) -> None:
        self._scene = scene
        self._store = store
        self._drawn: Surface | None = None
        self._mesh: Any = None
        self._labels: list[Any] = []
        self._ways: dict[int, Any] = {}
        self._places: dict[int, Any] = {}
        self._ways_drawn: Shown = ()

    def shows(self, state: AppState) -> Shown:
        """Return the parts that are shown."""
        runs = state.runs
        return runs.surface, runs.current, state.coordinate, state.others, state.hidden

    def render(self, state: AppState) -> None:
        """Draw the surface of the document that runs, and the ways of the chosen coordinates."""
        surface, current = state.runs.surface, state.runs.current
        is_visible = "surface" not in state.hidden and surface is not None
        for part in (self._mesh, *self._labels):
            if part is not None and part.visible != is_visible:
                part.visible = is_visible
        ways, self._ways_drawn = self._ways_drawn, self.shows(state)
        if is_same(ways, self._ways_drawn):
            return
        for parts in (self._ways, self._places):
            for i in tuple(parts):
                if not is_visible or i not in state.coordinates or current is None:
                    parts.pop(i).remove()
        if not is_visible or surface is None:
            return
        if surface is not self._drawn and _is_of(surface, state.document):
            self._drawn = surface
            self._draw(state.document, surface)
        if current is not None and current.run.output.size:
            for i in state.coordinates:
                self._draw_way(current, i)

    def show(self, frame: Frame) -> None:
        """Move the places of the chosen coordinates."""
        state = self._store.state
        if self._drawn is None or "surface" in state.hidden or frame.inference is None:
            for i in tuple(self._places):
                self._places.pop(i).remove()
            return
        for i in state.coordinates:
            block = np.append(frame.blocks[i], frame.outputs[i])[np.newaxis]
            if not np.isfinite(block).all() or len(frame.inference.system.inputs) != 2:
                continue
            place = _on_surface(frame.inference.system, block)[0]
            if i not in self._places:
                self._places[i] = self._scene.add_icosphere(
                    f"/surface/places/{i}", _PLACE_RADIUS, _color(i), subdivisions=2, cast_shadow=False
                )
            self._places[i].position = tuple(place)

    def _draw(self, system: FuzzySystem, surface: Surface) -> None:
        ny, nx = surface.value.shape
        rows, columns = np.meshgrid(np.linspace(0, 1, ny), np.linspace(0, 1, nx), indexing="ij")
        output = next(one for one in system.outputs if one.name == surface.output)
        share = _share(output, np.nan_to_num(surface.value, nan=0.5 * (output.low + output.high)))
        floor = shares_to_floor(np.stack([rows, columns], axis=-1), SURFACE)
        place = np.concatenate([floor, (SURFACE[2] + _FLOOR_GAP + RISE * share)[..., np.newaxis]], axis=-1)
        normal = np.cross(np.gradient(place, axis=1), -np.gradient(place, axis=0))
        normal /= np.maximum(np.linalg.norm(normal, axis=-1, keepdims=True), 1e-12)
        corner = np.arange(ny * nx).reshape(ny, nx)
        a, b, c, d = corner[:-1, :-1], corner[:-1, 1:], corner[1:, :-1], corner[1:, 1:]
        faces = np.concatenate([np.stack([a, c, b], axis=-1), np.stack([b, c, d], axis=-1)]).reshape(-1, 3)
        shade = _DARK + (1.0 - _DARK) * np.clip(normal @ _SUN, 0.0, 1.0).reshape(-1, 1)
        data = colored_mesh(_gltf(place), linear(scale_colors(share.ravel()) * shade), faces)
        if self._mesh is None:
            self._mesh = self._scene.add_glb("/surface/mesh", data, wxyz=_TO_GLTF, cast_shadow=False)
            self._mesh.receive_shadow = False
        else:
            self._mesh.glb_data = data
        self._name(surface)

    def _name(self, surface: Surface) -> None:
        for label in self._labels:
            label.remove()
        names = {"columns": (surface.x_name, (1.08, 0.5)), "rows": (surface.y_name, (0.92, 1.06))}
        self._labels = []
        for side, (text, place) in names.items():
            x, y = shares_to_floor(np.array(place), SURFACE)
            self._labels.append(self._scene.add_label(f"/surface/names/{side}", text, position=(x, y, 0.0)))
        x, y = shares_to_floor(np.array((0.0, 1.0)), SURFACE)
        top = (x, y, SURFACE[2] + _FLOOR_GAP + RISE + 0.03)
        self._labels.append(self._scene.add_label("/surface/names/output", surface.output, position=top))

    def _draw_way(self, result: Result, i: int) -> None:
        run = result.drawn
        blocks = controllers.inference_of(run.controller)
        every = max(1, len(run.t) // _WAY_POINTS)
        block = np.concatenate([run.inputs[:, i], run.output[:, i : i + 1]], axis=1)[::every]
        if blocks is None or len(blocks.system.inputs) != 2 or len(block) < 2 or not np.isfinite(block).all():
            return
        way = _on_surface(blocks.system, block)
        points = np.stack([way[:-1], way[1:]], axis=1).astype(np.float32)
        if i in self._ways:
            self._ways[i].points = points
        else:
            self._ways[i] = self._scene.add_line_segments(
                f"/surface/ways/{coordinate_label(run.arm.coordinates[i])}", points, _color(i), thickness=0.003
            )


def _is_of(surface: Surface, document: FuzzySystem) -> bool:
    """Return whether a document has the variables of a surface, which may be that of one before a renaming."""
    inputs = [variable.name for variable in document.inputs]
    is_named = surface.output in [variable.name for variable in document.outputs]
    return is_named and inputs == [surface.y_name, surface.x_name]


def _share(variable: Variable, value: Array) -> Array:
    return np.clip((value - variable.low) / (variable.high - variable.low), 0.0, 1.0)


def _on_surface(system: FuzzySystem, block: Array) -> Array:
    """Return the places (n, 3) of inputs and output (n, 3) of a fuzzy block, a little over the surface."""
    row, column = system.inputs
    shares = np.stack([_share(row, block[:, 0]), _share(column, block[:, 1])], axis=-1)
    height = SURFACE[2] + _FLOOR_GAP + RISE * _share(system.outputs[0], block[:, 2]) + _LIFT
    return np.concatenate([shares_to_floor(shares, SURFACE), height[:, np.newaxis]], axis=1)


def _gltf(vectors: Array) -> Array:
    """Return the scene's (x, y, z) as glTF's (x, z, -y), (n, 3)."""
    flat = vectors.reshape(-1, 3)
    return np.stack([flat[:, 0], flat[:, 2], -flat[:, 1]], axis=1)


def _color(i: int) -> tuple[int, int, int]:
    return COORDINATES[i % len(COORDINATES)]
