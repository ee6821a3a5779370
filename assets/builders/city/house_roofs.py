"""Roofs of six forms, chimneys and dormers: closed solids that sit on the body."""

from __future__ import annotations

import itertools

from assets.builders.city.fittings import detail, plain, window
from assets.builders.city.house_kinds import HouseKind
from assets.builders.city.textures import TILE
from assets.builders.kit.sketch import Point, Sketch, Uv
from assets.builders.kit.solids import ALONG_X, Axes, Skin, add_prism, rectangle

__all__ = ["add_chimneys", "add_dormers", "add_roof"]


_OVERHANG = 0.4
"""How far roofs stand out over the street [m]."""
_FASCIA = 0.16


def add_roof(sketch: Sketch, kind: HouseKind) -> None:
    """The kind's roof on its eaves."""
    if kind.roof == "flat":
        _add_parapet(sketch, kind)
    elif kind.roof == "hip" or (kind.roof == "mansard" and kind.corner):
        _add_hip(sketch, kind)
    elif kind.roof in ("gabled_front", "stepped"):
        _add_gabled_front(sketch, kind)
    else:
        _add_ridge_along(sketch, kind)


def _cover(kind: HouseKind) -> Skin:
    return Skin("roof", TILE["slate" if kind.slate else "tiles"])


def _gable(kind: HouseKind) -> Skin:
    return Skin("wall", TILE[kind.wall])


def _profile(kind: HouseKind) -> list[Uv]:
    """Outline of a roof with its ridge along the street, (depth, height) from the front eaves."""
    low, high, d, o = kind.eaves, kind.eaves + kind.rise, kind.depth, _OVERHANG
    sill = low + _FASCIA
    if kind.roof == "mansard":
        knee = low + 0.66 * kind.rise
        slopes = [(d - 1.2, knee), (0.5 * d, high), (1.2, knee)]
    else:
        slopes = [(0.5 * d, high)]
    return [(-o, low), (d + o, low), (d + o, sill), *slopes, (-o, sill)]


def _add_ridge_along(sketch: Sketch, kind: HouseKind) -> None:
    outline = _profile(kind)
    board, cover = plain("white", 0.9), _cover(kind)
    sides = [plain("soffit"), board, *([cover] * (len(outline) - 3)), board]
    half = 0.5 * kind.width
    add_prism(sketch, ALONG_X, outline, -half, half, (_gable(kind), _gable(kind)), sides)


def _add_gabled_front(sketch: Sketch, kind: HouseKind) -> None:
    """A ridge away from the street behind a gable; a stepped gable stands before the roof."""
    half, low, d = 0.5 * kind.width, kind.eaves, kind.depth
    rise = kind.rise if kind.roof == "gabled_front" else 0.92 * kind.rise
    outline = [(-half, low), (half, low), (0.0, low + rise)]
    front = 0.0 if kind.roof == "gabled_front" else -0.3
    cover, wall = _cover(kind), _gable(kind)
    add_prism(sketch, Axes(), outline, -d, front, (wall, wall), (plain("soffit"), cover, cover))
    if kind.roof == "stepped":
        steps = 5
        step = kind.rise / steps
        for number in range(steps):
            wide = half * (steps - number) / steps
            base = low + number * step
            block = rectangle(-wide, wide, base, base + step)
            coping = plain("stone")
            add_prism(sketch, Axes(), block, -0.4, 0.0, (wall, wall), (coping, wall, coping, wall))
    _add_attic_window(sketch, low + 0.18 * kind.rise, kind)


def _add_attic_window(sketch: Sketch, bottom: float, kind: HouseKind) -> None:
    half, high = min(0.55, 0.1 * kind.width), 0.3 * kind.rise
    outline = rectangle(-half, half, bottom, bottom + high)
    frame = plain("stone")
    add_prism(sketch, Axes(), outline, -0.05, 0.06, (frame, window(kind.window)), (frame,))


def _add_parapet(sketch: Sketch, kind: HouseKind) -> None:
    """Four walls about a flat roof, which the body's lid is, with a coping."""
    w, d, low, high = 0.5 * kind.width, kind.depth, kind.eaves, kind.eaves + kind.rise
    wall, coping = _gable(kind), plain("stone")
    for first, last, back, front in (
        (-w, w, -0.3, 0.0),
        (-w, w, -d, 0.3 - d),
        (-w, 0.3 - w, 0.3 - d, -0.3),
        (w - 0.3, w, 0.3 - d, -0.3),
    ):
        outline = rectangle(first, last, low, high)
        add_prism(sketch, Axes(), outline, back, front, (wall, wall), (coping, wall, coping, wall))


