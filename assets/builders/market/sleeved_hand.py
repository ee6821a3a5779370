"""A hand in a blue sleeve: palm, four fingers, thumb."""

from __future__ import annotations

import numpy as np

from assets.builders.market.sculpt import (
    F8,
    Colour,
    Painter,
    Sculpt,
    capsule_bar,
    mix,
    noise,
    plain,
    rounded_box,
    turned,
)
from mimics_app.world.content.meshes.mesh import MeshData
from mimics_app.world.content.meshes.primitives import cylinder, icosphere, torus

__all__ = ["fingers", "palm", "thumb"]

SKIN: Colour = (0.76, 0.47, 0.33)
NAIL: Colour = (0.86, 0.62, 0.54)
SLEEVE: Colour = (0.10, 0.27, 0.52)
_ROWS = (
    (-0.0245, 0.90, 0.006, 0.0078),
    (-0.0085, 1.0, 0.0, 0.0086),
    (0.0085, 0.97, -0.001, 0.0084),
    (0.0240, 0.84, 0.004, 0.0073),
)
"""Of the fingers: where along z [m], how long, how far out [m], radius [m]."""


def palm() -> Sculpt:
    """The back of a hand and the sleeve it comes from; the origin lies between the fingertips below it."""
    sculpt = Sculpt()
    back = rounded_box(0.072, 0.025, 0.060, 0.0120, 4)
    sculpt.add(back, _skin(1), at=(0.0, 0.070, 0.0), turn=turned(0.0, 0.0, -3.0))
    for z, _, out, radius in _ROWS:
        ridge = np.array([[-0.012 + 0.012 * i, 0.0790 + 0.0010 * i, (0.80 + 0.06 * i) * z] for i in range(4)])
        sculpt.add(capsule_bar(ridge, 0.55 * radius, 10, 3), _skin(2))
        knuckle = turned(scale=(1.15, 0.75, 1.0))
        sculpt.add(icosphere(0.90 * radius, 2), _skin(3), at=(0.029 + 0.4 * out, 0.0785, z), turn=knuckle)
    wrist = np.array([[-0.004, 0.070, 0.0], [-0.004, 0.092, 0.006], [-0.003, 0.112, 0.016]])
    sculpt.add(capsule_bar(wrist, np.array([0.0235, 0.0205, 0.0195]), 24, 5), _skin(4))
    along = np.array([0.0, 0.88, 0.475])
    lean = turned(x=float(np.degrees(np.arctan2(along[2], along[1]))))
    foot = np.array([-0.003, 0.104, 0.012])
    sleeve = cylinder(0.0235, 0.052, top_radius=0.0285, segments=44)
    sculpt.add(sleeve, _cloth, at=foot + 0.026 * along, turn=lean)
    sculpt.add(cylinder(0.0262, 0.001, segments=44), (0.075, 0.21, 0.42), at=foot + 0.0524 * along, turn=lean)
    for up, radius, thick in ((0.0, 0.0222, 0.0036), (0.010, 0.0240, 0.0014), (0.052, 0.0270, 0.0022)):
        sculpt.add(torus(radius, thick, 44), plain((0.17, 0.38, 0.66), 5), at=foot + up * along, turn=lean)
    return sculpt


def fingers() -> Sculpt:
    """Four fingers at +x, the inner sides of their pads at x = 0 at the height of the origin."""
    sculpt = Sculpt()
    for z, long, out, radius in _ROWS:
        _add_finger(sculpt, radius, z, long, out)
    return sculpt


def thumb() -> Sculpt:
    """The thumb, made at +x as the fingers; the scene turns it to the other side."""
    sculpt = Sculpt()
    _add_finger(sculpt, 0.0104, 0.004, 0.90, -0.003)
    return sculpt


def _add_finger(sculpt: Sculpt, radius: float, z: float, long: float, out: float) -> None:
    """One finger from the palm over the knuckle, `out` farther from the middle, down to its tip with its nail."""
    mesh, tip = _bent(radius, z, long, out)
    sculpt.add(mesh, _skin(6))
    nail = turned(scale=(0.32, 0.95, 0.72))
    sculpt.add(icosphere(0.80 * radius, 2), NAIL, at=tip + [0.70 * radius, 0.35 * radius, 0.0], turn=nail)


def _bent(radius: float, z: float, long: float, out: float) -> tuple[MeshData, F8]:
    """Its flesh, thicker at the joints, and the middle of its tip [m]."""
    t = np.linspace(0.0, 1.0, 29)[:, None]
    corners = (
        (-0.030, 0.070, 0.75 * z),
        (0.016 + out, 0.080, z),
        (0.028 + out, 0.040, z),
        (radius, 0.006 - 0.010 * long, 0.8 * z),
    )
    a, b, c, d = (np.array(corner) for corner in corners)
    curve = (1 - t) ** 3 * a + 3 * t * (1 - t) ** 2 * b + 3 * t * t * (1 - t) * c + t**3 * d
    joints = sum(np.exp(-(((t[:, 0] - middle) / 0.055) ** 2)) for middle in (0.36, 0.66, 0.86))
    girth = radius * (1.08 - 0.20 * t[:, 0] + 0.07 * np.asarray(joints))
    return capsule_bar(curve, girth, 16, 5), curve[-1]


def _skin(seed: int) -> Painter:
    """Redder in folds below and at fingertips, a little uneven."""

    def paint(at: F8, normals: F8) -> F8:
        warm = 0.5 * np.clip(-normals[:, 1], 0.0, 1.0) + 0.5 * np.clip(1.0 - at[:, 1] / 0.03, 0.0, 1.0)
        colour = mix(SKIN, (0.72, 0.34, 0.25), 0.55 * warm)
        return colour * (0.94 + 0.10 * noise(at, 0.006, seed))[:, None]

    return paint


def _cloth(at: F8, normals: F8) -> F8:
    """A knitted sleeve: fine ribs along the arm."""
    around = np.arctan2(normals[:, 0], normals[:, 2])
    ribs = 0.90 + 0.12 * np.sin(28.0 * around) + 0.08 * noise(at, 0.006, 7)
    return np.asarray(SLEEVE) * ribs[:, None]
