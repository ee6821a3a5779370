"""A canyon 200 m wide: streets to both rims, walls of layered rock, talus, a river, parapets, a beam, a bird."""

from __future__ import annotations

import itertools
import math

import numpy as np

from assets.builders.canyon.textures import (
    LAYERED,
    paint_layers,
    paint_planks,
    paint_rubble,
    paint_stone,
    paint_water,
)
from assets.builders.city.textures import paint_road
from assets.builders.kit.lattice_noise import hash_noise
from assets.builders.kit.sketch import Point, Sketch, Uv
from mimics_app.contracts.arrays import F8
from mimics_app.world.files.gltf.writer import GltfWriter

__all__ = ["WIDTH", "compose"]

WIDTH = 200.0
"""Width of the canyon along the beam [m]: the near rim is at z = 0, the far one at z = -200."""
_PROFILE = (
    *((0.0, 0.0), (1.2, -14.0), (6.0, -16.0), (8.0, -38.0), (16.0, -42.0), (18.5, -66.0), (20.0, -80.0)),
    *((29.0, -84.0), (31.0, -104.0), (38.0, -110.0), (52.0, -126.0), (66.0, -139.0), (80.0, -146.0), (84.0, -148.0)),
)
"""A wall from its rim to the river: distance from the rim and height [m]: cliffs, ledges, and the talus below."""
_TALUS = 9
"""Number in the profile from which on it is talus."""
_FINE = 3
"""Pieces of each part of the profile."""
_COLUMNS = tuple(sorted({*range(-520, 521, 40), *range(-80, 81, 8), *range(-12, 13, 4)}))
"""Places across the beam at which the walls bend [m]."""
_RUBBLE = 17.0
"""Width of ground that one repetition of the rubble covers [m]."""
_STREET = 6.0
"""Half the width of the street [m]."""
_KEPT, _MEANDER = 10.0, 46.0
"""Distance from the beam within which the rims are straight; beyond it they meander [m], and how far."""
_LAND = 620.0
"""Half the width of the land, and how far it continues behind the rims [m]."""
_STREET_BEHIND = 260.0
"""Length of the streets from the rims [m]."""
_MESAS = ((-330.0, -560.0, 92.0, 58.0), (150.0, -660.0, 150.0, 74.0), (430.0, -520.0, 84.0, 46.0))
"""Table mountains beyond: x, z, radius, height [m]."""
_PARAPET = (0.78, 0.40, 48.0)
"""Height, thickness and length of the parapets on both sides of the beam [m]."""
_GAP = 1.1
"""Half the gap in the parapets, where the beam begins [m]."""


def compose(seed: int) -> dict[str, bytes]:
    """Return all files by name.

    Args:
        seed: Of textures and rock.
    """
    return {"canyon.glb": _compose_land(seed), "beam.glb": _compose_beam(seed), "bird.glb": _compose_bird()}


def _compose_land(seed: int) -> bytes:
    writer = GltfWriter("mimics_app assets build canyon")
    painted = {
        "rock": (paint_layers(seed), 1.0),
        "rubble": (paint_rubble(seed + 20), 1.0),
        "river": (paint_water(seed + 40), 0.35),
        "road": (paint_road(seed + 60), 1.0),
        "stone": (paint_stone(seed + 90), 0.95),
    }
    materials = {
        name: writer.add_material(f"canyon_{name}", texture=writer.add_picture(name, png), roughness=rough)
        for name, (png, rough) in painted.items()
    }
    for name, sketch in (
        ("walls", _walls(seed)),
        ("land", _land(seed)),
        ("river", _river()),
        ("mesas", _mesas(seed)),
        ("street", _streets()),
    ):
        parts = [(writer.add_part(part), materials[material]) for material, part in sketch.parts().items()]
        writer.add_node(name, mesh=writer.add_mesh(name, parts))
    return writer.to_bytes()


def _compose_beam(seed: int) -> bytes:
    """A beam 1 m wide, to be scaled: its upper side at y = 0, from z = 1 to z = -201."""
    writer = GltfWriter("mimics_app assets build canyon")
    planks = writer.add_material(
        "canyon_planks", texture=writer.add_picture("planks", paint_planks(seed + 80)), roughness=0.9
    )
    steel = writer.add_material("canyon_steel", colour=(0.20, 0.11, 0.08, 1.0), roughness=0.7)
    sketch, ends = Sketch(), (-WIDTH - 1.0, 1.0)
    for far, near in itertools.pairwise(np.linspace(*ends, 26).tolist()):
        top: list[Point] = [(-0.5, 0.0, near), (0.5, 0.0, near), (0.5, 0.0, far), (-0.5, 0.0, far)]
        sketch.fan("planks", top, [(x + 0.5, z / 2.0) for x, _, z in top])
    sketch.box("steel", (-0.47, -0.09, ends[0]), (0.47, -0.005, ends[1]), shade=0.9)
    sketch.box("steel", (-0.10, -0.52, ends[0]), (0.10, -0.09, ends[1]), shade=0.8)
    sketch.box("steel", (-0.42, -0.60, ends[0]), (0.42, -0.52, ends[1]), shade=0.8)
    for z in np.arange(ends[0] + 2.5, ends[1], 4.0).tolist():
        sketch.box("steel", (-0.40, -0.52, z - 0.04), (0.40, -0.09, z + 0.04), shade=0.85)
    materials = {"planks": planks, "steel": steel}
    parts = [(writer.add_part(part), materials[material]) for material, part in sketch.parts().items()]
    writer.add_node("beam", mesh=writer.add_mesh("beam", parts))
    return writer.to_bytes()


