"""What a round thing may be given to be touched by (4.2.8). Importing this module registers the rivals.

Cost: the whole of touching, with friction. Error: false force of a frictionless slide over a ball of 2 cm.
"""

from __future__ import annotations

from functools import partial

import numpy as np

from mimics_app.contracts.haptic_objects import ShapeKind
from mimics_app.contracts.methods import Group, Method, registry
from mimics_app.lab.haptic.probe import reference_us
from mimics_app.lab.haptic.touch_probe import RADIUS, STIFFNESS, slide_path, touch_scene

__all__ = ["GROUP", "false_force"]

GROUP = "bounding geometry"

_COUNTS = (1, 10, 100, 1000, 10_000)
_MESH_COUNTS = (1, 10, 100)


def false_force(kind: ShapeKind, triangles: int = 0) -> float:
    """Greatest difference [N] from the force of a frictionless ball of RADIUS on the path of the probe."""
    path = slide_path(np.array([0.0, 0.0, RADIUS]))[0]
    far = np.linalg.norm(path, axis=1)
    scene = touch_scene(kind, 1, triangles, friction=0.0)
    scene.rows.shapes["damping"] = 0.0
    expected = STIFFNESS * (np.maximum(0.0, RADIUS - far) / far)[:, None] * path
    return float(np.linalg.norm(scene.forces() - expected, axis=1).max())


_BOUNDS: dict[str, tuple[ShapeKind, int, str]] = {
    "sphere": (ShapeKind.SPHERE, 0, "round every way"),
    "capsule": (ShapeKind.CAPSULE, 0, "round about one axis"),
    "cylinder": (ShapeKind.CYLINDER, 0, "round about one axis, flat ends"),
    "box": (ShapeKind.BOX, 0, "flat"),
    "mesh of 1000": (ShapeKind.MESH, 1000, "1000 triangles: any form"),
    "mesh of 10000": (ShapeKind.MESH, 10_000, "10,000 triangles: any form"),
}


_SHAPES = {
    ShapeKind.SPHERE: "sphere",
    ShapeKind.CAPSULE: "capsule",
    ShapeKind.CYLINDER: "cylinder",
    ShapeKind.BOX: "cube",
    ShapeKind.MESH: "mesh",
}
"""A scene's word for each kind of shape."""


def _cost_us(kind: ShapeKind, triangles: int, count: int) -> float:
    return touch_scene(kind, count, triangles).cost_us()


registry.describe(
    Group(
        name=GROUP,
        what="touching a round thing with friction, whole; error: false force of a frictionless slide over a ball",
        unit="N",
        work="shapes in the scene",
        reference=reference_us,
    )
)
for _name, (_kind, _triangles, _source) in _BOUNDS.items():
    registry.register(
        Method(
            group=GROUP,
            name=_name,
            source=_source,
            cost=partial(_cost_us, _kind, _triangles, 1),
            error=partial(false_force, _kind, _triangles),
            unit="N",
            valid_range="what the thing is shaped like",
            settings={"shape": _SHAPES[_kind]},
            default=_name == "sphere",
            growth=partial(_cost_us, _kind, _triangles),
            sizes=_COUNTS if not _triangles else _MESH_COUNTS,
        )
    )
