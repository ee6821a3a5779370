"""What the editor can add to a scene: bodies, lights, cameras, models and prefabs."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any, NamedTuple

from mimics_app.world.files.scene.scene import Scene

__all__ = ["Template", "templates_of"]


class Template(NamedTuple):
    """An entity to add.

    Attributes:
        label: Its name in the list.
        help: What it is, in one line.
        entity: The entity, without its place.
    """

    label: str
    help: str
    entity: dict[str, Any]


_SHAPES: Mapping[str, dict[str, Any]] = {
    "box": {"size": [1.0, 1.0, 1.0]},
    "sphere": {"radius": 0.5},
    "cylinder": {"radius": 0.5, "height": 1.0},
    "capsule": {"radius": 0.25, "length": 0.5},
    "plane": {"size": [1.0, 1.0]},
}
"""Primitives of a width of 1."""
_LENGTHS = ("size", "radius", "height", "length")


def templates_of(scene: Scene, prefabs: Iterable[str], width: float) -> list[Template]:
    """Return what can be added to a scene.

    Args:
        scene: The scene.
        prefabs: Prefabs of its file.
        width: Width of new bodies [m].
    """
    shapes = {name: {"shape": name, **_scaled(shape, width)} for name, shape in _SHAPES.items()}
    bodies = [_template(name, "A body to look at", name, mesh={"primitive": shape}) for name, shape in shapes.items()]
    touched = [
        _template(f"{name} to touch", "A fixed body that is seen and touched", name, **_touched(shapes[name]))
        for name in ("box", "sphere")
    ]
    lights = [
        _template("lamp", "A light that shines in all directions", "lamp", light={"kind": "point", "intensity": 1.0}),
        _template("sun", "A light from far away, along its own -z", "sun", light={"kind": "directional"}),
        _template("camera", "A view of the scene, along its own -z", "camera", camera={}),
        Template("empty", "A place that others can move with", {"id": "place"}),
    ]
    models = [
        _template(f"model {name}", f"The model of the asset {name}", name, mesh={"source": name})
        for name, asset in scene.assets.items()
        if asset.kind == "model"
    ]
    instances = [
        Template(f"prefab {name}", f"An instance of the prefab {name}", {"id": name, "prefab": name})
        for name in prefabs
    ]
    return [*bodies, *touched, *lights, *instances, *models]


def _template(label: str, words: str, name: str, **components: object) -> Template:
    return Template(label, words, {"id": name.replace(" ", "_"), "components": components})


def _touched(shape: dict[str, Any]) -> dict[str, Any]:
    fixed = {"enable_translation": False, "enable_rotation": False, "stiffness": 1000.0}
    return {"mesh": {"primitive": shape}, "haptic_object": fixed}


def _scaled(shape: Mapping[str, Any], width: float) -> dict[str, Any]:
    def scale(value: float | list[float]) -> float | list[float]:
        if isinstance(value, list):
            return [float(f"{each * width:.3g}") for each in value]
        return float(f"{value * width:.3g}")

    return {key: scale(value) if key in _LENGTHS else value for key, value in shape.items()}