def _compose_bird() -> bytes:
    """A bird of prey with spread wings, 2 m across; it looks along +z."""
    writer = GltfWriter("mimics_app assets build canyon")
    feathers = writer.add_material("canyon_feathers", colour=(0.05, 0.04, 0.035, 1.0), roughness=1.0)
    sketch = Sketch()
    for side in (-1.0, 1.0):
        wing: list[Point] = [
            (side * 0.06, 0.0, 0.16),
            (side * 0.55, 0.10, 0.22),
            (side * 1.0, 0.04, -0.05),
            (side * 0.5, 0.09, -0.12),
            (side * 0.06, 0.0, -0.14),
        ]
        for corners in (wing, wing[::-1]):
            sketch.fan("feathers", corners, [(0.0, 0.0)] * 5)
    body: list[Point] = [(0.0, 0.03, 0.36), (0.09, 0.02, 0.1), (0.0, 0.03, -0.5), (-0.09, 0.02, 0.1)]
    for corners in (body, body[::-1]):
        sketch.fan("feathers", corners, [(0.0, 0.0)] * 4)
    part = sketch.parts()["feathers"]
    writer.add_node("bird", mesh=writer.add_mesh("bird", [(writer.add_part(part), feathers)]))
    return writer.to_bytes()


def _noise(seed: int, row: int, count: int) -> F8:
    """Return noise of [-1, 1) at each column, smoothed over its neighbours."""
    raw = 2.0 * hash_noise(np.arange(count + 2), np.full(count + 2, row), seed) - 1.0
    return np.asarray(0.25 * raw[:-2] + 0.5 * raw[1:-1] + 0.25 * raw[2:])


def _kept(x: F8) -> F8:
    """Return how free the rock is to meander at a place: 0 at the beam, 1 far from it."""
    share = np.clip((np.abs(x) - _KEPT) / 90.0, 0.0, 1.0)
    return np.asarray(share * share * (3.0 - 2.0 * share))


def _rim(seed: int, side: int) -> F8:
    """Return how far a rim is from its straight line at each column, into the land [m]."""
    x = np.array(_COLUMNS, np.float64)
    wide = np.interp(x, np.linspace(-520.0, 520.0, 15), _noise(seed, 40 + side, 15))
    return np.asarray(_MEANDER * _kept(x) * wide)


def _walls(seed: int) -> Sketch:
    """Both walls, from the rims down to the river."""
    sketch, x = Sketch(), np.array(_COLUMNS, np.float64)
    for side, (origin, sign) in enumerate(((0.0, -1.0), (-WIDTH, 1.0))):
        rows, heights = _rows(seed, side, x)
        back = _rim(seed, side)
        grid = [
            [(float(x[i]), float(heights[k, i]), origin + sign * float(rows[k, i] - back[i])) for i in range(len(x))]
            for k in range(len(rows))
        ]
        talus = _TALUS * _FINE
        for k, i in itertools.product(range(len(grid) - 1), range(len(x) - 1)):
            corners = [grid[k][i], grid[k + 1][i], grid[k + 1][i + 1], grid[k][i + 1]]
            if sign < 0.0:
                corners.reverse()
            _add_rock(sketch, "rubble" if k >= talus else "rock", corners)
    return sketch


