"""Things of the examples that look like what they are called: an egg, a can, a kite, a rotor."""

from __future__ import annotations

import math

import numpy as np

from assets.builders.market.sculpt import F8, Sculpt, capsule_bar, mix, noise, rounded_box, turned
from mimics_app.world.content.meshes.mesh import MeshData
from mimics_app.world.content.meshes.primitives import cylinder, icosphere, torus

__all__ = ["can", "egg", "kite", "rotor"]

_YELLOW, _RED, _BLUE = (0.88, 0.52, 0.03), (0.62, 0.05, 0.03), (0.04, 0.20, 0.60)
_TIN, _CREAM, _WOOD = (0.56, 0.58, 0.60), (0.85, 0.78, 0.62), (0.42, 0.26, 0.13)


def egg() -> Sculpt:
    """A speckled hen's egg, 56 mm high and 44 mm thick, the blunt end down."""
    ball = icosphere(1.0, 3)
    places = ball.positions.astype(float)
    wide = 0.022 * (1.0 - 0.16 * places[:, 1])
    shaped = places * np.stack([wide, np.full(len(wide), 0.028), wide], axis=1)
    mesh = MeshData(shaped.astype(np.float32), ball.normals, ball.indices)

    def paint(at: F8, normals: F8) -> F8:
        del normals
        spots = np.clip(8.0 * (noise(at, 0.004, 3) - 0.70), 0.0, 1.0)
        return mix(mix((0.74, 0.50, 0.34), (0.84, 0.64, 0.48), noise(at, 0.02, 1)), (0.36, 0.20, 0.12), 0.6 * spots)

    return Sculpt().add(mesh, paint)


def can() -> Sculpt:
    """A tin can, 80 mm high and 60 mm thick, with rims and a label."""
    sculpt = Sculpt().add(cylinder(0.0295, 0.080, segments=44), _TIN)
    for y in (-0.039, 0.039):
        sculpt.add(torus(0.0288, 0.0014, 44), _TIN, at=(0.0, y, 0.0))
    sculpt.add(cylinder(0.0299, 0.058, segments=44), _RED)
    sculpt.add(cylinder(0.0301, 0.020, segments=44), _CREAM)
    for y in (-0.012, 0.012):
        sculpt.add(cylinder(0.0302, 0.002, segments=44), _YELLOW, at=(0.0, y, 0.0))
    for turn in range(6):  # tomatoes on the label
        angle = math.pi / 3.0 * turn
        at = (0.0301 * math.sin(angle), -0.001, 0.0301 * math.cos(angle))
        flat = turned(y=math.degrees(angle), scale=(1.0, 1.0, 0.12))
        sculpt.add(icosphere(0.0066, 1), _RED, at=at, turn=flat)
    return sculpt


def kite() -> Sculpt:
    """A diamond of four panels on two spars, 130 mm high, with a tail of bows below."""
    top, right, bottom = (0.0, 0.052), (0.044, 0.012), (0.0, -0.068)
    corners = [top, right, bottom, (-right[0], right[1])]
    sculpt = Sculpt()
    for number, colour in enumerate((_YELLOW, _RED, _YELLOW, _RED)):
        one, two = corners[number], corners[(number + 1) % 4]
        sculpt.add(_panel(one, two), colour)
    spars = ((top, bottom), (corners[3], right))
    for (x0, y0), (x1, y1) in spars:
        sculpt.add(capsule_bar(np.array([[x0, y0, 0.001], [x1, y1, 0.001]]), 0.0011, 8, 2), _WOOD)
    line = np.array([[0.006 * math.sin(1.3 * k), -0.068 - 0.012 * k, 0.004 * math.sin(0.9 * k)] for k in range(9)])
    sculpt.add(capsule_bar(line, 0.0007, 6, 2), _CREAM)
    for number, (x, y, z) in enumerate(line[2::2]):
        for side in (-1.0, 1.0):
            bow = rounded_box(0.012, 0.008, 0.002, 0.0008, 2)
            colour = (_BLUE, _RED)[number % 2]
            sculpt.add(bow, colour, at=(x + 0.006 * side, y, z), turn=turned(z=24.0 * side))
    return sculpt


def _panel(one: tuple[float, float], two: tuple[float, float]) -> MeshData:
    """A triangle from the crossing of the spars, seen from both sides; it bellies out behind the spars."""
    middle = np.array([0.0, 0.012, 0.0])
    steps = np.linspace(0.0, 1.0, 7)
    rows = [(s, t) for s in steps for t in steps]
    a, b = np.array([*one, 0.0]), np.array([*two, 0.0])
    places = np.array([middle + s * ((1.0 - t) * (a - middle) + t * (b - middle)) for s, t in rows])
    belly = np.array([0.010 * math.sin(math.pi * t) * s for s, t in rows])
    triangles = []
    for i in range(6):
        for k in range(6):
            p = 7 * i + k
            triangles += [(p, p + 7, p + 8), (p, p + 8, p + 1)]
    faces = np.array(triangles)
    both = np.vstack([places - [0.0, 0.0, 1.0] * belly[:, None], places - [0.0, 0.0, 1.0] * (belly[:, None] + 0.0006)])
    normals = np.zeros_like(both)
    normals[:49, 2], normals[49:, 2] = 1.0, -1.0
    first = np.cross(places[faces[10, 1]] - places[faces[10, 0]], places[faces[10, 2]] - places[faces[10, 0]])
    front = faces if first[2] > 0.0 else faces[:, ::-1]
    indices = np.vstack([front, front[:, ::-1] + 49]).ravel()
    return MeshData(both.astype(np.float32), normals.astype(np.float32), indices.astype(np.uint32)).validated()


def rotor() -> Sculpt:
    """Two pitched blades about a hub, 100 mm across, as broad as its box of 30 mm."""
    sculpt = Sculpt().add(cylinder(0.010, 0.016, top_radius=0.008, segments=32), _TIN)
    sculpt.add(icosphere(0.0082, 3), _RED, at=(0.0, 0.008, 0.0), turn=turned(scale=(1.0, 0.7, 1.0)))
    for side in (0.0, 180.0):
        blade = rounded_box(0.044, 0.0024, 0.026, 0.0012, 3)
        tilt = turned(x=20.0) @ np.eye(3)
        sculpt.add(blade, _BLUE, at=turned(y=side) @ np.array([0.028, 0.001, 0.0]), turn=turned(y=side) @ tilt)
        tip = rounded_box(0.007, 0.0028, 0.0262, 0.0013, 3)
        sculpt.add(tip, _CREAM, at=turned(y=side) @ np.array([0.0452, 0.001, 0.0]), turn=turned(y=side) @ tilt)
    return sculpt
