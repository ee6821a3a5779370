"""The five rooms of the examples with their tables, a hall, surfaces to stroke, a spring, a magnet, an arrow."""

from __future__ import annotations

import math
from collections.abc import Callable

from assets.builders.kit.sketch import Point, Sketch
from assets.builders.market.sculpt import pack_model
from assets.builders.room import force_models, furnished, furnished_home, textures
from mimics_app.world.files.gltf.writer import GltfWriter

__all__ = ["compose"]

_TABLE = ((-0.80, 0.80), (-0.60, 0.56))
"""The table's top in x and z; its upper side is y = 0 [m]."""
_THICK, _FLOOR = 0.036, -0.74
"""Thickness of the table's top; height of the floor below it [m]."""
_WALL, _SIDE, _FRONT, _HIGH = -1.9, 2.4, 2.4, 1.9
"""Back wall in z, side walls in x, the room's open side in z, and the walls' upper edge [m]."""
_RAIL = 0.16
"""Height at which the panels end [m]."""

_COLOURS = {
    "plaster": (0.66, 0.63, 0.57, 1.0),
    "panel": (0.235, 0.300, 0.255, 1.0),
    "groove": (0.150, 0.195, 0.165, 1.0),
    "rail": (0.72, 0.70, 0.64, 1.0),
}
"""Colours of surfaces without a texture: on software renderers a texture of the walls costs a tenth of the frame."""
_BENCH, _PALE, _BIRCH = (0.50, 0.36, 0.26, 1.0), (0.60, 0.56, 0.49, 1.0), (1.0, 0.98, 0.92, 1.0)
"""Colours of the workshop's table, on its texture, of the conservatory's, and of the playroom's, on its texture."""
_BOARD, _GROOVE = 0.14, 0.006
"""Width of a panel's board, and of the groove beside it [m]."""


def compose(seed: int) -> dict[str, bytes]:
    """Return all files by name.

    Args:
        seed: Of grain and marks.
    """
    return {
        "room.glb": _room(seed),
        "ice.png": textures.paint_ice(seed),
        "rubber.png": textures.paint_rubber(seed),
        "ripples.png": textures.paint_ripples(seed),
        "cushion.png": textures.paint_cushion(seed),
        "oak.png": textures.paint_oak(seed),
        "grain.png": textures.paint_grain(seed),
        "spring.glb": pack_model(
            "spring", {"coil": (force_models.spring(), 0.35), "foot": (force_models.spring_foot(), 0.5)}
        ),
        "magnet.glb": pack_model(
            "magnet", {"bow": (force_models.magnet(), 0.35), "tips": (force_models.magnet_tips(), 0.3)}
        ),
        "cube.glb": pack_model("cube", {"cube": (force_models.rounded_cube(), 0.3)}),
        "arrow.glb": pack_model("arrow", {"arrow": (force_models.arrow(), 0.6)}),
    }


def _room(seed: int) -> bytes:
    """Rooms as nodes `room`, `workshop`, `conservatory`, `kitchen`, `playroom`, and their tables.

    The floor of `waiting_room` and `hall` is y = 0.
    Walls and the rooms' floors receive no shadows: their light is baked into vertex colours, which halves the frame.
    The table and the hall's floor are lit, and matt.
    """
    writer = GltfWriter("mimics_app assets build room")
    pictures = {name: writer.add_picture(name, png) for name, png in _painted(seed).items()}
    materials = {
        "oak": writer.add_material("room_oak", texture=pictures["oak"]),
        "stage": writer.add_material("room_stage", texture=pictures["boards"]),
        "boards": writer.add_material("room_boards", texture=pictures["boards"], unlit=True),
    }
    materials["bench"] = writer.add_material("room_bench", texture=pictures["oak"], colour=_BENCH, roughness=0.8)
    materials["birch"] = writer.add_material("room_birch", texture=pictures["oak"], colour=_BIRCH, roughness=0.7)
    materials["pale"] = writer.add_material("room_pale", colour=_PALE, roughness=0.6)
    for name, colour in (_COLOURS | furnished.COLOURS).items():
        materials[name] = writer.add_material(f"room_{name}", colour=colour, unlit=True)
    study, workshop, conservatory, waiting = _walls(_FLOOR), Sketch(), Sketch(), Sketch()
    kitchen, playroom = Sketch(), Sketch()
    furnished.waiting_room(waiting, seed)
    furnished.study(study, seed)
    furnished.workshop(workshop, seed)
    furnished.conservatory(conservatory, seed)
    furnished_home.kitchen(kitchen, seed)
    furnished_home.playroom(playroom, seed)
    sketches = {
        "room": study, "table": _table("oak"), "hall": _walls(0.0, 3.6, ground="stage"), "workshop": workshop,
        "bench": _table("bench"), "conservatory": conservatory, "pale_table": _table("pale"), "waiting_room": waiting,
        "kitchen": kitchen, "playroom": playroom, "play_table": _table("birch"),
    }  # fmt: skip
    for name, sketch in sketches.items():
        parts = [(writer.add_part(part), materials[material]) for material, part in sketch.parts().items()]
        writer.add_node(name, mesh=writer.add_mesh(name, parts))
    return writer.to_bytes()


