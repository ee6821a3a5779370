"""Street trees: a trunk with limbs and a crown of leaf tufts that face outwards."""

from __future__ import annotations

import math
from dataclasses import dataclass

from assets.builders.city.textures import TILE
from assets.builders.kit.rng import Rng
from assets.builders.kit.sketch import Point, Sketch
from assets.builders.kit.solids import Skin, add_column
from mimics_app.maths.triples import cross

__all__ = ["TREES", "TreeKind", "build_coarse_tree", "build_tree"]

_GOLDEN_TURN = math.pi * (3.0 - math.sqrt(5.0))


@dataclass(frozen=True)
class TreeKind:
    """Lengths [m].

    Attributes:
        name: Its meshes' name.
        trunk: Height of the lowest leaves.
        wide, high: Half axes of the crown.
        tuft: Side of a leaf card.
        narrow: How much narrower the crown is above than below, 0 to 1.
    """

    name: str
    trunk: float
    wide: float
    high: float
    tuft: float
    narrow: float


TREES = (
    TreeKind("lime", 2.4, 2.5, 3.7, 1.75, 0.45),
    TreeKind("maple", 2.2, 3.0, 3.0, 1.85, 0.25),
    TreeKind("plane", 2.9, 3.3, 3.5, 2.0, 0.1),
)
_OUTER, _INNER, _COARSE = 60, 18, 24
_ASKEW = 0.24
"""Largest tilt of a card against the crown's surface: an edge-on card is in front of others, not beside them."""
_HUG = (0.15, 0.55)
"""Bend of two opposite corners of a card towards the crown, and of the other two, in halves of its side."""


def build_tree(kind: TreeKind, seed: int) -> Sketch:
    """The tree, standing on y = 0 at the origin."""
    sketch = Sketch()
    rng = Rng(seed, kind.name)
    bark = Skin("bark", TILE["bark"])
    fork = (rng.between(-0.15, 0.15), kind.trunk + 0.3, rng.between(-0.15, 0.15))
    add_column(sketch, (0.0, -0.05, 0.0), fork, (0.19, 0.13), 6, bark, open_foot=True)
    for number in range(3):
        turn = 2.0 * math.pi * (number + rng.share()) / 3.0
        tip = (
            fork[0] + 0.55 * kind.wide * math.cos(turn),
            fork[1] + 0.8 * kind.high,
            fork[2] + 0.55 * kind.wide * math.sin(turn),
        )
        add_column(sketch, fork, tip, (0.10, 0.0), 4, bark, open_foot=True)
    _add_tufts(sketch, kind, rng, _INNER, 0.62, 1.15)
    _add_tufts(sketch, kind, rng, _OUTER, 1.0, 1.0)
    return sketch


def build_coarse_tree(kind: TreeKind, seed: int) -> Sketch:
    """The same outline out of fewer, larger tufts."""
    sketch = Sketch()
    rng = Rng(seed, kind.name)
    add_column(
        sketch,
        (0.0, -0.05, 0.0),
        (0.0, kind.trunk + 1.0, 0.0),
        (0.19, 0.1),
        4,
        Skin("bark", TILE["bark"]),
        open_foot=True,
    )
    _add_tufts(sketch, kind, rng, _COARSE, 0.86, 1.75)
    return sketch


def _add_tufts(sketch: Sketch, kind: TreeKind, rng: Rng, count: int, reach: float, size: float) -> None:
    """Cards spread evenly over the crown (a Fibonacci sphere), each a little out of place and askew."""
    centre = kind.trunk + kind.high
    for number in range(count):
        y = 1.0 - 1.86 * (number + 0.5) / count  # the underside stays open round the trunk
        ring = math.sqrt(max(0.0, 1.0 - y * y))
        turn = number * _GOLDEN_TURN
        x, z = ring * math.cos(turn), ring * math.sin(turn)
        slim = 1.0 - kind.narrow * max(0.0, y)
        out = reach * rng.between(0.86, 1.02)
        place = (x * kind.wide * slim * out, centre + y * kind.high * out, z * kind.wide * slim * out)
        normal = _unit((x / kind.wide, y / kind.high, z / kind.wide))
        askew = _unit(
            (
                normal[0] + rng.between(-_ASKEW, _ASKEW),
                normal[1] + rng.between(-_ASKEW, _ASKEW),
                normal[2] + rng.between(-_ASKEW, _ASKEW),
            )
        )
        side = kind.tuft * size * rng.between(0.85, 1.15)
        light = (0.56 + 0.44 * (0.5 + 0.5 * y)) * (0.66 if reach < 0.7 else 1.0)
        _add_card(sketch, place, askew, normal, side, light, rng.below(4))


def _add_card(sketch: Sketch, place: Point, facing: Point, normal: Point, side: float, light: float, roll: int) -> None:
    """A square that looks along `facing` and is lit as the crown's surface there, darker towards its lower edge.

    It is folded along a diagonal and hugs the crown, so that at its outline no card stands off as a plate.
    """
    helper = (0.0, 1.0, 0.0) if abs(facing[1]) < 0.8 else (1.0, 0.0, 0.0)
    right = _unit(cross(helper, facing))
    up = cross(facing, right)
    half = 0.5 * side
    corners = [
        (
            place[0] + half * (s * right[0] + t * up[0] - hug * facing[0]),
            place[1] + half * (s * right[1] + t * up[1] - hug * facing[1]),
            place[2] + half * (s * right[2] + t * up[2] - hug * facing[2]),
        )
        for s, t, hug in ((-1, -1, _HUG[0]), (1, -1, _HUG[1]), (1, 1, _HUG[0]), (-1, 1, _HUG[1]))
    ]
    uvs = [(0.0, 1.0), (1.0, 1.0), (1.0, 0.0), (0.0, 0.0)]
    uvs = uvs[roll:] + uvs[:roll]
    lifted = _unit((normal[0], normal[1] + 0.55, normal[2]))
    shades = [0.8 * light, 0.8 * light, light, light]
    sketch.fan("leaves", corners, uvs, shades, [lifted] * 4)


def _unit(v: Point) -> Point:
    length = math.sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])
    return v[0] / length, v[1] / length, v[2] / length
