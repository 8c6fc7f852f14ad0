"""The control surface T(e, ė) as a coloured mesh, with the run's ways on it and the present places."""

from __future__ import annotations

from typing import Any

import numpy as np
import viser

from app.palette import COORDINATES
from app.runner import Frame
from app.scene.landscape import FLOOR_GAP, on_surface
from app.scene.stage import RISE, SURFACE, label_text, shares_to_floor
from app.state import AppState, Landscape, Result
from app.store import Shown, Store, is_same
from app.widgets import coordinate_label, put
from robot import controllers

_WAY_POINTS = 240
_PLACE_RADIUS = 0.009
_TO_GLTF = (0.70710678, 0.70710678, 0.0, 0.0)
"""Turns glTF's y axis, which points up, into the scene's z."""
_NAMES = {
    "columns": ((1.06, 0.5), SURFACE[2] + FLOOR_GAP + RISE / 2),
    "rows": ((0.5, 1.16), SURFACE[2] + FLOOR_GAP + RISE / 2),
    "output": ((0.0, 1.0), SURFACE[2] + FLOOR_GAP + RISE + 0.03),
}
"""Where the variables' names stand: shares of the floor, and height in m."""


class SurfaceView:
    """Mesh, ways and places; the mesh is sent again only for another document."""

    def __init__(self, scene: viser.SceneApi, store: Store) -> None:
        self._scene = scene
        self._store = store
        self._drawn: Landscape | None = None
        self._mesh: Any = None
        self._labels: list[Any] = []
        self._ways: dict[int, Any] = {}
        self._places: dict[int, Any] = {}
        self._ways_drawn: Shown = ()

    def shows(self, state: AppState) -> Shown:
        """Return the parts that are shown."""
        runs = state.runs
        return runs.landscape, runs.current, state.coordinate, state.others, state.hidden

    def render(self, state: AppState) -> None:
        """Draw the surface of the document that runs, and the ways of the chosen coordinates."""
        landscape, current = state.runs.landscape, state.runs.current
        is_visible = "surface" not in state.hidden and landscape is not None
        for part in (self._mesh, *self._labels):
            if part is not None:
                put(part, visible=is_visible)
        ways, self._ways_drawn = self._ways_drawn, self.shows(state)
        if is_same(ways, self._ways_drawn):
            return
        for parts in (self._ways, self._places):
            for i in tuple(parts):
                if not is_visible or i not in state.coordinates or current is None:
                    parts.pop(i).remove()
        if not is_visible or landscape is None:
            return
        if landscape is not self._drawn:
            self._drawn = landscape
            self._draw(landscape)
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
            place = on_surface(frame.inference.system, block)[0]
            if i not in self._places:
                self._places[i] = self._scene.add_icosphere(
                    f"/surface/places/{i}", _PLACE_RADIUS, _color(i), subdivisions=2, cast_shadow=False
                )
            self._places[i].position = tuple(place)

    def _draw(self, landscape: Landscape) -> None:
        if self._mesh is None:
            self._mesh = self._scene.add_glb("/surface/mesh", landscape.mesh, wxyz=_TO_GLTF, cast_shadow=False)
            self._mesh.receive_shadow = False
            self._labels = [
                self._scene.add_label(f"/surface/names/{side}", "", position=_name_place(side)) for side in _NAMES
            ]
        put(self._mesh, glb_data=landscape.mesh)
        surface = landscape.surface
        for label, text in zip(self._labels, (surface.x_name, surface.y_name, surface.output), strict=True):
            put(label, text=label_text(text))

    def _draw_way(self, result: Result, i: int) -> None:
        run = result.drawn
        blocks = controllers.inference_of(run.controller)
        every = max(1, len(run.t) // _WAY_POINTS)
        block = np.concatenate([run.inputs[:, i], run.output[:, i : i + 1]], axis=1)[::every]
        if blocks is None or len(blocks.system.inputs) != 2 or len(block) < 2 or not np.isfinite(block).all():
            return
        way = on_surface(blocks.system, block)
        points = np.stack([way[:-1], way[1:]], axis=1).astype(np.float32)
        if i in self._ways:
            self._ways[i].points = points
        else:
            self._ways[i] = self._scene.add_line_segments(
                f"/surface/ways/{coordinate_label(run.arm.coordinates[i])}", points, _color(i), thickness=0.003
            )


def _name_place(side: str) -> tuple[float, float, float]:
    shares, height = _NAMES[side]
    x, y = shares_to_floor(np.array(shares), SURFACE).tolist()
    return x, y, height


def _color(i: int) -> tuple[int, int, int]:
    return COORDINATES[i % len(COORDINATES)]
