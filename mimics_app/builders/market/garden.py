"""What grows: apple trees, and the meadow with its path, tufts, flowers and hills."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mimics_app.builders.market.clay import (
    F8,
    Clay,
    Colour,
    Painter,
    bar,
    chance,
    mix,
    noise,
    picked,
    surface,
    turned,
)
from mimics_app.world.meshes.mesh import MeshData, compute_normals
from mimics_app.world.meshes.primitives import icosphere

__all__ = ["build_meadow", "build_tree"]

GRASS_DARK: Colour = (0.060, 0.150, 0.030)
GRASS: Colour = (0.125, 0.245, 0.048)
GRASS_LIGHT: Colour = (0.26, 0.35, 0.085)
EARTH: Colour = (0.40, 0.275, 0.15)

_FLAT = np.array([1.0, 0.88, 1.0])
"""Foliage is less high than wide."""

_DEEP = 0.88
"""Share of the way to a foliage's surface that its triangles surely cover: they cut off its bumps."""

_SECTORS, _RINGS = 16, (0.35, 0.7, 1.5, 3.5)
"""Tiles of the meadow: so many about the middle, and where each ring of them ends [m]; the last at the edge."""


def build_tree(seed: int) -> Clay:
    """An apple tree about 0.62 m high, its foot at the origin."""
    clay = Clay()
    lean = 0.03 if seed % 2 == 0 else -0.02
    t = np.linspace(0.0, 1.0, 9)
    trunk = np.stack([lean * t + 0.012 * np.sin(3.0 * t), 0.34 * t - 0.01, 0.010 * np.sin(2.0 * t + seed)], 1)

    def bark(at: F8, normals: F8) -> F8:
        colour = mix((0.13, 0.068, 0.032), (0.27, 0.16, 0.085), noise(at * [1.0, 0.25, 1.0], 0.012, seed))
        return colour * (0.6 + 0.4 * np.clip(at[:, 1] / 0.08, 0.0, 1.0))[:, None]

    clay.add(bar(trunk, 0.034 - 0.018 * t + 0.016 * np.exp(-t / 0.07), 12), bark)
    for side, up in ((-1.0, 0.55), (1.0, 0.68)):
        foot = trunk[5]
        branch = foot + np.stack([side * 0.10 * t, 0.12 * up * t + 0.05 * t * t, 0.03 * side * t], 1)
        clay.add(bar(branch, 0.012 - 0.007 * t, 8), bark)
    r = chance(200, 11 + seed)
    blobs = [(0.0, 0.46, 0.0, 0.165)]
    for i in range(7):
        turn = 2.0 * math.pi * (i / 7.0 + 0.06 * r[i])
        blobs.append(
            (0.125 * math.cos(turn), 0.40 + 0.075 * r[10 + i], 0.115 * math.sin(turn), 0.088 + 0.028 * r[20 + i])
        )
    blobs += [(0.055, 0.565, 0.03, 0.085), (-0.06, 0.55, -0.02, 0.082)]
    centre = np.array([lean, 0.45, 0.0])
    crown = [_Foliage((x + lean, y, z), radius, 50 * seed + i) for i, (x, y, z, radius) in enumerate(blobs)]
    for one in crown:
        clay.add(one.mesh([other for other in crown if other is not one]), _leaves(centre, seed), at=one.middle)
    for i in range(26):
        turn, up = 2.0 * math.pi * r[40 + i], r[80 + i]
        out = 0.195 * math.sqrt(max(0.05, 1.0 - ((up - 0.35) / 0.75) ** 2))
        at = (lean + out * math.cos(turn), 0.34 + 0.23 * up, 0.93 * out * math.sin(turn))
        clay.add(
            icosphere(0.0125, 2),
            lambda p, n: np.asarray((0.62, 0.03, 0.03)) * (0.55 + 0.45 * np.clip(n[:, 1] + 0.7, 0, 1))[:, None],
            at=at,
        )
    return clay


@dataclass(frozen=True)
class _Foliage:
    """A ball with bumps: its middle [m], its radius [m], the seed of its bumps."""

    middle: tuple[float, float, float]
    radius: float
    seed: int

    def mesh(self, others: Sequence[_Foliage]) -> MeshData:
        """Its surface about its middle, less what is hidden inside others."""
        ball = icosphere(1.0, 3)
        unit = ball.positions.astype(np.float64)
        positions = unit * self._reach(unit)[:, None] * _FLAT
        whole = MeshData(positions.astype(np.float32), compute_normals(positions, ball.indices), ball.indices)
        hidden = np.zeros(whole.triangle_count, np.bool_)
        for other in others:
            hidden |= other.holds(positions + self.middle)[ball.indices.reshape(-1, 3)].all(axis=1)
        return picked(whole, ~hidden)

    def holds(self, places: F8) -> NDArray[np.bool_]:
        """Whether places [m], [n, 3], lie so far inside that they are not seen."""
        away = (places - self.middle) / _FLAT
        length = np.linalg.norm(away, axis=1)
        return length < _DEEP * self._reach(away / np.maximum(length, 1e-9)[:, None])

    def _reach(self, unit: F8) -> F8:
        """How far the surface is in directions [n, 3], before it is flattened [m]."""
        bumps = 0.80 + 0.26 * noise(unit + 9.0, 0.42, self.seed) + 0.12 * noise(unit + 5.0, 0.17, self.seed + 1)
        return np.asarray(self.radius * bumps)


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
    """Flat where the hand works, hills behind and at the sides [m]."""
    away = np.hypot(x, 0.8 * (z + 0.1))
    rise = np.clip((away - 1.1) / 3.0, 0.0, 1.0)
    hills = noise(np.stack([x, 0 * x, z], 1) + 20.0, 1.7, 5) + 0.5 * noise(np.stack([x, 0 * x, z], 1) + 20.0, 0.7, 6)
    return np.asarray(0.42 * rise * rise * hills * (z < 2.0))


