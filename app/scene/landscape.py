"""The shape of the control surface in the scene; pure numbers, made where the surface is computed."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from app.palette import linear, scale_colors
from app.scene.glb import colored_mesh
from app.scene.stage import RISE, SURFACE, shares_to_floor
from app.state import Landscape
from fuzzy.analysis import Surface
from fuzzy.system import FuzzySystem, Variable

Array = NDArray[np.float64]

FLOOR_GAP = 0.02
"""Height of the lowest place over the floor, m."""
_LIFT = 0.003
"""Height over the surface at which ways and places are drawn, m."""
_SUN = np.array([0.22, -0.50, 0.84])
"""Where the light comes from that shades the surface; a unit vector."""
_DARK = 0.45
"""Brightness of what is turned away from it."""


def landscape(system: FuzzySystem, surface: Surface) -> Landscape:
    """Return a surface of a system with its mesh; where no output is defined it stands in the middle of the range."""
    ny, nx = surface.value.shape
    rows, columns = np.meshgrid(np.linspace(0, 1, ny), np.linspace(0, 1, nx), indexing="ij")
    output = next(one for one in system.outputs if one.name == surface.output)
    share = _share(output, np.nan_to_num(surface.value, nan=0.5 * (output.low + output.high)))
    floor = shares_to_floor(np.stack([rows, columns], axis=-1), SURFACE)
    place = np.concatenate([floor, (SURFACE[2] + FLOOR_GAP + RISE * share)[..., np.newaxis]], axis=-1)
    normal = np.cross(np.gradient(place, axis=1), -np.gradient(place, axis=0))
    normal /= np.maximum(np.linalg.norm(normal, axis=-1, keepdims=True), 1e-12)
    corner = np.arange(ny * nx).reshape(ny, nx)
    a, b, c, d = corner[:-1, :-1], corner[:-1, 1:], corner[1:, :-1], corner[1:, 1:]
    faces = np.concatenate([np.stack([a, c, b], axis=-1), np.stack([b, c, d], axis=-1)]).reshape(-1, 3)
    shade = _DARK + (1.0 - _DARK) * np.clip(normal @ _SUN, 0.0, 1.0).reshape(-1, 1)
    return Landscape(surface, colored_mesh(_gltf(place), linear(scale_colors(share.ravel()) * shade), faces))


def on_surface(system: FuzzySystem, block: Array) -> Array:
    """Return the places (n, 3) of inputs and output (n, 3) of a fuzzy block, a little over the surface."""
    row, column = system.inputs
    shares = np.stack([_share(row, block[:, 0]), _share(column, block[:, 1])], axis=-1)
    height = SURFACE[2] + FLOOR_GAP + RISE * _share(system.outputs[0], block[:, 2]) + _LIFT
    return np.concatenate([shares_to_floor(shares, SURFACE), height[:, np.newaxis]], axis=1)


def _share(variable: Variable, value: Array) -> Array:
    return np.clip((value - variable.low) / (variable.high - variable.low), 0.0, 1.0)


def _gltf(vectors: Array) -> Array:
    """Return the scene's (x, y, z) as glTF's (x, z, -y), (n, 3)."""
    flat = vectors.reshape(-1, 3)
    return np.stack([flat[:, 0], flat[:, 2], -flat[:, 1]], axis=1)
