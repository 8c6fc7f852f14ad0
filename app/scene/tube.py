"""Tubes along planar curves, as meshes whose vertices are rewritten in place."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from app.scene.stage import to_scene

Array = NDArray[np.float64]


def tube_faces(n_points: int, n_sides: int) -> NDArray[np.uint32]:
    """Return the triangles of a tube with closed ends.

    Args:
        n_points: Rings along the curve.
        n_sides: Vertices of each ring.

    Returns:
        (2 n_sides n_points, 3) vertex numbers; ring by ring, then the middles of both ends.
    """
    ring = np.arange(n_sides)
    following = (ring + 1) % n_sides
    faces = []
    for i in range(n_points - 1):
        a, b = i * n_sides, (i + 1) * n_sides
        faces.append(np.stack([a + ring, a + following, b + following], axis=1))
        faces.append(np.stack([a + ring, b + following, b + ring], axis=1))
    first, last = n_points * n_sides, n_points * n_sides + 1
    end = (n_points - 1) * n_sides
    faces.append(np.stack([np.full(n_sides, first), following, ring], axis=1))
    faces.append(np.stack([np.full(n_sides, last), end + ring, end + following], axis=1))
    return np.concatenate(faces).astype(np.uint32)


def tube_vertices(points: Array, normals: Array, radius: float, n_sides: int, height: float) -> NDArray[np.float32]:
    """Return the vertices of tubes around curves in the n1-n3 plane, in the scene's axes.

    Args:
        points: (..., n, 2) places of the curves along n1 and n3, m.
        normals: (..., n, 2) unit normals in the plane.
        radius: Of the tubes, m.
        n_sides: Vertices of each ring.
        height: Of the arm's base over the floor, m.

    Returns:
        (..., n n_sides + 2, 3) in the order that ``tube_faces`` expects.
    """
    n_points = points.shape[-2]
    angle = np.linspace(0.0, 2.0 * np.pi, n_sides, endpoint=False)
    in_plane = points[..., None, :] + radius * np.cos(angle)[:, None] * normals[..., None, :]
    vertices = np.empty((*points.shape[:-2], n_points * n_sides + 2, 3), dtype=np.float32)
    flat = in_plane.reshape(*points.shape[:-2], n_points * n_sides, 2)
    vertices[..., :-2, :] = to_scene(flat, height, np.tile(radius * np.sin(angle), n_points))
    vertices[..., -2:, :] = to_scene(points[..., [0, -1], :], height)
    return vertices
