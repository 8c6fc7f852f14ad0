"""A mesh with a colour at every vertex, as binary glTF: the one kind of mesh that viser draws so.

Its shade is in its colours, and no light falls on it: without a graphics card that is drawn in half the time.
"""

from __future__ import annotations

import struct

import msgspec
import numpy as np
from numpy.typing import NDArray

_FLOAT, _UNSIGNED_INT, _UNSIGNED_BYTE = 5126, 5125, 5121
_VERTICES, _INDICES = 34962, 34963
_JSON, _BINARY = 0x4E4F534A, 0x004E4942


def colored_mesh(
    vertices: NDArray[np.floating],
    colors: NDArray[np.uint8],
    faces: NDArray[np.integer],
) -> bytes:
    """Return a mesh that is seen from both sides.

    Args:
        vertices: (n, 3) places, m, in glTF's axes, whose y points up.
        colors: (n, 3) red, green, blue, shaded; linear light.
        faces: (m, 3) vertex numbers.

    References:
        Khronos Group, glTF 2.0 specification: GLB file format.
    """
    place = np.ascontiguousarray(vertices, dtype="<f4")
    rgba = np.full((len(place), 4), 255, dtype=np.uint8)
    rgba[:, :3] = colors
    parts = [place.tobytes(), rgba.tobytes(), np.ascontiguousarray(faces, dtype="<u4").tobytes()]
    starts = [0, *np.cumsum([len(part) for part in parts])]
    count = len(place)
    accessors = [
        _accessor(0, _FLOAT, count, "VEC3")
        | {"min": place.min(axis=0).astype(float).tolist(), "max": place.max(axis=0).astype(float).tolist()},
        _accessor(1, _UNSIGNED_BYTE, count, "VEC4") | {"normalized": True},
        _accessor(2, _UNSIGNED_INT, int(np.size(faces)), "SCALAR"),
    ]
    views = [
        {
            "buffer": 0,
            "byteOffset": int(starts[k]),
            "byteLength": len(part),
            "target": _INDICES if k == 2 else _VERTICES,
        }
        for k, part in enumerate(parts)
    ]
    material = {"extensions": {"KHR_materials_unlit": {}}, "doubleSided": True}
    attributes = {"POSITION": 0, "COLOR_0": 1}
    document = {
        "asset": {"version": "2.0"},
        "extensionsUsed": ["KHR_materials_unlit"],
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": attributes, "indices": 2, "material": 0}]}],
        "materials": [material],
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{"byteLength": int(starts[-1])}],
    }
    text = msgspec.json.encode(document)
    text += b" " * (-len(text) % 4)
    binary = b"".join(parts)
    size = 12 + 8 + len(text) + 8 + len(binary)
    header = struct.pack("<4sII", b"glTF", 2, size)
    return header + struct.pack("<II", len(text), _JSON) + text + struct.pack("<II", len(binary), _BINARY) + binary


def _accessor(view: int, kind: int, count: int, shape: str) -> dict[str, object]:
    return {"bufferView": view, "componentType": kind, "count": count, "type": shape}
