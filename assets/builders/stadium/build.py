"""Pitch of street soccer: turf with lines, boards around it, goals with nets, stands with people, and a ball."""

from __future__ import annotations

import itertools
import math

import numpy as np

from assets.builders.city.textures import paint_grass
from assets.builders.kit.lattice_noise import pixels
from assets.builders.kit.palette_texture import Canvas
from assets.builders.kit.rng import Rng
from assets.builders.kit.sketch import Point, Sketch
from assets.builders.kit.solids import Skin, add_column
from mimics_app.world.files.gltf.writer import GltfWriter

__all__ = ["compose"]

_LENGTH, _WIDTH = 8.0, 3.2
"""Half the pitch [m], as `tasks.kinds.soccer.match.Pitch` (a test compares them)."""
_GOAL, _BAR, _DEPTH = 1.5, 1.9, 0.9
"""Half the width of a goal, its height and depth [m]."""
_POST = 0.05
_LINE, _LIFT = 0.07, 0.006
"""Width of the lines, and height over the turf [m]."""
_TURF = 0.012
"""Height of the turf over the street [m]."""
_BOARD = 0.55
_STAND_ROWS, _STAND_DEPTH, _STAND_RISE, _STAND_HALF = 3, 0.8, 0.42, 4.1
_STAND_FROM = 10.2
"""Distance of the stands from the middle [m]."""
_COLOURS = ("red", "white", "navy", "teal", "amber", "grey")
_SPHERE = 3
"""Number of subdivisions of the ball's icosahedron."""
_PENTAGON = 0.36
"""Angle about the corners of the icosahedron within which the ball is black [rad]."""
_BALL_RADIUS = 0.11


def compose(seed: int) -> dict[str, bytes]:
    """Return all files by name.

    Args:
        seed: Of the textures and the people.
    """
    return {"stadium.glb": _compose_stadium(seed), "ball.glb": _compose_ball()}


def _compose_stadium(seed: int) -> bytes:
    writer = GltfWriter("mimics_app assets build stadium")
    plain = {
        "paint": (0.86, 0.86, 0.82),
        "post": (0.88, 0.88, 0.86),
        "steel": (0.30, 0.32, 0.34),
        "wood": (0.40, 0.27, 0.16),
        "skin": (0.55, 0.36, 0.26),
        "hair": (0.09, 0.06, 0.045),
        "red": (0.55, 0.05, 0.05),
        "white": (0.80, 0.80, 0.78),
        "navy": (0.06, 0.10, 0.24),
        "teal": (0.05, 0.26, 0.25),
        "amber": (0.72, 0.42, 0.06),
        "grey": (0.28, 0.28, 0.30),
    }
    materials = {
        name: writer.add_material(f"stadium_{name}", colour=(*rgb, 1.0), roughness=0.8) for name, rgb in plain.items()
    }
    turf = writer.add_picture("turf", paint_grass(seed))
    materials["turf"] = writer.add_material("stadium_turf", texture=turf, colour=(0.62, 0.85, 0.55, 1.0))
    net = writer.add_picture("net", _paint_net())
    materials["net"] = writer.add_material(
        "stadium_net", texture=net, blend=True
    )  # far away a veil, and no broken lines
    for name, sketch in (
        ("turf", _turf()),
        ("boards", _boards()),
        ("goals", _goals()),
        ("stands", _stands()),
        ("people", _people(Rng(seed, "stands"))),
    ):
        parts = [(writer.add_part(part), materials[material]) for material, part in sketch.parts().items()]
        writer.add_node(name, mesh=writer.add_mesh(name, parts))
    return writer.to_bytes()


def _paint_net() -> bytes:
    """Return meshes of a net of 10 cm, four in one repetition."""
    side = 64
    canvas = Canvas(side, side, [((190, 190, 186), (255, 255, 252))])
    x, y = pixels(side, side)
    canvas.tone[:] = 0.8
    canvas.clear[:] = (x % 16 > 1) & (y % 16 > 1)
    return canvas.to_png()


def _flat(sketch: Sketch, material: str, low: tuple[float, float], high: tuple[float, float], y: float) -> None:
    """Add a level rectangle (x, z)."""
    (x0, z0), (x1, z1) = low, high
    corners: list[Point] = [(x0, y, z1), (x1, y, z1), (x1, y, z0), (x0, y, z0)]
    sketch.fan(material, corners, [(x / 6.0, z / 6.0) for x, _, z in corners])


