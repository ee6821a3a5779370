"""Layout of the city: rows of houses around the blocks, trees, lamps, furniture, cars, the square."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from assets.builders.city.house_kinds import HouseKind
from assets.builders.city.streets import (
    FRONT,
    KERB_HEIGHT,
    SIDE,
    STREETS_X,
    STREETS_Z,
    Block,
    city_blocks,
    square_middle,
)
from assets.builders.kit.rng import Rng

__all__ = [
    "Placed",
    "lay_cars",
    "lay_furniture",
    "lay_houses",
    "lay_square",
    "lay_street_trees",
    "lay_yards",
    "square_block",
]

_TREE_STEP = 40.0
"""Distance of trees along a sidewalk [m]."""
_TREE_LINE, _LAMP_LINE, _CAR_LINE = 7.0, 6.35, 4.6
"""Distance from the middle of a street [m]."""
_HALF = math.sqrt(0.5)
_TURNS: dict[str, tuple[float, float]] = {"s": (0.0, 1.0), "e": (_HALF, _HALF), "n": (1.0, 0.0), "w": (-_HALF, _HALF)}
"""Half-angle sine and cosine about +y that turn +z to that side of the world (s: +z, e: +x)."""


@dataclass(frozen=True)
class Placed:
    """An instance of a model.

    Attributes:
        model: Name of the model.
        place: Position [m].
        turn: Sine and cosine of half its angle about +y.
        scale: Factors along its own axes.
    """

    model: str
    place: tuple[float, float, float]
    turn: tuple[float, float] = (0.0, 1.0)
    scale: tuple[float, float, float] = (1.0, 1.0, 1.0)


def square_block(blocks: Sequence[Block]) -> Block:
    """The block that is a square: it lies north-east of the middle crossing."""
    return next(block for block in blocks if block.left > 0 > block.near and set(block.streets) == set("wesn"))


def lay_houses(kinds: Sequence[HouseKind], colours: int, rng: Rng) -> list[Placed]:
    """Rows that close every block but the square to its streets; models are named "kind/colour"."""
    blocks = city_blocks()
    square = square_block(blocks)
    placed: list[Placed] = []
    for block in blocks:
        if block != square:
            for side in block.streets:
                placed += _row(block, side, kinds, colours, rng)
    return placed


def _row(block: Block, side: str, kinds: Sequence[HouseKind], colours: int, rng: Rng) -> list[Placed]:
    """One row, seen from the street from left to right; rows along x leave the corners to those along z."""
    left, right, near, far = block.plot
    depth = kinds[0].depth
    ends = {
        "e": (near, far, "s", "n"),
        "w": (far, near, "n", "s"),
        "s": (left, right, "w", "e"),
        "n": (right, left, "e", "w"),
    }
    begin, end, at_begin, at_end = ends[side]
    sign = 1.0 if end > begin else -1.0
    corner_left = corner_right = False
    if side in "ew":
        corner_left, corner_right = at_begin in block.streets, at_end in block.streets
    else:
        begin += sign * depth if at_begin in block.streets else 0.0
        end -= sign * depth if at_end in block.streets else 0.0
    chosen = _fill(abs(end - begin), kinds, (corner_left, corner_right), rng)
    stretch = abs(end - begin) / sum(kind.width for kind in chosen)
    line = {"e": right, "w": left, "s": near, "n": far}[side]
    placed, at, before = [], begin, -1
    for kind in chosen:
        width = kind.width * stretch
        middle = round(at + sign * 0.5 * width, 4)
        at += sign * width
        colour = rng.below(colours)
        if colour == before:
            colour = (colour + 1) % colours
        before = colour
        where = (line, KERB_HEIGHT, middle) if side in "ew" else (middle, KERB_HEIGHT, line)
        placed.append(Placed(f"{kind.name}/{colour}", where, _TURNS[side], (round(stretch, 5), 1.0, 1.0)))
    return placed


def _fill(length: float, kinds: Sequence[HouseKind], corners: tuple[bool, bool], rng: Rng) -> list[HouseKind]:
    """Kinds whose widths come close to the length: small ones stand in groups, great ones alone."""
    ends = [[kind for kind in kinds if kind.corner == side] for side in ("left", "right")]
    row_kinds = [kind for kind in kinds if not kind.corner]
    style = rng.below(len(ends[0]))
    first = [ends[0][style]] if corners[0] else []
    last = [ends[1][rng.below(len(ends[1]))]] if corners[1] else []
    chosen: list[HouseKind] = []
    room = length - sum(kind.width for kind in (*first, *last))
    while room > 0.0:
        options = [kind for kind in row_kinds if kind not in chosen[-2:]]
        kind = rng.pick(options)
        if kind.width > room:
            kind = min(options, key=lambda each: abs(each.width - room))
            if kind.width - room > 0.5 * kind.width:
                break
        chosen.append(kind)
        room -= kind.width
        if kind.floors == 1 and room > kind.width and rng.happens(0.6):  # single-storey houses come in pairs
            chosen.append(kind)
            room -= kind.width
    return [*first, *chosen, *last]


def _streets() -> Iterator[tuple[float, bool, tuple[float, ...]]]:
    """Middle of each street, whether it runs along z, and where others cross it [m]."""
    for x in STREETS_X:
        yield x, True, STREETS_Z
    for z in STREETS_Z:
        yield z, False, STREETS_X


def _at(street: float, along_z: bool, across: float, along: float, height: float) -> tuple[float, float, float]:
    point = (street + across, height, along) if along_z else (along, height, street - across)
    return round(point[0], 3), round(point[1], 3), round(point[2], 3)


def _facing(along_z: bool, across: float) -> tuple[float, float]:
    """The turn by which +z looks to the middle of the street."""
    if along_z:
        return _TURNS["w" if across > 0 else "e"]
    return _TURNS["s" if across > 0 else "n"]


def lay_street_trees(names: Sequence[str], rng: Rng) -> list[Placed]:
    """One every 40 m on both sidewalks of every street; each street has its own kind."""
    placed = []
    for number, (street, along_z, _) in enumerate(_streets()):
        name = names[number % len(names)]
        for across in (-_TREE_LINE, _TREE_LINE):
            for step in range(int(SIDE / _TREE_STEP)):
                along = -0.5 * SIDE + _TREE_STEP * (step + 0.5)
                tall, wide = rng.between(0.88, 1.14), rng.between(0.9, 1.08)
                placed.append(
                    Placed(name, _at(street, along_z, across, along, KERB_HEIGHT), _any_turn(rng), (wide, tall, wide))
                )
    return placed


def _any_turn(rng: Rng) -> tuple[float, float]:
    half = math.pi * rng.share()
    return round(math.sin(half), 6), round(math.cos(half), 6)


def lay_furniture(rng: Rng) -> list[Placed]:
    """Lamps between the trees, benches and bins beside some, signs and bollards at crossings, tubs before fronts."""
    placed = []
    for street, along_z, crossings in _streets():
        for across in (-_LAMP_LINE, _LAMP_LINE):
            side = 1.0 if across > 0 else -1.0
            look = _facing(along_z, across)
            for step in range(1, int(SIDE / _TREE_STEP)):
                along = -0.5 * SIDE + _TREE_STEP * step
                if along in crossings:
                    continue
                placed.append(Placed("lamp", _at(street, along_z, across, along, KERB_HEIGHT), look))
                near_tree = along + 0.5 * _TREE_STEP
                if near_tree < 0.5 * SIDE:
                    placed += _beside_tree(street, along_z, side, near_tree, rng)
            for crossing in crossings:
                placed += _corner(street, along_z, side, crossing)
    return placed


def _beside_tree(street: float, along_z: bool, side: float, along: float, rng: Rng) -> list[Placed]:
    placed = []
    look = _facing(along_z, side)
    away = _facing(along_z, -side)
    if rng.happens(0.3):
        placed.append(Placed("bench", _at(street, along_z, side * 7.3, along + 2.2, KERB_HEIGHT), away))
        placed.append(Placed("bin", _at(street, along_z, side * 7.0, along + 3.8, KERB_HEIGHT)))
    if rng.happens(0.28):
        spots = [_at(street, along_z, side * (FRONT - 0.75), along + shift, KERB_HEIGHT) for shift in (-3.0, -5.4)]
        placed += [Placed("planter", spot, look) for spot in spots]
    return placed


def _corner(street: float, along_z: bool, side: float, crossing: float) -> list[Placed]:
    """A sign before each crossing on the right-hand side, bollards on its corners."""
    placed = []
    for ahead in (-1.0, 1.0):
        spots = [_at(street, along_z, side * 6.1, crossing + ahead * reach, KERB_HEIGHT) for reach in (9.9, 11.4)]
        placed += [Placed("bollard", spot) for spot in spots]
        if side * ahead > 0:
            look = ("s" if ahead > 0 else "n") if along_z else ("e" if ahead > 0 else "w")
            placed.append(
                Placed("sign", _at(street, along_z, side * 6.3, crossing + ahead * 15.4, KERB_HEIGHT), _TURNS[look])
            )
    return placed


def lay_cars(names: Sequence[str], rng: Rng) -> list[Placed]:
    """Every place of the parking lanes that may be taken, in an order that spreads any number of them evenly."""
    places = []
    for street, along_z, crossings in _streets():
        for across in (-_CAR_LINE, _CAR_LINE):
            along = -0.5 * SIDE + 6.0
            while along < 0.5 * SIDE - 5.0:
                if all(abs(along - crossing) > 19.0 for crossing in crossings):
                    places.append((street, along_z, across, round(along + rng.between(-0.3, 0.3), 3)))
                along += 6.1
    rows = []
    for street, along_z, across, along in places:
        # Cars drive on the right: where z grows to the south, the eastern lane leads north.
        forward = ("n" if across > 0 else "s") if along_z else ("e" if across > 0 else "w")
        turned = {"e": (0.0, 1.0), "n": (_HALF, _HALF), "w": (1.0, 0.0), "s": (-_HALF, _HALF)}[forward]
        rows.append((rng.share(), Placed(rng.pick(names), _at(street, along_z, across, along, 0.0), turned)))
    return [car for _, car in sorted(rows, key=lambda row: row[0])]


def lay_square(names: Sequence[str], rng: Rng) -> list[Placed]:
    """The church with its door to the west, trees in rows and along the paths, benches and tubs."""
    block = square_block(city_blocks())
    left, right, near, far = block.plot
    x, z = square_middle(block)
    placed = [Placed("church", (x - 17.0, KERB_HEIGHT, z), _TURNS["w"])]
    spots = [
        (at, row) for row in (near - 6.0, near - 19.0, far + 6.0, far + 19.0) for at in _steps(left + 8.0, right - 6.0)
    ]
    spots += [
        (at, z + side)
        for side in (-7.0, 7.0)
        for at in (*_steps(left + 12.0, x - 36.0), *_steps(x + 40.0, right - 6.0))
    ]
    for at, row in spots:
        if not x - 11.0 < at < x + 3.0:  # the path to the south and north stays free
            place = (round(at + rng.between(-0.8, 0.8), 3), KERB_HEIGHT, round(row + rng.between(-0.8, 0.8), 3))
            size = rng.between(0.85, 1.2)
            placed.append(Placed(rng.pick(names), place, _any_turn(rng), (size, size, size)))
    for side, look in ((-4.2, "s"), (4.2, "n")):
        benches = [(at + 6.5, KERB_HEIGHT, round(z + side, 3)) for at in _steps(left + 12.0, x - 40.0)]
        placed += [Placed("bench", spot, _TURNS[look]) for spot in benches]
    corners = [(x + dx, KERB_HEIGHT, round(z + dz, 3)) for dx in (-31.0, -8.5, 0.5, 31.0) for dz in (-16.0, 16.0)]
    return placed + [Placed("planter", spot) for spot in corners]


def _steps(first: float, last: float) -> list[float]:
    """Places 15 m apart."""
    return [round(first + 15.0 * step, 3) for step in range(max(0, int((last - first) / 15.0) + 1))]


def lay_yards(names: Sequence[str], rng: Rng) -> list[Placed]:
    """Workshops and trees behind the rows of houses."""
    blocks = city_blocks()
    placed = []
    for block in blocks:
        if block == square_block(blocks):
            continue
        left, right, near, far = block.plot
        for _ in range(3):
            x, z = rng.between(left + 30.0, right - 30.0), rng.between(far + 30.0, near - 30.0)
            placed.append(Placed("workshop", (x, KERB_HEIGHT, z), _TURNS[rng.pick("sewn")]))
        for _ in range(9):
            x, z = rng.between(left + 18.0, right - 18.0), rng.between(far + 18.0, near - 18.0)
            size = rng.between(0.7, 1.15)
            placed.append(Placed(f"{rng.pick(names)}/coarse", (x, KERB_HEIGHT, z), _any_turn(rng), (size, size, size)))
    return placed
