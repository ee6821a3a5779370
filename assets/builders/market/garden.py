"""What grows: apple trees, and the meadow with its path, tufts, flowers and hills."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from assets.builders.market.sculpt import (
    F8,
    Colour,
    Painter,
    Sculpt,
    bar,
    capsule_bar,
    mix,
    noise,
    picked,
    surface,
    turned,
    uniform_draws,
)
from mimics_app.world.content.meshes.mesh import MeshData, compute_normals
from mimics_app.world.content.meshes.primitives import icosphere

__all__ = ["MEADOW_COVERAGES", "TREE_COVERAGES", "build_meadow", "build_tree"]

GRASS_DARK: Colour = (0.060, 0.150, 0.030)
GRASS: Colour = (0.125, 0.245, 0.048)
GRASS_LIGHT: Colour = (0.26, 0.35, 0.085)
EARTH: Colour = (0.40, 0.275, 0.15)

_SECTORS, _RINGS = 16, (0.36, 0.7, 1.5, 3.5)
"""Tiles of the meadow: so many about the middle, and where each ring of them ends [m]; the last at the edge."""

MEADOW_COVERAGES = (0.018, 0.0)
"""Least share of a picture that each form of a tile of the meadow covers: the coarse one is shown in pictures of fewer
than 480 x 270 pixels, or from far away. Tiles of both forms meet in common vertices."""

TREE_COVERAGES = (0.6, 0.16, 0.02, 0.0)
"""Least share of a picture that each form of a tree covers: an apple's outline is off by half a pixel of 1920 x 1080 at
the next finer one's end."""


@dataclass(frozen=True)
class _Form:
    """Resolution of a tree.

    Attributes:
        trunk: Sides of trunk and branches.
        ball: Subdivisions of a ball of leaves.
        apple: Of an apple.
        stalk: Sides of an apple's stalk; 0: none is seen.
        leaves: One in this number of leaves is made; fewer are larger.
        halves: Number of triangles of a leaf.
    """

    trunk: int
    ball: int
    apple: int
    stalk: int
    leaves: int
    halves: int


_FORMS = (_Form(12, 2, 2, 6, 1, 2), _Form(8, 1, 1, 3, 1, 2), _Form(6, 1, 0, 0, 1, 1), _Form(4, 0, 0, 0, 4, 1))


@dataclass(frozen=True)
class _Ground:
    """Resolution of the meadow.

    Attributes:
        circles: Numbers of the vertices used of those from the middle to the edge; tiles end at 19, 37, 49 and 63.
        turn: One in this number of vertices around is used.
        blades: Blades of a tuft.
        flowers: Whether there are flowers.
    """

    circles: tuple[int, ...]
    turn: int
    blades: int
    flowers: bool


_GROUNDS = (
    _Ground(tuple(range(79)), 1, 7, flowers=True),
    _Ground((0, 6, 12, 19, 25, 31, 37, 40, 43, 46, 49, 52, 56, 59, 63, 66, 70, 74, 78), 2, 1, flowers=False),
)


def build_tree(seed: int) -> list[Sculpt]:
    """An apple tree about 0.62 m high, its foot at the origin: the finest form, then those for farther away.

    All have the same apples, and the same leaves or every fourth of them, in the same places.
    """
    return [_shape_tree(seed, form) for form in _FORMS]