def _add_hip(sketch: Sketch, kind: HouseKind) -> None:
    """Slopes to all sides; on a mansard steep ones below a shallow top."""
    levels = [(0.0, -_OVERHANG), (_FASCIA, -_OVERHANG)]
    if kind.roof == "mansard":
        levels.append((0.66 * kind.rise, 1.2))
    rings = [_ring(kind, height, inset) for height, inset in levels]
    cover, board = _cover(kind), plain("white", 0.9)
    sketch.fan("detail", rings[0][::-1], plain("soffit").lay([(x, -z) for x, _, z in rings[0][::-1]]), 0.5)
    for number, (lower, upper) in enumerate(itertools.pairwise(rings)):
        for side in range(4):
            corners = [lower[side], lower[(side + 1) % 4], upper[(side + 1) % 4], upper[side]]
            _slope(sketch, board if number == 0 else cover, corners)
    _close_top(sketch, rings[-1], kind, cover)


def _ring(kind: HouseKind, height: float, inset: float) -> list[Point]:
    """Four corners about the body, counter-clockwise seen from above, from the front left."""
    half, y = 0.5 * kind.width - inset, kind.eaves + height
    near, far = -inset, inset - kind.depth
    return [(-half, y, near), (half, y, near), (half, y, far), (-half, y, far)]


def _close_top(sketch: Sketch, ring: list[Point], kind: HouseKind, cover: Skin) -> None:
    """A ridge over the longer side of the ring."""
    (left, _, near), (right, _, far) = ring[0], ring[2]
    top = kind.eaves + kind.rise
    wide, deep = right - left, near - far
    middle = 0.5 * (near + far)
    if wide > deep:
        first, last = (left + 0.5 * deep, top, middle), (right - 0.5 * deep, top, middle)
        faces = [
            [ring[0], ring[1], last, first],
            [ring[1], ring[2], last],
            [ring[2], ring[3], first, last],
            [ring[3], ring[0], first],
        ]
    else:
        first, last = (0.0, top, near - 0.5 * wide), (0.0, top, far + 0.5 * wide)
        faces = [
            [ring[0], ring[1], first],
            [ring[1], ring[2], last, first],
            [ring[2], ring[3], last],
            [ring[3], ring[0], first, last],
        ]
    for face in faces:
        _slope(sketch, cover, [point for number, point in enumerate(face) if point not in face[:number]])


def _slope(sketch: Sketch, skin: Skin, corners: list[Point]) -> None:
    """A face whose picture stands upright on it: along is level, up is steepest."""
    (x0, y0, z0), (x1, _, z1) = corners[0], corners[1]
    length = ((x1 - x0) ** 2 + (z1 - z0) ** 2) ** 0.5
    ax, az = (x1 - x0) / length, (z1 - z0) / length
    places = []
    for x, y, z in corners:
        along = (x - x0) * ax + (z - z0) * az
        inward = (x - x0) * az - (z - z0) * ax
        places.append((along, (inward * inward + (y - y0) ** 2) ** 0.5))
    sketch.fan(skin.material, corners, skin.lay(places), skin.shade)


def add_chimneys(sketch: Sketch, kind: HouseKind) -> None:
    """Stacks on the ridge, near the party walls."""
    half = 0.5 * kind.width
    places = [-half + 0.75, half - 0.75][: kind.chimneys]
    for x in places:
        if kind.roof in ("gabled_front", "stepped"):
            low, high, z = kind.eaves + 0.1, kind.eaves + 0.75 * kind.rise, -0.62 * kind.depth
        else:
            low, high, z = kind.eaves + 0.3 * kind.rise, kind.eaves + kind.rise + 1.1, -0.5 * kind.depth
            if kind.roof == "hip" or (kind.roof == "mansard" and kind.corner):
                x *= 0.55
        outline = rectangle(x - 0.4, x + 0.4, low, high)
        clay, dark = plain("clay"), plain("soffit", 0.6)
        add_prism(sketch, Axes(), outline, z - 0.65, z + 0.65, (clay, clay), (clay, clay, dark, clay))


def add_dormers(sketch: Sketch, kind: HouseKind) -> None:
    """Small gabled houses with a window on the roof's street side."""
    if kind.roof not in ("gable", "mansard") or (kind.roof == "mansard" and kind.corner):
        return
    knee = _profile(kind)[-2]
    base, high = kind.eaves + 0.5, 1.5
    # The front stands where the roof has risen to the base; the back goes into the roof.
    share = (base - kind.eaves - _FASCIA) / (knee[1] - kind.eaves - _FASCIA)
    front = _OVERHANG - share * (knee[0] + _OVERHANG) - 0.02
    cover, side = _cover(kind), plain("zinc", 0.8)
    for number in range(kind.dormers):
        middle = kind.width * ((number + 0.5) / kind.dormers - 0.5)
        outline = [(-0.75, base), (0.75, base), (0.75, base + high), (0.0, base + high + 0.55), (-0.75, base + high)]
        axes = Axes(origin=(middle, 0.0, 0.0))
        face = detail("dormer", kind.sign % 4)
        back = min(-0.45 * kind.depth, front - 2.0) if kind.roof == "gable" else front - 2.2
        add_prism(sketch, axes, outline, back, front, (side, face), (side, side, cover, cover, side))
