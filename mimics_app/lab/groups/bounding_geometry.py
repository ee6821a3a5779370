"""Bounding geometries of a round object (4.2.8).

Cost: cull, narrow phase, force and friction. Error: spurious force of a frictionless slide over a ball of 2 cm.
"""

from __future__ import annotations

import numpy as np

from mimics_app.contracts.loop.haptic_objects import ShapeKind
from mimics_app.lab.haptic.probe import reference_us
from mimics_app.lab.haptic.touch_probe import RADIUS, STIFFNESS, slide_path, touch_scene
from mimics_app.lab.rivals import Growth, Probes, Rival, compare

__all__ = ["false_force"]


_FEW = (1, 10, 100)
"""Numbers of meshes at which the cost of a tick is measured, for large ones."""


def false_force(kind: ShapeKind, triangles: int = 0) -> float:
    """Return the largest difference [N] from the force of a frictionless ball of RADIUS on the path of the probe."""
    path = slide_path(np.array([0.0, 0.0, RADIUS]))[0]
    far = np.linalg.norm(path, axis=1)
    scene = touch_scene(kind, 1, triangles, friction=0.0)
    scene.rows.shapes["damping"] = 0.0
    expected = STIFFNESS * (np.maximum(0.0, RADIUS - far) / far)[:, None] * path
    return float(np.linalg.norm(scene.forces() - expected, axis=1).max())


def _cost_us(kind: ShapeKind, triangles: int, count: int) -> float:
    return touch_scene(kind, count, triangles).cost_us()


_FIT = "the shape of the object"
compare(
    __name__,
    "touching a round object with friction, whole; error: false force of a frictionless slide over a ball",
    "N",
    [
        Rival("sphere", "round every way", _FIT, {"shape": "sphere"}, (ShapeKind.SPHERE, 0)),
        Rival("capsule", "round about one axis", _FIT, {"shape": "capsule"}, (ShapeKind.CAPSULE, 0)),
        Rival("cylinder", "round about one axis, flat ends", _FIT, {"shape": "cylinder"}, (ShapeKind.CYLINDER, 0)),
        Rival("box", "flat", _FIT, {"shape": "cube"}, (ShapeKind.BOX, 0)),
        Rival("mesh of 1000", "1000 triangles: any form", _FIT, {"shape": "mesh"}, (ShapeKind.MESH, 1000), _FEW),
        Rival("mesh of 10000", "10,000 triangles: any form", _FIT, {"shape": "mesh"}, (ShapeKind.MESH, 10_000), _FEW),
    ],
    Probes(_cost_us, false_force, reference_us),
    default="sphere",
    growth=Growth(work="shapes in the scene", sizes=(1, 10, 100, 1000, 10_000)),
)