def _painted(seed: int) -> dict[str, bytes]:
    return {"oak": textures.paint_oak(seed), "boards": textures.paint_boards(seed)}


def _table(wood: str) -> Sketch:
    """Top, frame and legs of a material."""
    sketch = Sketch()
    (x0, x1), (z0, z1) = _TABLE
    per_metre = 1.0 / 1.2
    sketch.box(wood, (x0, -_THICK, z0), (x1, 0.0, z1), per_metre=per_metre)
    sketch.box(wood, (x0 + 0.06, -0.12, z0 + 0.05), (x1 - 0.06, -_THICK, z1 - 0.05), per_metre=per_metre, shade=0.6)
    for x in (x0 + 0.05, x1 - 0.12):
        for z in (z0 + 0.04, z1 - 0.11):
            sketch.box(wood, (x, _FLOOR, z), (x + 0.07, -_THICK, z + 0.07), per_metre=per_metre, shade=0.7)
    return sketch


def _walls(floor: float, back: float = -_WALL, ground: str = "boards") -> Sketch:
    """Floor, panels with a rail, and plaster above, shaded towards the corners and below the table."""
    sketch = Sketch()
    rail = floor + _RAIL - _FLOOR
    high = rail + _HIGH - _RAIL

    def corner(point: Point) -> float:
        near = min(point[2] + back, _SIDE - abs(point[0]), 10.0)
        low = point[1] - floor
        return (1.0 - 0.30 * math.exp(-max(near, 0.0) / 0.35)) * (1.0 - 0.35 * math.exp(-max(low, 0.0) / 0.12))

    def below(point: Point) -> float:
        (x0, x1), (z0, z1) = _TABLE
        away = math.hypot(max(x0 - point[0], point[0] - x1, 0.0), max(z0 - point[2], point[2] - z1, 0.0))
        shadow = 1.0 - 0.55 * math.exp(-away / 0.25) if floor < 0.0 else 1.0
        return shadow * (1.0 - 0.35 * math.exp(-max(min(point[2] + back, _SIDE - abs(point[0])), 0.0) / 0.25))

    sketch.sheet(ground, (-_SIDE, floor, _FRONT), (2 * _SIDE, 0, 0), (0, 0, -_FRONT - back), (16, 16), 1.0, below)
    walls = (
        ((-_SIDE, 0.0, -back), (2 * _SIDE, 0.0, 0.0)),
        ((-_SIDE, 0.0, _FRONT), (0.0, 0.0, -_FRONT - back)),
        ((_SIDE, 0.0, -back), (0.0, 0.0, _FRONT + back)),
    )
    for (x, _, z), along in walls:
        sketch.sheet("panel", (x, floor, z), along, (0.0, rail - floor, 0.0), (12, 6), 1.0 / 0.55, corner)
        sketch.sheet("plaster", (x, rail, z), along, (0.0, high - rail, 0.0), (12, 4), 0.5, corner)
    for (x, _, z), along in walls:
        _trim(sketch, (x, floor, z), along, rail, corner)
    return sketch


def _trim(sketch: Sketch, start: Point, along: Point, rail: float, shade: Callable[[Point], float]) -> None:
    """Grooves, rail and skirting of a wall from a lower corner on, seen from along x up.

    Args:
        sketch: Takes them.
        start: Lower corner [m].
        along: From there to the next corner, parallel to x or z [m].
        rail: Upper edge of the panels [m].
        shade: Factor on the colour of a groove at a point.
    """
    length = abs(along[0] + along[2])
    (right, away), floor = (along[0] / length, along[2] / length), start[1]

    def at(far: float, up: float, off: float) -> Point:
        return start[0] + far * right - off * away, up, start[2] + far * away + off * right

    for number in range(1, round(length / _BOARD)):
        far = number * _BOARD
        groove = [at(far, floor, 0.002), at(far + _GROOVE, floor, 0.002)]
        groove += [at(far + _GROOVE, rail, 0.002), at(far, rail, 0.002)]
        sketch.fan("groove", groove, [(0.0, 0.0)] * 4, [shade(point) for point in groove])
    behind = "nwe" if right else "wns" if away < 0.0 else "ens"
    for low, high, thick, under, bright in (
        (rail - 0.03, rail + 0.012, 0.022, "", 1.0),
        (floor, floor + 0.10, 0.018, "d", 0.85),
    ):
        first, last = at(0.0, low, 0.0), at(length, high, thick)
        least, most = zip(*(sorted(pair) for pair in zip(first, last, strict=True)), strict=True)
        sketch.box("rail", least, most, hidden=behind + under, shade=bright)