def _turf() -> Sketch:
    """Turf, and the lines on it."""
    sketch, y = Sketch(), _TURF + _LIFT
    for near, far in itertools.pairwise(np.linspace(-_LENGTH - _DEPTH, _LENGTH + _DEPTH, 10).tolist()):
        _flat(sketch, "turf", (-_WIDTH, near), (_WIDTH, far), _TURF)
    half = 0.5 * _LINE
    for z in (-_LENGTH, 0.0, _LENGTH):
        _flat(sketch, "paint", (-_WIDTH, z - half), (_WIDTH, z + half), y)
    for x in (-_WIDTH + half, _WIDTH - half):
        _flat(sketch, "paint", (x - half, -_LENGTH), (x + half, _LENGTH), y)
    for sign in (-1.0, 1.0):
        front = sign * (_LENGTH - 2.4)
        _flat(sketch, "paint", (-2.3, front - half), (2.3, front + half), y)
        for x in (-2.3, 2.3):
            low, high = sorted((front, sign * _LENGTH))
            _flat(sketch, "paint", (x - half, low), (x + half, high), y)
    for radius, sides in ((1.4, 40), (0.12, 12)):
        inner = radius - _LINE if radius > 1.0 else 0.0
        for k in range(sides):
            turns = [2.0 * math.pi * (k + n) / sides for n in (0, 1)]
            ring: list[Point] = [(inner * math.cos(turns[0]), y, -inner * math.sin(turns[0]))]
            ring += [(radius * math.cos(t), y, -radius * math.sin(t)) for t in turns]
            if inner > 0.0:
                ring.append((inner * math.cos(turns[1]), y, -inner * math.sin(turns[1])))
            sketch.fan("paint", ring, [(0.0, 0.0)] * len(ring))
    return sketch


def _boards() -> Sketch:
    """Boards along both sides and beside the goals."""
    sketch = Sketch()
    colours = itertools.cycle(("navy", "white", "teal", "amber"))
    for side in (-1.0, 1.0):
        x0, x1 = sorted((side * _WIDTH, side * (_WIDTH + 0.08)))
        for near, far in itertools.pairwise(np.linspace(-_LENGTH, _LENGTH, 9).tolist()):
            sketch.box(next(colours), (x0, 0.0, near), (x1, _BOARD, far - 0.015))
        z0, z1 = sorted((side * _LENGTH, side * (_LENGTH + 0.08)))
        for left, right in ((-_WIDTH, -_GOAL - 0.1), (_GOAL + 0.1, _WIDTH)):
            sketch.box(next(colours), (left, 0.0, z0), (right, _BOARD, z1))
    return sketch


def _goals() -> Sketch:
    """Posts, bars and nets."""
    sketch, post = Sketch(), Skin("post")
    for sign in (-1.0, 1.0):
        front, back = sign * _LENGTH, sign * (_LENGTH + _DEPTH)
        for x in (-_GOAL - _POST, _GOAL + _POST):
            add_column(sketch, (x, 0.0, front), (x, _BAR + 2.0 * _POST, front), (_POST, _POST), 12, post)
            add_column(sketch, (x, 0.0, back), (x, 0.7 * _BAR, back), (0.02, 0.02), 6, post)
        sketch.box("post", (-_GOAL, _BAR, front - _POST), (_GOAL, _BAR + 2.0 * _POST, front + _POST))
        low, high = 0.7 * _BAR, _BAR + _POST
        panels: list[list[Point]] = [
            [(-_GOAL, 0.0, back), (_GOAL, 0.0, back), (_GOAL, low, back), (-_GOAL, low, back)],
            [(-_GOAL, low, back), (_GOAL, low, back), (_GOAL, high, front), (-_GOAL, high, front)],
        ]
        sides = (-_GOAL - _POST, _GOAL + _POST)
        panels += [[(x, 0.0, front), (x, 0.0, back), (x, low, back), (x, high, front)] for x in sides]
        for panel in panels:
            uvs = [((x + z) / 0.4, y / 0.4) for x, y, z in panel]
            sketch.fan("net", panel, uvs)
            sketch.fan("net", panel[::-1], uvs[::-1])
    return sketch


def _stands() -> Sketch:
    """Steps of wood on steel behind both goals."""
    sketch = Sketch()
    for sign in (-1.0, 1.0):
        for row in range(_STAND_ROWS):
            near = _STAND_FROM + row * _STAND_DEPTH
            z0, z1 = sorted((sign * near, sign * (near + _STAND_DEPTH)))
            top = (row + 1) * _STAND_RISE
            sketch.box("wood", (-_STAND_HALF, top - 0.06, z0), (_STAND_HALF, top, z1))
            sketch.box(
                "steel", (-_STAND_HALF + 0.05, 0.0, z0 + 0.05), (_STAND_HALF - 0.05, top - 0.06, z1 - 0.05), shade=0.5
            )
        far = sign * (_STAND_FROM + _STAND_ROWS * _STAND_DEPTH)
        rail = _STAND_ROWS * _STAND_RISE + 0.9
        sketch.box("steel", (-_STAND_HALF, rail, far - 0.03), (_STAND_HALF, rail + 0.05, far + 0.03))
        for x in np.linspace(-_STAND_HALF, _STAND_HALF, 5).tolist():
            sketch.box("steel", (x - 0.025, 0.0, far - 0.025), (x + 0.025, rail, far + 0.025))
    return sketch


