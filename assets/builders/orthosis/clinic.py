"""The hall of a clinic: linoleum, walls with a bumper rail, windows, ceiling lights, wall bars and a bench."""

from __future__ import annotations

import math
from collections.abc import Callable

from assets.builders.kit.lattice_noise import hash_noise, pixels, smooth_noise
from assets.builders.kit.palette_texture import Canvas
from assets.builders.kit.sketch import Point, Sketch
from assets.builders.kit.solids import Axes, Skin, add_column, add_prism, circle
from mimics_app.world.files.gltf.writer import GltfWriter

__all__ = ["compose_clinic"]

_X, _Z, _HIGH = (-3.3, 3.3), (-2.4, 3.5), 2.86
"""Walls, in front of which the person looks along x, and the ceiling [m]."""
_RAIL = 0.92
"""Height of the bumper rail [m]."""
_WINDOWS = ((-0.15, 1.25), (1.55, 2.95))
"""Windows in the wall at the person's left: from and to [m]."""
_SILL, _LINTEL = 1.02, 2.42
_LAMPS = ((-1.5, -0.9), (1.5, -0.9), (-1.5, 1.7), (1.5, 1.7))
"""Middles of the lamps in the ceiling [m]."""
_BARS = (-2.85, -1.65)
"""Wall bars: from and to along the same wall [m]."""
_BENCH = (1.55, -2.02)
"""Middle of the bench [m]."""

_UNLIT = {
    "wall": (0.80, 0.81, 0.79),
    "dado": (0.40, 0.54, 0.55),
    "ceiling": (0.78, 0.79, 0.79),
    "rail": (0.72, 0.74, 0.75),
    "lamp": (1.0, 1.0, 0.98),
    "glass": (0.66, 0.80, 0.93),
    "frost": (0.86, 0.90, 0.92),
    "frame": (0.88, 0.88, 0.87),
}
"""Colours of what takes no shadows: its light is in the vertices."""
_LIT = {
    "wood": ((0.52, 0.34, 0.18), 0.6),
    "steel": ((0.55, 0.56, 0.58), 0.4),
    "cushion": ((0.05, 0.16, 0.26), 0.6),
}
"""Colour and roughness of the furniture."""


def compose_clinic(seed: int) -> bytes:
    """Return the hall as a GLB file of two nodes, `hall` and `furniture`; its floor is y = 0."""
    writer = GltfWriter("mimics_app assets build orthosis")
    floor = writer.add_picture("linoleum", _paint_linoleum(seed))
    materials = {"floor": writer.add_material("clinic_floor", texture=floor, roughness=0.55)}
    for name, rgb in _UNLIT.items():
        materials[name] = writer.add_material(f"clinic_{name}", colour=(*rgb, 1.0), unlit=True)
    for name, (rgb, roughness) in _LIT.items():
        materials[name] = writer.add_material(f"clinic_{name}", colour=(*rgb, 1.0), roughness=roughness)
    for name, sketch in (("hall", _hall()), ("furniture", _furniture())):
        parts = [(writer.add_part(part), materials[material]) for material, part in sketch.parts().items()]
        writer.add_node(name, mesh=writer.add_mesh(name, parts))
    return writer.to_bytes()


def _paint_linoleum(seed: int) -> bytes:
    """Pale linoleum with flecks."""
    side = 256
    canvas = Canvas(side, side, [((118, 132, 138), (198, 208, 210)), ((104, 120, 128), (182, 194, 198))])
    x, y = pixels(side, side)
    fleck = smooth_noise(side, side, 96, 112, seed)
    canvas.ramp[:] = (fleck > 0.72).astype("uint8")
    canvas.tone = 0.62 + 0.16 * (smooth_noise(side, side, 20, 26, seed + 1) - 0.5) + 0.10 * hash_noise(x, y, seed + 2)
    return canvas.to_png()


def _hall() -> Sketch:
    """Floor, walls, ceiling, rail, windows and lamps."""
    sketch = Sketch()
    (x0, x1), (z0, z1) = _X, _Z
    wide, deep = x1 - x0, z1 - z0
    sketch.sheet("floor", (x0, 0.0, z1), (wide, 0.0, 0.0), (0.0, 0.0, -deep), (16, 14), 0.8, _shade)
    sketch.sheet("ceiling", (x0, _HIGH, z0), (wide, 0.0, 0.0), (0.0, 0.0, deep), (16, 14), 1.0, _lit_by_lamps)
    walls = (
        ((x0, z0), (wide, 0.0, 0.0)),
        ((x1, z0), (0.0, 0.0, deep)),
        ((x1, z1), (-wide, 0.0, 0.0)),
        ((x0, z1), (0.0, 0.0, -deep)),
    )
    for (x, z), along in walls:
        sketch.sheet("dado", (x, 0.0, z), along, (0.0, _RAIL, 0.0), (14, 6), 1.0, _shade)
        sketch.sheet("wall", (x, _RAIL, z), along, (0.0, _HIGH - _RAIL, 0.0), (14, 8), 1.0, _shade)
    for low, high, thick in ((_RAIL - 0.07, _RAIL + 0.07, 0.025), (0.0, 0.09, 0.012)):
        sketch.box("rail", (x0, low, z0), (x1, high, z0 + thick), hidden="nwe")
        sketch.box("rail", (x0, low, z1 - thick), (x1, high, z1), hidden="swe")
        sketch.box("rail", (x0, low, z0), (x0 + thick, high, z1), hidden="wns", shade=0.96)
        sketch.box("rail", (x1 - thick, low, z0), (x1, high, z1), hidden="ens", shade=0.92)
    for left, right in _WINDOWS:
        _add_window(sketch, left, right)
    for x, z in _LAMPS:
        sketch.box("frame", (x - 0.63, _HIGH - 0.035, z - 0.33), (x + 0.63, _HIGH, z + 0.33), hidden="u", under=1.0)
        sketch.box("lamp", (x - 0.58, _HIGH - 0.038, z - 0.28), (x + 0.58, _HIGH, z + 0.28), hidden="u", under=1.0)
    return sketch