def _rows(seed: int, side: int, x: F8) -> tuple[F8, F8]:
    """Return distance from the rim and height of each point of a wall [m], [rows, columns] each."""
    profile = np.array(_PROFILE)
    at = np.linspace(0.0, len(profile) - 1.0, (len(profile) - 1) * _FINE + 1)
    ahead, down = (np.interp(at, np.arange(len(profile)), profile[:, axis]) for axis in (0, 1))
    rows, heights = [], []
    for k, (far, low) in enumerate(zip(ahead.tolist(), down.tolist(), strict=True)):
        rough = _noise(seed + side, k, len(x))
        ribs = _noise(seed + 7 + side, k // (2 * _FINE), len(x))
        free = 0.25 + 0.75 * _kept(x)
        free = np.zeros_like(x) if k == 0 else free * min(k / _FINE, 1.0)
        rows.append(far + free * (2.2 * rough + 6.0 * ribs))
        heights.append(low + free * 0.9 * _noise(seed + 13 + side, k, len(x)))
    return np.array(rows), np.array(heights)


def _add_rock(sketch: Sketch, material: str, corners: list[Point]) -> None:
    """Add a piece of rock; its layers are level, so their picture goes by the height."""
    shade = 0.62 + 0.38 * math.exp(min(c[1] for c in corners) / 90.0)
    for triangle in (corners[:3], [corners[0], corners[2], corners[3]]):
        uvs: list[Uv]
        if material == "rock":
            uvs = [((x + 0.35 * z) / LAYERED, -y / LAYERED) for x, y, z in triangle]
        else:
            uvs = [(x / _RUBBLE, z / _RUBBLE) for x, _, z in triangle]
        sketch.fan(material, triangle, uvs, shade)


def _land(seed: int) -> Sketch:
    """The land on both sides up to the rims: gravel, with low swells far from the street."""
    sketch, x = Sketch(), np.array(_COLUMNS, np.float64)
    for side, (origin, sign) in enumerate(((0.0, 1.0), (-WIDTH, -1.0))):
        back = _rim(seed, side)
        depths = (0.0, 8.0, 24.0, 60.0, 140.0, 300.0, _LAND)
        grid = []
        for k, depth in enumerate(depths):
            share = depth / _LAND
            away = (1.0 - share) * back + depth
            swell = 9.0 * min(depth / 140.0, 1.0) * _kept(x) * (0.4 + _noise(seed + 31 + side, k, len(x)))
            low = -0.02 + np.where(np.abs(x) <= 12.0, 0.0, swell if k > 1 else 0.0)
            grid.append([(float(x[i]), float(low[i]), origin + sign * float(away[i])) for i in range(len(x))])
        for k, i in itertools.product(range(len(grid) - 1), range(len(x) - 1)):
            corners = [grid[k + 1][i], grid[k + 1][i + 1], grid[k][i + 1], grid[k][i]]
            if sign < 0.0:
                corners.reverse()
            for triangle in (corners[:3], [corners[0], corners[2], corners[3]]):
                sketch.fan("rubble", triangle, [(a / _RUBBLE, c / _RUBBLE) for a, _, c in triangle], 0.95)
    return sketch


def _river() -> Sketch:
    """The river along x, in the middle of the canyon; its banks are under the talus."""
    sketch = Sketch()
    for left, right in itertools.pairwise(np.linspace(-560.0, 560.0, 15).tolist()):
        corners: list[Point] = [
            (left, -147.2, -45.0),
            (right, -147.2, -45.0),
            (right, -147.2, -155.0),
            (left, -147.2, -155.0),
        ]
        sketch.fan("river", corners, [(x / 110.0, z / 57.0) for x, _, z in corners])
    return sketch


def _mesas(seed: int) -> Sketch:
    """Table mountains on the horizon, with a cliff over a slope."""
    sketch, sides = Sketch(), 22
    for number, (x, z, radius, height) in enumerate(_MESAS):
        wobble = 1.0 + 0.16 * _noise(seed + 50, number, sides)
        rings = []
        for out, up in ((1.75, -1.0), (1.15, 0.48 * height), (1.06, 0.94 * height), (1.0, height)):
            turns = [2.0 * math.pi * k / sides for k in range(sides)]
            rings.append(
                [
                    (round(x + radius * out * w * math.cos(t), 3), up, round(z - radius * out * w * math.sin(t), 3))
                    for t, w in zip(turns, wobble.tolist(), strict=True)
                ]
            )
        for lower, upper in itertools.pairwise(rings):
            for k in range(sides):
                n = (k + 1) % sides
                _add_rock(sketch, "rock", [lower[k], lower[n], upper[n], upper[k]])
        sketch.fan("rubble", rings[-1], [(a / _RUBBLE, c / _RUBBLE) for a, _, c in rings[-1]])
    return sketch


def _streets() -> Sketch:
    """The streets to both rims, and the parapets with a gap for the beam."""
    sketch = Sketch()
    high, thick, length = _PARAPET
    for near, sign in ((0.0, 1.0), (-WIDTH, -1.0)):
        ends = np.linspace(near + sign * 0.6, near + sign * _STREET_BEHIND, 14).tolist()
        for first, second in itertools.pairwise(ends):
            low, upper = min(first, second), max(first, second)
            corners: list[Point] = [
                (-_STREET, 0.0, upper),
                (_STREET, 0.0, upper),
                (_STREET, 0.0, low),
                (-_STREET, 0.0, low),
            ]
            sketch.fan("road", corners, [((a + _STREET) / (2.0 * _STREET), c / 12.0) for a, _, c in corners])
        sketch.box(
            "stone", (-_STREET, -0.4, min(near, near + sign * 0.6)), (_STREET, 0.001, max(near, near + sign * 0.6))
        )
        for side in (-1.0, 1.0):
            for piece in range(int(length // 4.0)):
                begin, end = _GAP + 4.0 * piece, _GAP + 4.0 * (piece + 1) - 0.02
                left, right = sorted((side * begin, side * end))
                z0, z1 = sorted((near + sign * 0.1, near + sign * (0.1 + thick)))
                sketch.box("stone", (left, -0.4, z0), (right, high, z1), shade=0.92 + 0.02 * (piece % 4))
            post = side * (_GAP + 0.1)
            z0, z1 = sorted((near + sign * 0.02, near + sign * (thick + 0.18)))
            sketch.box("stone", (post - 0.26, -0.4, z0), (post + 0.26, high + 0.2, z1))
    return sketch
