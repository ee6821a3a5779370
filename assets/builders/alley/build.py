"""The alley of the guided walk: two rows of houses along z, and at either end a small square with trees."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from pathlib import Path

from assets.builders.alley.front import HouseFront, build_front
from assets.builders.city.painted_materials import Painted, add_materials
from assets.builders.city.street_tree import TREES, build_tree
from assets.builders.kit.sketch import Point, Sketch
from assets.builders.kit.solids import Skin, add_column
from mimics_app.contracts.system.table_file import read_table_file
from mimics_app.world.files.gltf.writer import GltfWriter

__all__ = ["compose"]

_HALF = 1.55
"""Distance of the walls from the middle of the alley [m]."""
_END = 12.6
"""Where both rows begin, in z [m]; they continue towards -z."""
_SQUARE = 23.0
"""Distance of the fronts that close either square from the middle of the alley, along z [m]."""
_LAND = 13.0
"""Half the width of the paved land [m]."""

_SUNNY = (
    HouseFront("plaster1", 5.0, 2, 2, 1, "teal", True),
    HouseFront("brick0", 5.6, 2, 2, 0, "oak", False),
    HouseFront("plaster0", 5.2, 2, 2, 1, "navy", True),
    HouseFront("plaster2", 4.8, 2, 2, 0, "wine", True),
    HouseFront("brick1", 5.0, 2, 2, 1, "teal", False),
)
"""Houses on the side of -x, from +z on."""
_SHADED = (
    HouseFront("plaster2", 5.4, 1, 2, 1, "navy", True),
    HouseFront("plaster0", 4.8, 1, 2, 0, "wine", True),
    HouseFront("brick1", 5.6, 1, 2, 1, "oak", False),
    HouseFront("plaster1", 4.8, 1, 2, 0, "teal", True),
    HouseFront("brick0", 5.0, 1, 2, 1, "navy", False),
)
"""Houses on the side of +x: one floor each, so that the sun reaches the paving."""
_CLOSING = (
    HouseFront("plaster1", 6.4, 2, 2, 1, "teal", True),
    HouseFront("brick0", 6.8, 3, 3, 0, "oak", False),
    HouseFront("plaster2", 6.0, 2, 2, 1, "navy", True),
)
"""Houses beyond each square, from -x to +x seen from the alley."""
_TREES = ((-4.6, -17.5), (4.4, -19.0), (-4.2, 18.5), (4.8, 17.0))
"""Places of the trees in the squares (x, z) [m]."""
_TUBS = ((-1.24, -3.75), (1.24, 1.35), (-1.24, 5.6), (1.24, -5.5), (1.24, 8.9))
"""Places of the tubs (x, z) [m], out of the way of the walk."""

_SHRUB = ((0.40, 0.08), (0.46, 0.18), (0.56, 0.25), (0.68, 0.275), (0.80, 0.25), (0.90, 0.18), (0.97, 0.07))
"""Outline of a clipped shrub: heights and radii [m]."""
_COVERAGE = (0.1, 0.0)
"""Smallest shares of the picture's area of a house's fine and coarse form."""
_PAVING = 1.8
"""Metres one repetition of the paving covers."""

_MATERIALS = Path(__file__).with_name("materials.json")


def compose(seed: int) -> dict[str, bytes]:
    """Return all files by name.

    Args:
        seed: Of textures and trees.
    """
    writer = GltfWriter("mimics_app assets build alley")
    materials = add_materials(writer, seed, read_table_file(_MATERIALS, dict[str, Painted]), "alley_")
    meshes: dict[HouseFront, tuple[int, int]] = {}

    def mesh(name: str, sketch: Sketch) -> int:
        parts = [(writer.add_part(part), materials[material]) for material, part in sketch.parts().items()]
        return writer.add_mesh(name, parts)

    for name, sketch in (("ground", _ground()), ("tubs", _tubs())):
        writer.add_node(name, mesh=mesh(name, sketch))
    for number, (house, place, turn) in enumerate(_lay_houses()):
        if house not in meshes:
            name = f"house{len(meshes)}"
            coarse = mesh(f"{name}/coarse", build_front(house, fine=False))
            meshes[house] = mesh(name, build_front(house)), coarse
        rotation = (0.0, math.sin(0.5 * turn), 0.0, math.cos(0.5 * turn))
        fine, coarse = meshes[house]
        node = writer.add_node(f"house_{number}", mesh=fine, translation=place, rotation=rotation)
        writer.add_detail_levels(node, [coarse], _COVERAGE)
    for number, (x, z) in enumerate(_TREES):
        tree = mesh(f"tree{number}", build_tree(TREES[number % len(TREES)], seed + number))
        writer.add_node(f"tree_{number}", mesh=tree, translation=(x, 0.0, z))
    return {"alley.glb": writer.to_bytes()}


def _lay_houses() -> Iterator[tuple[HouseFront, Point, float]]:
    """Houses with their places and turns about y [rad]: both rows, then the squares' far sides."""
    for row, side in ((_SUNNY, -1.0), (_SHADED, 1.0)):
        z = _END
        for house in row:
            yield house, (side * _HALF, 0.0, round(z - 0.5 * house.width, 3)), -side * 0.5 * math.pi
            z -= house.width
    for side in (-1.0, 1.0):
        x = -0.5 * sum(house.width for house in _CLOSING)
        for house in _CLOSING:
            yield house, (round(-side * (x + 0.5 * house.width), 3), 0.0, side * _SQUARE), 0.5 * math.pi * (1.0 + side)
            x += house.width


def _ground() -> Sketch:
    """Paving, darker along the walls."""
    sketch = Sketch()
    per_metre = 1.0 / _PAVING

    def gutter(point: Point) -> float:
        return 1.0 - 0.4 * math.exp(-max(_HALF - abs(point[0]), 0.0) / 0.12)

    def open_sky(_: Point) -> float:
        return 1.0

    back = (0.0, 0.0, -2.0 * _END)
    sketch.sheet("paving", (-_HALF, 0.0, _END), (2.0 * _HALF, 0.0, 0.0), back, (10, 24), per_metre, gutter)
    for z in (_SQUARE, -_END):
        depth = (0.0, 0.0, _END - _SQUARE)
        sketch.sheet("paving", (-_LAND, 0.0, z), (2.0 * _LAND, 0.0, 0.0), depth, (1, 1), per_metre, open_sky)
    return sketch


def _tubs() -> Sketch:
    """Clay tubs with clipped shrubs."""
    sketch = Sketch()
    clay, earth, shrub = Skin("clay"), Skin("earth"), Skin("shrub")
    for x, z in _TUBS:
        add_column(sketch, (x, 0.0, z), (x, 0.36, z), (0.15, 0.2), 16, clay, open_foot=True)
        add_column(sketch, (x, 0.36, z), (x, 0.41, z), (0.22, 0.22), 16, clay)
        add_column(sketch, (x, 0.405, z), (x, 0.42, z), (0.19, 0.19), 16, earth, open_foot=True)
        for (low, inner), (high, outer) in itertools.pairwise(_SHRUB):
            add_column(sketch, (x, low, z), (x, high, z), (inner, outer), 16, shrub, open_foot=True)
    return sketch