def path_share(x: F8, z: F8) -> F8:
    """1 on the sandy path that leads past the stall, 0 on the grass, with a ragged border."""
    middle = 0.52 + 0.22 * np.sin(1.7 * z + 0.6) + 0.35 * np.clip(-z - 0.2, 0.0, 9.0) ** 1.3 * 0.6
    ragged = 0.035 * (noise(np.stack([x, 0 * x, z], 1), 0.05, 8) - 0.5)
    return np.clip((0.105 - np.abs(x - middle) + ragged) / 0.03, 0.0, 1.0)


class _Tiles:
    """The meadow in sectors of rings, of which what is out of view need not be drawn."""

    def __init__(self) -> None:
        self._clays = [Clay() for _ in range(_SECTORS * (len(_RINGS) + 1))]

    @property
    def clays(self) -> list[Clay]:
        """Those that hold something."""
        return [clay for clay in self._clays if not clay.empty]

    def at(self, x: float, z: float) -> Clay:
        """The tile about a place [m]."""
        return self._clays[int(_tile(np.array([x]), np.array([z]))[0])]

    def add(self, mesh: MeshData, paint: Painter) -> None:
        """Each triangle to the tile that its middle is in; normals stay those of the whole."""
        middles = mesh.positions[mesh.indices.reshape(-1, 3)].astype(np.float64).mean(axis=1)
        tiles = _tile(middles[:, 0], middles[:, 2])
        for number in np.unique(tiles):
            self._clays[number].add(picked(mesh, tiles == number), paint)


def _tile(x: F8, z: F8) -> NDArray[np.int64]:
    """Numbers of the tiles that places are in [m]."""
    ring = np.searchsorted(_RINGS, np.hypot(x, z))
    sector = np.floor((np.arctan2(-z, x) / (2.0 * math.pi) % 1.0) * _SECTORS).astype(np.int64) % _SECTORS
    return np.asarray(ring * _SECTORS + sector)


def build_meadow(seed: int) -> list[Clay]:
    """Ground out to 9 m, finest where it is near, in tiles."""
    tiles = _Tiles()
    reach = np.concatenate([np.linspace(0.0, 0.7, 44), 0.7 * (9.0 / 0.7) ** np.linspace(0.0, 1.0, 46)[1:]])

    def point(r: F8, turn: F8) -> F8:
        x, z = r * np.cos(turn), -r * np.sin(turn)
        return np.stack([x, ground_height(x, z), z], 1)

    def paint(at: F8, normals: F8) -> F8:
        x, z = at[:, 0], at[:, 2]
        flat = np.stack([x, 0 * x, z], 1)
        patch = 0.6 * noise(flat, 0.16, 1) + 0.4 * noise(flat, 0.035, 2)
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
        return colour * (0.92 + 0.16 * noise(flat, 0.009, 3))[:, None]

    tiles.add(surface(point, reach, np.linspace(0.0, 2.0 * math.pi, 161)), paint)
    _grow(tiles, seed)
    return tiles.clays


def _grow(tiles: _Tiles, seed: int) -> None:
    """Tufts and flowers about the bed and the path, none inside."""
    r = chance(6000, 76 + seed)
    count = 0
    for i in range(620):
        x, z = -1.0 + 2.0 * r[3 * i], -0.95 + 1.5 * r[3 * i + 1]
        inside = -0.235 < x < 0.33 and -0.175 < z < 0.15
        if inside or path_share(np.array([x]), np.array([z]))[0] > 0.1 or (z > 0.22 and abs(x) < 0.35):
            continue
        count += 1
        size = 0.014 + 0.020 * r[3 * i + 2]
        y = float(ground_height(np.array([x]), np.array([z]))[0])
        clay = tiles.at(x, z)
        clay.add(_tuft(size, i), _blades, at=(x, y, z))
        if count % 5 == 0:
            colour = ((0.90, 0.86, 0.78), (0.85, 0.60, 0.06), (0.62, 0.16, 0.30))[count // 5 % 3]
            clay.add(
                icosphere(0.0052, 0),
                colour,
                at=(x + 0.006, y + size * 1.25, z + 0.004),
                turn=turned(scale=(1.0, 0.55, 1.0)),
            )


def _tuft(size: float, seed: int) -> MeshData:
    """A few blades of grass, each a bent triangle seen from both sides."""
    r = chance(40, seed)
    corners: list[F8] = []
    triangles: list[int] = []
    for i in range(7):
        turn, lean = 2.0 * math.pi * (i / 7.0 + 0.1 * r[i]), 0.25 + 0.5 * r[10 + i]
        out = np.array([math.cos(turn), 0.0, math.sin(turn)])
        across = 0.09 * size * np.array([-out[2], 0.0, out[0]])
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