def _people(rng: Rng) -> Sketch:
    """People who sit on the stands: legs, trunk, arms and head, coarse, for a distance."""
    sketch = Sketch()
    for sign in (-1.0, 1.0):
        for row in range(_STAND_ROWS):
            seat = (row + 1) * _STAND_RISE
            x = -_STAND_HALF + 0.4 + rng.between(0.0, 0.2)
            while x < _STAND_HALF - 0.3:
                if rng.share() < 0.85:
                    z = sign * (_STAND_FROM + (row + 0.55) * _STAND_DEPTH)
                    _add_person(sketch, (x, seat, z), -sign, rng)
                x += rng.between(0.52, 0.7)
    return sketch


def _add_person(sketch: Sketch, at: Point, ahead: float, rng: Rng) -> None:
    """Add somebody who sits at a point and looks along z by a sign."""
    x, y, z = at
    shirt, trousers = _COLOURS[rng.below(len(_COLOURS))], ("navy", "grey")[rng.below(2)]
    tall = rng.between(0.46, 0.56)
    for side in (-0.09, 0.09):
        add_column(
            sketch, (x + side, y + 0.09, z), (x + side, y + 0.10, z + ahead * 0.42), (0.08, 0.065), 5, Skin(trousers)
        )
        knee = z + ahead * 0.42
        add_column(sketch, (x + side, y - 0.36, knee), (x + side, y + 0.12, knee), (0.05, 0.065), 5, Skin(trousers))
        arm = (x + 2.4 * side, y + tall, z)
        up = rng.share() < 0.18
        hand = (x + 2.6 * side, y + tall + 0.5, z + 0.1 * ahead) if up else (x + 1.2 * side, y + 0.2, z + 0.34 * ahead)
        add_column(sketch, hand, arm, (0.035, 0.05), 4, Skin(shirt))
    add_column(sketch, (x, y, z), (x, y + tall, z + 0.04 * ahead), (0.15, 0.19), 7, Skin(shirt))
    add_column(
        sketch, (x, y + tall, z + 0.04 * ahead), (x, y + tall + 0.06, z + 0.04 * ahead), (0.19, 0.06), 7, Skin(shirt)
    )
    head = (x, y + tall + 0.06, z + 0.05 * ahead)
    for low, high, radii, skin in (
        (0.0, 0.08, (0.055, 0.095), "skin"),
        (0.08, 0.17, (0.095, 0.098), "skin"),
        (0.17, 0.25, (0.105, 0.05), "hair"),
    ):
        add_column(sketch, (head[0], head[1] + low, head[2]), (head[0], head[1] + high, head[2]), radii, 7, Skin(skin))


def _compose_ball() -> bytes:
    """Return a ball whose black parts lie about the corners of an icosahedron."""
    writer = GltfWriter("mimics_app assets build stadium")
    materials = {
        "white": writer.add_material("ball_white", colour=(0.82, 0.82, 0.80, 1.0), roughness=0.45),
        "black": writer.add_material("ball_black", colour=(0.02, 0.02, 0.022, 1.0), roughness=0.45),
    }
    corners, faces = _icosahedron()
    sketch = Sketch()
    pieces = [tuple(corners[list(face)]) for face in faces]
    for _ in range(_SPHERE):
        pieces = [small for piece in pieces for small in _quarter(*piece)]
    limit = math.cos(_PENTAGON)
    for piece in pieces:
        middle = sum(piece) / 3.0
        middle = middle / np.linalg.norm(middle)
        black = bool((corners @ middle).max() > limit)
        unit = [(float(v[0]), float(v[1]), float(v[2])) for v in piece]
        points: list[Point] = [(a * _BALL_RADIUS, b * _BALL_RADIUS, c * _BALL_RADIUS) for a, b, c in unit]
        sketch.fan("black" if black else "white", points, [(0.0, 0.0)] * 3, normals=unit)
    parts = [(writer.add_part(part), materials[material]) for material, part in sketch.parts().items()]
    writer.add_node("ball", mesh=writer.add_mesh("ball", parts))
    return writer.to_bytes()


def _icosahedron() -> tuple[np.ndarray, list[tuple[int, int, int]]]:
    """Return the corners of length 1 and the faces, counter-clockwise seen from outside."""
    g = 0.5 * (1.0 + math.sqrt(5.0))
    rows = [(s * a, t * b) for a, b in ((1.0, g),) for s in (-1.0, 1.0) for t in (-1.0, 1.0)]
    corners = np.array(
        [(0.0, a, b) for a, b in rows] + [(a, b, 0.0) for a, b in rows] + [(b, 0.0, a) for a, b in rows]
    ) / math.hypot(1.0, g)
    edge = np.linalg.norm(corners[:, None] - corners[None], axis=-1)
    near = edge < 1.2 * np.sort(edge, axis=1)[0, 1]
    faces = []
    for a, b, c in itertools.combinations(range(12), 3):
        if near[a, b] and near[b, c] and near[a, c]:
            out = float(np.cross(corners[b] - corners[a], corners[c] - corners[a]) @ corners[a])
            faces.append((a, b, c) if out > 0.0 else (a, c, b))
    return corners, faces


def _quarter(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> list[tuple[np.ndarray, ...]]:
    """Return the four parts of a triangle on the sphere."""
    ab, bc, ca = (mid / np.linalg.norm(mid) for mid in (a + b, b + c, c + a))
    return [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
