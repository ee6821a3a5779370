"""The ground: carriageways with markings, crossings, kerbs, sidewalks, lawns."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

from assets.builders.city.fittings import plain
from assets.builders.city.textures import LANE_HALF, TILE
from assets.builders.kit.sketch import Point, Sketch, Uv

__all__ = [
    "FRONT",
    "KERB_HEIGHT",
    "SIDE",
    "STREETS_X",
    "STREETS_Z",
    "Block",
    "build_block",
    "build_roads",
    "city_blocks",
    "square_middle",
]

SIDE = 800.0
"""Length and width of the city [m]: 0.64 km^2."""

STREETS_X = (-240.0, 0.0, 240.0)
"""Middles of the streets along z [m]."""
STREETS_Z = (-200.0, 0.0, 200.0)
"""Middles of the streets along x [m]."""

FRONT = 11.0
"""Distance of the fronts of houses from the middle of their street [m]."""
KERB_HEIGHT = 0.12
_ROUND = 4.0
"""Radius of kerbs at corners [m]."""
_ZEBRA = 4.0
"""Width of a crossing for people, along the street [m]."""
_ARC = 5


@dataclass(frozen=True)
class Block:
    """Land between streets.

    Attributes:
        left, right: Kerb lines, or the city's border, along x [m].
        near, far: The same along z, near > far [m].
        streets: Sides that have a street: of "w", "e", "s" (+z), "n" (-z).
    """

    left: float
    right: float
    near: float
    far: float
    streets: str

    @property
    def plot(self) -> tuple[float, float, float, float]:
        """Left, right, near, far of what the fronts of the houses enclose [m]."""
        walk = FRONT - LANE_HALF
        inset = {side: walk if side in self.streets else 0.0 for side in "wesn"}
        return self.left + inset["w"], self.right - inset["e"], self.near - inset["s"], self.far + inset["n"]


def city_blocks() -> list[Block]:
    """All blocks, row by row."""
    blocks = []
    for far, near, north, south in _gaps(STREETS_Z):
        for left, right, west, east in _gaps(STREETS_X):
            streets = "".join(side for side, there in zip("wesn", (west, east, south, north), strict=True) if there)
            blocks.append(Block(left, right, near, far, streets))
    return blocks


def _gaps(streets: tuple[float, ...]) -> list[tuple[float, float, bool, bool]]:
    """(low, high, street at low, street at high) between streets and borders."""
    gaps = _between(streets, LANE_HALF)
    return [(low, high, place > 0, place < len(streets)) for place, (low, high) in enumerate(gaps)]


def build_block(block: Block, *, square: bool = False) -> Sketch:
    """Kerb, sidewalk and gardens of a block, or the lawns and paths of the square."""
    sketch = Sketch()
    outer, inner = _loops(block)
    count = len(outer)
    stone, paving = plain("stone", 0.8), TILE["paving"]
    for number in range(count):
        following = (number + 1) % count
        (a, street), (b, _) = outer[number], outer[following]
        c, d = inner[following], inner[number]
        if a == b or not street:
            continue
        face = [(a[0], 0.0, a[1]), (b[0], 0.0, b[1]), (b[0], KERB_HEIGHT, b[1]), (a[0], KERB_HEIGHT, a[1])]
        sketch.fan(stone.material, face, stone.lay([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]), 0.7)
        flat = [a, b, c, d] if c != d else [a, b, c]
        points: list[Point] = [(x, KERB_HEIGHT, z) for x, z in flat]
        uvs = [(x / paving[0], z / paving[1]) for x, z in flat]
        # Sidewalks grow darker towards the walls, which hide half of the sky.
        sketch.fan("paving", points, uvs, [1.0, 1.0, 0.72, 0.72][: len(flat)])
    if square:
        _add_square(sketch, block)
    else:
        left, right, near, far = block.plot
        _add_floor(sketch, "gardens", (left, right), (near, far), 0.9)
    return sketch


def _add_floor(sketch: Sketch, material: str, across: Uv, along: Uv, shade: float) -> None:
    """A level rectangle at the height of the sidewalks, from `along[0]` in the south to `along[1]`."""
    corners = [(across[0], along[0]), (across[1], along[0]), (across[1], along[1]), (across[0], along[1])]
    wide, high = TILE[material]
    uvs = [(x / wide, z / high) for x, z in corners]
    sketch.fan(material, [(x, KERB_HEIGHT, z) for x, z in corners], uvs, shade)


def _add_square(sketch: Sketch, block: Block) -> None:
    """Lawns parted by paved paths, and a paved place about the church."""
    left, right, near, far = block.plot
    x, z = square_middle(block)
    columns = (left, x - 32.0, x - 7.0, x - 1.0, x + 32.0, right)
    rows = (near, z + 17.0, z + 3.0, z - 3.0, z - 17.0, far)
    for i in range(5):
        for j in range(5):
            paved = i == 2 or j == 2 or (i in (1, 3) and j in (1, 3))
            _add_floor(
                sketch, "paving" if paved else "grass", (columns[i], columns[i + 1]), (rows[j], rows[j + 1]), 0.95
            )


def square_middle(block: Block) -> Uv:
    """Where the church's place has its middle, along x and z [m]."""
    left, right, near, far = block.plot
    return 0.5 * (left + right) + 6.0, 0.5 * (near + far)