def _shade(point: Point) -> float:
    """Return how much light a point of floor or wall receives: less in corners and below, more near windows."""
    x, y, z = point
    corner = min(max(x - _X[0], 0.0), max(_X[1] - x, 0.0)) + min(max(z - _Z[0], 0.0), max(_Z[1] - z, 0.0))
    dim = 1.0 - 0.22 * math.exp(-corner / 0.45)
    dim *= 1.0 - 0.16 * math.exp(-min(y, _HIGH - y) / 0.30) if 0.01 < y < _HIGH - 0.01 else 0.94
    return dim * (0.93 + 0.07 * math.exp(-abs(z - _Z[0]) / 2.0))


def _lit_by_lamps(point: Point) -> float:
    near = min(math.hypot(point[0] - x, point[2] - z) for x, z in _LAMPS)
    return 0.80 + 0.14 * math.exp(-near / 0.8)


def _add_window(sketch: Sketch, left: float, right: float) -> None:
    """Add a window with two wings, frosted below."""
    z, middle = _Z[0], 0.5 * (left + right)
    frost = _SILL + 0.40

    def bright(low: float, high: float, least: float) -> Callable[[Point], float]:
        return lambda point: least + (1.0 - least) * (high - point[1]) / (high - low)

    wide = (right - left, 0.0, 0.0)
    sketch.sheet(
        "glass", (left, frost, z + 0.01), wide, (0.0, _LINTEL - frost, 0.0), (1, 6), 1.0, bright(frost, _LINTEL, 0.78)
    )
    sketch.sheet(
        "frost", (left, _SILL, z + 0.01), wide, (0.0, frost - _SILL, 0.0), (1, 2), 1.0, bright(_SILL, frost, 0.94)
    )
    for x in (left, middle, right):
        half = 0.045 if x == middle else 0.035
        sketch.box("frame", (x - half, _SILL, z), (x + half, _LINTEL, z + 0.045), hidden="n", shade=0.97)
    for y in (_SILL, _LINTEL):
        sketch.box("frame", (left - 0.035, y - 0.035, z), (right + 0.035, y + 0.035, z + 0.045), hidden="n", under=0.8)
    sketch.box("frame", (left, frost - 0.012, z), (right, frost + 0.012, z + 0.03), hidden="n", under=0.85)
    sketch.box("rail", (left - 0.08, _SILL - 0.075, z), (right + 0.08, _SILL - 0.035, z + 0.16), hidden="n")


def _furniture() -> Sketch:
    """Wall bars, and a bench with a cushion."""
    sketch, wood, steel = Sketch(), Skin("wood"), Skin("steel")
    left, right = _BARS
    for x in (left, 0.5 * (left + right), right):
        sketch.box("wood", (x - 0.025, 0.02, _Z[0]), (x + 0.025, 2.40, _Z[0] + 0.11), hidden="n")
    for number in range(15):
        y = 0.16 + 0.155 * number
        axes = Axes((left, y, _Z[0] + 0.085), (0.0, 0.0, -1.0), (0.0, 1.0, 0.0), (1.0, 0.0, 0.0))
        add_prism(sketch, axes, circle(8, 0.018), 0.0, right - left, (wood, wood), (wood,))
    x, z = _BENCH
    sketch.box("cushion", (x - 0.95, 0.50, z - 0.29), (x + 0.95, 0.59, z + 0.29))
    sketch.box("cushion", (x + 0.55, 0.59, z - 0.24), (x + 0.92, 0.66, z + 0.24))
    sketch.box("steel", (x - 0.92, 0.44, z - 0.27), (x + 0.92, 0.50, z + 0.27))
    for dx in (-0.84, 0.84):
        for dz in (-0.22, 0.22):
            add_column(sketch, (x + dx, 0.0, z + dz), (x + dx, 0.45, z + dz), (0.024, 0.024), 10, steel)
    return sketch