def _shape_tree(seed: int, form: _Form) -> Sculpt:
    sculpt = Sculpt()
    lean = 0.03 if seed % 2 == 0 else -0.02
    t = np.linspace(0.0, 1.0, 9)
    trunk = np.stack([lean * t + 0.012 * np.sin(3.0 * t), 0.34 * t - 0.01, 0.010 * np.sin(2.0 * t + seed)], 1)

    def bark(at: F8, normals: F8) -> F8:
        colour = mix((0.13, 0.068, 0.032), (0.27, 0.16, 0.085), noise(at * [1.0, 0.25, 1.0], 0.012, seed))
        return colour * (0.6 + 0.4 * np.clip(at[:, 1] / 0.08, 0.0, 1.0))[:, None]

    sculpt.add(bar(trunk, 0.034 - 0.018 * t + 0.016 * np.exp(-t / 0.07), form.trunk), bark)
    for side, up in ((-1.0, 0.55), (1.0, 0.68)):
        foot = trunk[5]
        branch = foot + np.stack([side * 0.10 * t, 0.12 * up * t + 0.05 * t * t, 0.03 * side * t], 1)
        sculpt.add(bar(branch, 0.012 - 0.007 * t, 2 * form.trunk // 3), bark)
    r = uniform_draws(200, 11 + seed)
    blobs = [(0.0, 0.46, 0.0, 0.165)]
    for i in range(7):
        turn = 2.0 * math.pi * (i / 7.0 + 0.06 * r[i])
        blobs.append(
            (0.125 * math.cos(turn), 0.40 + 0.075 * r[10 + i], 0.115 * math.sin(turn), 0.088 + 0.028 * r[20 + i])
        )
    blobs += [(0.055, 0.565, 0.03, 0.085), (-0.06, 0.55, -0.02, 0.082)]
    centre = np.array([lean, 0.45, 0.0])
    for i, (x, y, z, radius) in enumerate(blobs):
        sculpt.add(
            _foliage(0.93 * radius, 50 * seed + i, form.ball), _bright(_leaves(centre, seed), 0.55), at=(x + lean, y, z)
        )
    crown = np.array(blobs) + [lean, 0.0, 0.0, 0.0]
    places = list(enumerate(_on_crown(crown, 1700, seed)))
    for i, (at, normal) in places[:: form.leaves]:
        paint = _bright(_leaves(centre, seed), 1.05 + 0.5 * r[i % 200])
        sculpt.add(_leaf(at, normal, 1000 * seed + i, form), paint)
    _hang_apples(sculpt, crown, seed, form)
    return sculpt


def _on_crown(blobs: F8, count: int, seed: int) -> list[tuple[F8, F8]]:
    """Places on the outside of balls (x, y, z, radius), [n, 4], with normals: evenly on each, none inside another."""
    places: list[tuple[F8, F8]] = []
    r = uniform_draws(4 * count, 300 + seed)
    total = float((blobs[:, 3] ** 2).sum())
    for x, y, z, radius in blobs:
        share = round(count * radius * radius / total)
        for i in range(share):
            up = 1.0 - 2.0 * (i + 0.5) / share
            turn = i * math.pi * (3.0 - math.sqrt(5.0)) + 0.5 * r[len(places)]
            ring = math.sqrt(1.0 - up * up)
            normal = np.array([ring * math.cos(turn), up, ring * math.sin(turn)])
            at = np.array([x, y, z]) + radius * normal * [1.0, 0.88, 1.0]
            inside = np.linalg.norm((blobs[:, :3] - at) / [1.0, 0.88, 1.0], axis=1) < 0.93 * blobs[:, 3]
            if not inside.any():
                places.append((at, normal))
    return places


def _leaf(at: F8, normal: F8, seed: int, form: _Form) -> MeshData:
    """A pointed leaf folded along its rib, about 35 mm long, that looks outwards and hangs a little.

    Of one triangle it is flat and without its tip, and as wide as makes up for that.
    """
    r = uniform_draws(6, seed)
    outward = normal + 0.9 * (r[:3] - 0.5) + [0.0, 0.15, 0.0]
    outward /= np.linalg.norm(outward)
    along = np.cross(outward, r[3:] - 0.5)
    along = along - [0.0, 0.35, 0.0] + 0.35 * outward[1] * outward
    along /= np.linalg.norm(along)
    across = np.cross(outward, along)
    larger = math.sqrt(form.leaves)
    long, wide = larger * (0.0125 + 0.005 * r[4]), larger * (0.0070 + 0.0018 * r[5])
    lifted = at + 0.004 * normal
    corners = [
        lifted - long * along,
        lifted + wide * across - 0.30 * wide * outward,
        lifted + long * along - 0.004 * outward,
        lifted - wide * across - 0.30 * wide * outward,
    ]
    positions = np.array([corners[k] for k in ((0, 1, 2, 0, 2, 3) if form.halves == 2 else (3, 1, 2))])
    if form.halves == 1:
        positions[2] = 2.0 * corners[2] - lifted  # the tip of a triangle of the leaf's area
        positions[:] -= 0.5 * long * along
    triangles = np.array([0, 2, 1, 3, 5, 4][: len(positions)], np.uint32)
    faces = np.cross(positions[1] - positions[0], positions[2] - positions[0])
    if float(faces @ outward) > 0.0:
        triangles = np.arange(len(positions), dtype=np.uint32)
    normals = np.tile(0.6 * normal + 0.4 * outward, (len(positions), 1))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return MeshData(positions.astype(np.float32), normals.astype(np.float32), triangles)


def _hang_apples(sculpt: Sculpt, crown: F8, seed: int, form: _Form) -> None:
    """Apples among the leaves, most of them below, each on its stalk from the foliage."""

    def paint(at: F8, normals: F8) -> F8:
        blush = noise(at, 0.02, seed + 8)
        red = mix((0.60, 0.03, 0.025), (0.74, 0.30, 0.05), 0.7 * np.clip(blush - 0.35, 0.0, 1.0))
        return red * (0.60 + 0.40 * np.clip(normals[:, 1] + 0.7, 0.0, 1.0))[:, None]

    low = [(at, normal) for at, normal in _on_crown(crown, 420, seed + 40) if -0.9 < normal[1] < -0.05]
    for at, normal in low[:: max(1, len(low) // 24)][:24]:
        out = at + 0.004 * normal
        middle = out + [0.0, -0.016, 0.0]
        stalk = np.stack(
            [out - 0.012 * normal + [0.0, 0.010, 0.0], out + [0.0, 0.001, 0.0], middle + [0.0, 0.009, 0.0]]
        )
        if form.stalk:
            sculpt.add(capsule_bar(stalk, 0.0011, form.stalk, form.stalk // 6 * 2), (0.16, 0.09, 0.04))
        sculpt.add(_ball(0.0125, form.apple), paint, at=middle, turn=turned(scale=(1.0, 0.92, 1.0)))


def _ball(radius: float, subdivisions: int) -> MeshData:
    """A ball of few triangles whose outline takes up as much room as a round one's: a quarter of its surface; [m]."""
    ball = icosphere(radius, subdivisions)
    a, b, c = ball.positions[ball.indices.reshape(-1, 3)].astype(np.float64).transpose(1, 0, 2)
    area = 0.5 * float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum())
    return icosphere(radius * math.sqrt(4.0 * math.pi * radius**2 / area), subdivisions)


def _foliage(radius: float, seed: int, subdivisions: int) -> MeshData:
    """Return a ball with bumps."""
    ball = _ball(1.0, subdivisions)
    unit = ball.positions.astype(np.float64)
    bumps = 0.80 + 0.26 * noise(unit + 9.0, 0.42, seed) + 0.12 * noise(unit + 5.0, 0.17, seed + 1)
    positions = radius * unit * bumps[:, None] * [1.0, 0.88, 1.0]
    return MeshData(positions.astype(np.float32), compute_normals(positions, ball.indices), ball.indices)


def _bright(painter: Painter, factor: float) -> Painter:
    """Return a paint that is lighter or darker by a factor."""

    def paint(at: F8, normals: F8) -> F8:
        return factor * painter(at, normals)

    return paint


def _leaves(centre: F8, seed: int) -> Painter:
    def paint(at: F8, normals: F8) -> F8:
        open_sky = 0.55 + 0.45 * normals[:, 1]
        outward = np.clip(np.linalg.norm(at - centre, axis=1) / 0.22, 0.0, 1.0)
        speckle = noise(at, 0.013, seed + 3)
        share = 0.75 * open_sky + 0.55 * (speckle - 0.5)
        colour = np.where(
            (share < 0.5)[:, None],
            mix(GRASS_DARK, (0.095, 0.225, 0.04), 2.0 * share),
            mix((0.095, 0.225, 0.04), (0.27, 0.38, 0.08), 2.0 * share - 1.0),
        )
        return colour * (0.45 + 0.55 * outward)[:, None]

    return paint


def ground_height(x: F8, z: F8) -> F8:
    """Return the height of the ground: flat around the workspace, hills behind and at the sides [m]."""
    away = np.hypot(x, 0.8 * (z + 0.1))
    rise = np.clip((away - 1.1) / 3.0, 0.0, 1.0)
    hills = noise(np.stack([x, 0 * x, z], 1) + 20.0, 1.7, 5) + 0.5 * noise(np.stack([x, 0 * x, z], 1) + 20.0, 0.7, 6)
    return np.asarray(0.42 * rise * rise * hills * (z < 2.0))


def path_share(x: F8, z: F8) -> F8:
    """Return 1 on the sandy path that leads past the stall, 0 on the grass, with a ragged border."""
    middle = 0.52 + 0.22 * np.sin(1.7 * z + 0.6) + 0.35 * np.clip(-z - 0.2, 0.0, 9.0) ** 1.3 * 0.6
    ragged = 0.035 * (noise(np.stack([x, 0 * x, z], 1), 0.05, 8) - 0.5)
    return np.clip((0.105 - np.abs(x - middle) + ragged) / 0.03, 0.0, 1.0)


def _carried(flat: F8, cell: float, seed: int, step: F8) -> F8:
    """Noise about 0, faded out where corners a step [m] apart do not carry it."""
    return np.asarray((noise(flat, cell, seed) - 0.5) * np.clip(2.0 - 3.0 * step / cell, 0.0, 1.0))


class _Tiles:
    """The meadow in sectors of rings, so that those out of view are culled.

    Attributes:
        clays: All tiles, ring by ring from the middle.
    """

    def __init__(self) -> None:
        self.clays = [Sculpt() for _ in range(_SECTORS * (len(_RINGS) + 1))]

    def at(self, x: float, z: float) -> Sculpt:
        """Return the tile that holds a point [m]."""
        return self.clays[int(_tile(np.array([x]), np.array([z]))[0])]

    def add(self, mesh: MeshData, paint: Painter) -> None:
        """Each triangle to the tile that its middle is in; normals stay those of the whole."""
        middles = mesh.positions[mesh.indices.reshape(-1, 3)].astype(np.float64).mean(axis=1)
        tiles = _tile(middles[:, 0], middles[:, 2])
        for number in np.unique(tiles):
            self.clays[number].add(picked(mesh, tiles == number), paint)


def _tile(x: F8, z: F8) -> NDArray[np.int64]:
    """Numbers of the tiles that places are in [m]."""
    ring = np.searchsorted(_RINGS, np.hypot(x, z))
    sector = np.floor((np.arctan2(-z, x) / (2.0 * math.pi) % 1.0) * _SECTORS).astype(np.int64) % _SECTORS
    return np.asarray(ring * _SECTORS + sector)


def build_meadow(seed: int) -> list[list[Sculpt]]:
    """Ground out to 9 m, finest where it is near: of each tile the fine form, then the coarse one."""
    return [list(forms) for forms in zip(*(_lay_ground(seed, ground).clays for ground in _GROUNDS), strict=True)]


def _lay_ground(seed: int, ground: _Ground) -> _Tiles:
    """Make ground, tufts and flowers of a resolution."""
    tiles = _Tiles()
    reach = np.concatenate([np.linspace(0.0, 0.7, 38), 0.7 * (9.0 / 0.7) ** np.linspace(0.0, 1.0, 42)[1:]])

    def point(r: F8, turn: F8) -> F8:
        x, z = r * np.cos(turn), -r * np.sin(turn)
        return np.stack([x, ground_height(x, z), z], 1)

    def paint(at: F8, normals: F8) -> F8:
        x, z = at[:, 0], at[:, 2]
        flat = np.stack([x, 0 * x, z], 1)
        step = 0.06 * ground.turn * np.hypot(x, z)  # of the ground's corners: finer noise than they carry makes streaks
        patch = 0.5 + 0.6 * _carried(flat, 0.16, 1, step) + 0.4 * _carried(flat, 0.035, 2, step)
        patch += 0.35 * _carried(flat, 1.1, 13, step)
        colour = mix(mix(GRASS_DARK, GRASS, 1.6 * patch), GRASS_LIGHT, 1.8 * (patch - 0.5))
        sand = mix(EARTH, (0.58, 0.44, 0.27), noise(flat, 0.05, 4))
        bed = np.clip(
            (0.016 - np.maximum(np.maximum(-0.205 - x, x - 0.022), np.maximum(-0.075 - z, z - 0.125))) / 0.012, 0.0, 1.0
        )
        lawn = mix(
            (0.13, 0.31, 0.045),
            (0.19, 0.37, 0.06),
            (np.floor((x + 0.6 * z) / 0.043) % 2.0) * 0.55 + 0.45 * noise(flat, 0.012, 12),
        )
        colour = mix(mix(colour, sand, path_share(x, z)), lawn, bed)
        return colour * (1.0 + 0.16 * _carried(flat, 0.009, 3, step))[:, None]

    turns = np.linspace(0.0, 2.0 * math.pi, 129)
    tiles.add(surface(point, reach[list(ground.circles)], turns[:: ground.turn]), paint)
    _grow(tiles, seed, ground)
    return tiles


def _grow(tiles: _Tiles, seed: int, ground: _Ground) -> None:
    """Tufts and flowers about the bed and the path, none inside."""
    r = uniform_draws(6000, 76 + seed)
    count = 0
    for i in range(620):
        x, z = -1.0 + 2.0 * r[3 * i], -0.95 + 1.5 * r[3 * i + 1]
        inside = -0.235 < x < 0.33 and -0.175 < z < 0.15
        if inside or path_share(np.array([x]), np.array([z]))[0] > 0.1 or (z > 0.22 and abs(x) < 0.35):
            continue
        count += 1
        size = 0.014 + 0.020 * r[3 * i + 2]
        y = float(ground_height(np.array([x]), np.array([z]))[0])
        sculpt = tiles.at(x, z)
        sculpt.add(_tuft(size, i, ground.blades), _blades, at=(x, y, z))
        if ground.flowers and count % 5 == 0:
            colour = ((0.90, 0.86, 0.78), (0.85, 0.60, 0.06), (0.62, 0.16, 0.30))[count // 5 % 3]
            sculpt.add(
                icosphere(0.0052, 0),
                colour,
                at=(x + 0.006, y + size * 1.25, z + 0.004),
                turn=turned(scale=(1.0, 0.55, 1.0)),
            )


def _tuft(size: float, seed: int, blades: int) -> MeshData:
    """Blades of grass, each a bent triangle seen from both sides; as wide together as seven."""
    r = uniform_draws(40, seed)
    corners: list[F8] = []
    triangles: list[int] = []
    for i in range(blades):
        turn, lean = 2.0 * math.pi * (i / blades + 0.1 * r[i]), 0.25 + 0.5 * r[10 + i]
        out = np.array([math.cos(turn), 0.0, math.sin(turn)])
        across = 0.63 / blades * size * np.array([-out[2], 0.0, out[0]])
        foot = 0.25 * size * out
        tip = foot + lean * size * out + np.array([0.0, size * (0.7 + 0.6 * r[20 + i]), 0.0])
        first = len(corners)
        corners += [foot - across, foot + across, tip, foot - across, foot + across, tip]
        triangles += [first, first + 2, first + 1, first + 3, first + 4, first + 5]
    positions = np.array(corners)
    normals = np.tile([0.0, 1.0, 0.0], (len(positions), 1))
    return MeshData(positions.astype(np.float32), normals.astype(np.float32), np.array(triangles, np.uint32))


def _blades(at: F8, normals: F8) -> F8:
    low = at[:, 1].min()
    high = max(at[:, 1].max() - low, 1e-6)
    return mix((0.065, 0.16, 0.03), (0.28, 0.40, 0.09), (at[:, 1] - low) / high)