def _loops(block: Block) -> tuple[list[tuple[Uv, bool]], list[Uv]]:
    """Kerb line, each corner with whether the edge after it lies at a street; and the fronts' line, corner by corner.

    Counter-clockwise seen from above, from the south-west corner.
    """
    left, right, near, far = block.plot
    rows: list[tuple[Uv, bool]] = []
    inner: list[Uv] = []
    corners = (
        ("w", "s", (block.left, block.near), (1.0, -1.0), (left, near), math.pi),
        ("s", "e", (block.right, block.near), (-1.0, -1.0), (right, near), 1.5 * math.pi),
        ("e", "n", (block.right, block.far), (-1.0, 1.0), (right, far), 0.0),
        ("n", "w", (block.left, block.far), (1.0, 1.0), (left, far), 0.5 * math.pi),
    )
    for before, after, corner, inward, front, start in corners:
        street = after in block.streets
        if before in block.streets and street:
            centre = (corner[0] + _ROUND * inward[0], corner[1] + _ROUND * inward[1])
            for step in range(_ARC):
                turn = start + 0.5 * math.pi * step / (_ARC - 1)
                rows.append(((centre[0] + _ROUND * math.cos(turn), centre[1] - _ROUND * math.sin(turn)), True))
                inner.append(front)
        else:
            rows.append((corner, street))
            inner.append(front)
    return rows, inner


def build_roads() -> Sketch:
    """All carriageways: plain crossings, stripes for people before them, and the way between."""
    sketch = Sketch()
    for x in STREETS_X:
        for z in STREETS_Z:
            _add_crossing(sketch, x, z)
        for low, high in _between(STREETS_Z, LANE_HALF + _ROUND):
            _add_run(sketch, low, high, partial(_along_z, x))
    for z in STREETS_Z:
        for low, high in _between(STREETS_X, LANE_HALF + _ROUND):
            _add_run(sketch, low, high, partial(_along_x, z))
    return sketch


def _along_z(street: float, across: float, along: float) -> Point:
    return street + across, 0.0, along


def _along_x(street: float, across: float, along: float) -> Point:
    return along, 0.0, street - across


def _between(streets: tuple[float, ...], reach: float) -> list[tuple[float, float]]:
    """(low, high) between borders and streets that reach so far from their middles [m]."""
    lows = [-0.5 * SIDE, *(middle + reach for middle in streets)]
    highs = [*(middle - reach for middle in streets), 0.5 * SIDE]
    return list(zip(lows, highs, strict=True))


def _add_crossing(sketch: Sketch, x: float, z: float) -> None:
    """Plain asphalt where two streets meet; its corners lie under the sidewalks."""
    reach = LANE_HALF + _ROUND
    corners = [(x - reach, z + reach), (x + reach, z + reach), (x + reach, z - reach), (x - reach, z - reach)]
    tile = TILE["asphalt"]
    sketch.fan("asphalt", [(a, 0.0, b) for a, b in corners], [(a / tile[0], b / tile[1]) for a, b in corners])


def _add_run(sketch: Sketch, low: float, high: float, place: Callable[[float, float], Point]) -> None:
    """A carriageway from `low` to `high` along its street, with stripes where it meets a crossing."""
    first = low + (_ZEBRA if low > -0.5 * SIDE else 0.0)
    last = high - (_ZEBRA if high < 0.5 * SIDE else 0.0)
    pieces = [("road", first, last, TILE["road"][1])]
    pieces += [("zebra", begin, end, _ZEBRA) for begin, end in ((low, first), (last, high)) if end > begin]
    for material, begin, end, length in pieces:
        corners = [(-LANE_HALF, end), (LANE_HALF, end), (LANE_HALF, begin), (-LANE_HALF, begin)]
        uvs = [(0.5 + 0.5 * across / LANE_HALF, (along - begin) / length) for across, along in corners]
        sketch.fan(material, [place(*corner) for corner in corners], uvs)
