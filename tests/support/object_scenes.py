"""Small scenes of haptic objects made by tests."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from mimics_app.app.scenes.loading import load_checked_scene
from mimics_app.contracts.errors import SceneError
from mimics_app.rendering.haptic.scene_objects import SceneObjects, objects_of_scene
from mimics_app.world.files.scene.scene import Scene
from tests.support.scenes import scene, thing, write

CUBE = {"shape": "cube", "size": [0.1, 0.1, 0.1]}


def at(x: float, y: float, z: float, entity: dict[str, Any], **transform: Any) -> dict[str, Any]:
    """The entity at a place, perhaps turned."""
    return {**entity, "transform": {"translation": [x, y, z], **transform}}


def written(folder: Path, *entities: dict[str, Any], **parts: Any) -> Path:
    """The file of a scene with these entities."""
    return write(folder, scene(*entities, **parts))


def loaded(folder: Path, *entities: dict[str, Any], **parts: Any) -> Scene:
    """A checked scene with these entities."""
    return load_checked_scene(write(folder, scene(*entities, **parts)))


def objects(folder: Path, *entities: dict[str, Any], **parts: Any) -> SceneObjects:
    """The rows of a scene with these entities."""
    return objects_of_scene(loaded(folder, *entities, **parts))


def reported(folder: Path, *entities: dict[str, Any], **parts: Any) -> list[str]:
    """The faults `check` reports of such a scene, without the folder's name."""
    path = write(folder, scene(*entities, **parts))
    try:
        load_checked_scene(path)
    except SceneError as error:
        return [str(issue).replace(str(path.parent) + "/", "") for issue in error.issues]
    return []


def gltf_box(folder: Path, size: tuple[float, float, float], name: str = "box.gltf", *, lid: bool = True) -> Path:
    """A model with one box of these edges, twelve triangles; without its lid it is not closed."""
    import base64

    import numpy as np

    corners = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)]) * size
    faces = [
        (0, 1, 3),
        (0, 3, 2),
        (4, 6, 7),
        (4, 7, 5),
        (0, 4, 5),
        (0, 5, 1),
        (0, 2, 6),
        (0, 6, 4),
        (1, 5, 7),
        (1, 7, 3),
    ]
    faces += [(2, 3, 7), (2, 7, 6)] if lid else []
    points, indices = corners.astype("<f4").tobytes(), np.array(faces, "<u4").tobytes()
    data = base64.b64encode(points + indices).decode()
    document = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"name": "Box", "mesh": 0}],
        "meshes": [{"name": "Box", "primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "buffers": [{"byteLength": len(points) + len(indices), "uri": f"data:application/octet-stream;base64,{data}"}],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": len(points)},
            {"buffer": 0, "byteOffset": len(points), "byteLength": len(indices)},
        ],
        "accessors": [
            {
                "bufferView": 0,
                "componentType": 5126,
                "count": 8,
                "type": "VEC3",
                "min": corners.min(axis=0).tolist(),
                "max": corners.max(axis=0).tolist(),
            },
            {"bufferView": 1, "componentType": 5125, "count": 3 * len(faces), "type": "SCALAR"},
        ],
    }
    path = folder / name
    path.write_text(json.dumps(document), encoding="utf-8")
    return path


__all__ = ["CUBE", "at", "gltf_box", "loaded", "objects", "reported", "thing", "written"]
