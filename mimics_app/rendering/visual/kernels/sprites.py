"""Sprites of a view: frustum culling, and their vertices relative to the camera."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import F4, F8, I4, U1, U8, Records
from mimics_app.rendering.visual.kernels.order import sort_by_key

__all__ = [
    "LEVEL",
    "MAX_PIECES",
    "MIN_OUTLINED",
    "SPRITE_VERTEX",
    "UPRIGHT",
    "Picked",
    "SortScratch",
    "cut_order",
    "cut_sprites",
    "pick_sprites",
    "write_sprites",
]


SPRITE_VERTEX = np.dtype(
    [
        ("position", "f4", (3,)),  # eye frame [m]
        ("tint", "f4", (4,)),  # linear RGBA
        ("style", "u2", (4,)),  # layer; opacity, roundness and alpha cutoff as shares of 65535
        ("at", "i2", (2,)),  # place on the sprite, -1 to 1 as shares of 32767
        ("normal", "i1", (4,)),  # unit, towards the camera, as shares of 127; the last one unused
    ]
)
"""One vertex as the shader reads it; four per piece of a sprite: lower left, lower right, upper left, upper right."""

MAX_PIECES = 8
"""Pieces of equal height that a sprite is cut into along the outline of its texture."""
MIN_OUTLINED = 128.0
"""Width and height as seen from which a sprite is cut [px]: for smaller ones its vertices cost more than its pixels."""

_WHOLE, _HALF, _BYTE = 65535.0, 32767.0, 127.0

UPRIGHT, _OWN, LEVEL = 1, 2, 3
"""Facings other than free, see `SPRITE`."""
_STEEPEST = 1e-4
"""Sine of the angle to the vertical below which the camera's right axis is used."""

_ALL_BITS = 0xFFFFFFFF
"""Of a float32."""

_VERTICES, _NUMBERS = 4, 4
"""Vertices of a sprite, and components of its tint and style."""


class Picked(NamedTuple):
    """The sprites of a view in the order of drawing, as they are written.

    Attributes:
        order: Numbers of all sprites in order, [>= count].
        blended: Numbers of the blended ones, [>= count].
        away: Scratch, [>= count].
        keys: Keys of the blended ones, which their distances follow from; [>= count].
    """

    order: I4
    blended: I4
    away: F8
    keys: U8


class SortScratch(NamedTuple):
    """Scratch of `sort_by_key`: keys and items, [>= count] each, and digits, [8, 256]."""

    keys: U8
    items: I4
    digits: I4


@kernel
def _cull_sprites(
    sprites: Records, count: int, planes: F8, eye: F8, masked: U1, solid: I4, blended: I4, away: F8
) -> tuple[int, int]:
    """Cull sprites against a frustum.

    Args:
        sprites: SPRITE, [>= count].
        count: Number of sprites.
        planes: Unit normals inwards and offsets, [k, 4].
        eye: Position of the camera, world [m], [3].
        masked: 1 for a state with alpha test instead of blending, [states].
        solid: Written: numbers of the masked sprites, [>= count].
        blended: Written: numbers of the blended sprites, [>= count].
        away: Written: distance of each blended sprite [m], [>= count].

    Returns:
        Number of masked and of blended sprites.
    """
    solids = others = 0
    for i in range(count):
        place = sprites[i]["place"]
        wide, high = sprites[i]["half"][0], sprites[i]["half"][1]
        if sprites[i]["tint"][3] <= 0.0 or wide * high <= 0.0:
            continue
        radius = math.sqrt(wide * wide + high * high) + sprites[i]["lift"] * high
        seen = True
        for k in range(planes.shape[0]):
            depth = planes[k, 0] * place[0] + planes[k, 1] * place[1] + planes[k, 2] * place[2] + planes[k, 3]
            seen = seen and depth >= -radius
        if not seen:
            continue
        if masked[sprites[i]["state"]]:
            solid[solids] = i
            solids += 1
            continue
        x, y, z = place[0] - eye[0], place[1] - eye[1], place[2] - eye[2]
        blended[others], away[others] = i, math.sqrt(x * x + y * y + z * z)
        others += 1
    return solids, others


@kernel
def pick_sprites(
    sprites: Records, count: int, planes: F8, eye: F8, masked: U1, picked: Picked, scratch: SortScratch
) -> tuple[int, int]:
    """Cull sprites and sort them: masked ones by state, then blended ones far to near.

    Args:
        sprites: SPRITE records; its shape, and those of the next four arguments, as in `_cull_sprites`.
        count: Number of sprites.
        planes: Planes of the frustum.
        eye: Position of the camera.
        masked: 1 for a state with alpha test.
        picked: Written.
        scratch: Of the sort.

    Returns:
        Number of masked and of blended sprites.
    """
    order, blended, away, keys = picked
    spare_keys, spare, digits = scratch
    solids, others = _cull_sprites(sprites, count, planes, eye, masked, order, blended, away)
    for i in range(solids):
        keys[i] = sprites[order[i]]["state"]
    sort_by_key(keys, order, solids, spare_keys, spare, digits)
    # The bits of positive numbers have the order of the numbers.
    bits = away[:others].astype(np.float32).view(np.uint32)
    for i in range(others):
        keys[i] = np.uint32(_ALL_BITS - bits[i])
    sort_by_key(keys, blended, others, spare_keys, spare, digits)
    order[solids : solids + others] = blended[:others]
    return solids, others


@kernel
def cut_order(keys: U8, blended: int, away: F8, first: int, cuts: I4) -> None:
    """Write the place in the order before which each blended surface is drawn: behind it are all farther sprites.

    Args:
        keys: Keys of the blended sprites, see `pick_sprites`, [>= blended].
        blended: Number of them.
        away: Distances of the surfaces, far to near [m], [n].
        first: Place of the first blended sprite.
        cuts: Written, [n].
    """
    bits = np.empty(blended, np.uint32)
    for i in range(blended):
        bits[i] = _ALL_BITS - keys[i]
    distances, done = bits.view(np.float32), 0
    for surface in range(away.shape[0]):
        while done < blended and distances[done] > away[surface]:
            done += 1
        cuts[surface] = first + done


@kernel
def _axes_before_eye(place: F8, eye: F8, right_of_eye: F8, facing: int, out: F8) -> None:
    """Write the right and up unit vectors of a sprite that faces the camera, upright in the world.

    A level one (text) has the camera's right axis, so that it does not lean at the sides of the picture.
    """
    x, y, z = eye[0] - place[0], eye[1] - place[1], eye[2] - place[2]
    length = math.sqrt(x * x + y * y + z * z)
    flat = math.sqrt(x * x + z * z)
    if flat > _STEEPEST * length and facing != LEVEL:
        out[0, 0], out[0, 1], out[0, 2] = z / flat, 0.0, -x / flat
    else:
        for k in range(3):
            out[0, k] = right_of_eye[k]
    if facing == UPRIGHT or length == 0.0:
        out[1, 0], out[1, 1], out[1, 2] = 0.0, 1.0, 0.0
        return
    if facing == LEVEL:
        aside = x * out[0, 0] + y * out[0, 1] + z * out[0, 2]
        x, y, z = x - aside * out[0, 0], y - aside * out[0, 1], z - aside * out[0, 2]
        length = math.sqrt(x * x + y * y + z * z)
    x, y, z = x / length, y / length, z / length
    out[1, 0] = y * out[0, 2] - z * out[0, 1]
    out[1, 1] = z * out[0, 0] - x * out[0, 2]
    out[1, 2] = x * out[0, 1] - y * out[0, 0]


@kernel
def _turned_axes(q: F4, out: F8) -> None:
    """Write the x and y axes of a quaternion's rotation."""
    x, y, z, w = float(q[0]), float(q[1]), float(q[2]), float(q[3])
    out[0, 0], out[0, 1], out[0, 2] = 1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + z * w), 2.0 * (x * z - y * w)
    out[1, 0], out[1, 1], out[1, 2] = 2.0 * (x * y - z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + x * w)


@kernel
def _normal_of(place: F8, eye: F8, axes: F8) -> None:
    """Write the unit normal of a sprite, on the camera's side, into the third row of its axes."""
    towards = 0.0
    for k in range(3):
        i, j = (k + 1) % 3, (k + 2) % 3
        axes[2, k] = axes[0, i] * axes[1, j] - axes[0, j] * axes[1, i]
        towards += axes[2, k] * (eye[k] - place[k])
    if towards < 0.0:
        for k in range(3):
            axes[2, k] = -axes[2, k]


@kernel
def cut_sprites(
    sprites: Records, order: I4, count: int, first: int, eye: F8, min_size: float, outlined: U1, rows: I4
) -> int:
    """Decide into how many pieces sprites are cut.

    Args:
        sprites: SPRITE.
        order: Numbers of sprites in draw order, [>= count].
        count: Number of sprites.
        first: Row of the first piece.
        eye: Position of the camera, world [m], [3].
        min_size: Width and height as seen from which a sprite with an outline is cut, as a tangent.
        outlined: 1 for a texture with an outline, by state and layer, [states, layers].
        rows: Written: row of each sprite's first piece, and the row after the last one, [>= count + 1].

    Returns:
        The row after the last one.
    """
    row = first
    for i in range(count):
        n = order[i]
        rows[i] = row
        row += 1
        if not outlined[sprites[n]["state"], int(sprites[n]["style"][0])] or sprites[n]["facing"] == _OWN:
            continue
        place, half = sprites[n]["place"], sprites[n]["half"]
        x, y, z = place[0] - eye[0], place[1] - eye[1], place[2] - eye[2]
        flat, away = x * x + z * z, math.sqrt(x * x + y * y + z * z)
        upright = math.sqrt(flat) / away if sprites[n]["facing"] == UPRIGHT and away > 0.0 else 1.0
        if 2.0 * min(half[0], half[1] * upright) >= min_size * away:
            row += MAX_PIECES - 1
    rows[count] = row
    return row


@kernel
def write_sprites(
    sprites: Records, order: I4, count: int, rows: I4, eye: F8, right_of_eye: F8, axes: F8, outlines: F8, out: Records
) -> None:
    """Write the vertices of sprites as the shader reads them, relative to the camera, subtracted in float64.

    Args:
        sprites: SPRITE.
        order: Numbers of sprites in draw order, [>= count].
        count: Number of sprites.
        rows: Row of each sprite's first piece in `out`, and the row after the last one, [>= count + 1].
        eye: Position of the camera, world [m], [3].
        right_of_eye: Right axis of the camera, unit, world, [3]: of text, and of sprites seen from straight above.
        axes: Scratch, [3, 3].
        outlines: Left and right at the heights between pieces, by state and layer, [states, layers, MAX_PIECES + 1, 2].
        out: SPRITE_VERTEX, [>= rows[count], 4].
    """
    for i in range(count):
        n = order[i]
        place, turn = sprites[n]["place"], sprites[n]["turn"]
        facing = sprites[n]["facing"]
        c, s = 1.0, 0.0
        if facing == _OWN:
            _turned_axes(turn, axes)
        else:
            _axes_before_eye(place, eye, right_of_eye, facing, axes)
            c, s = float(turn[0]), float(turn[1])
        wide, high = float(sprites[n]["half"][0]), float(sprites[n]["half"][1])
        _normal_of(place, eye, axes)
        for k in range(3):
            right, up = axes[0, k], axes[1, k]
            axes[0, k], axes[1, k] = wide * (right * c + up * s), high * (up * c - right * s)
        pieces = rows[i + 1] - rows[i]
        layer = int(sprites[n]["style"][0])
        for piece in range(pieces):
            for number in range(_VERTICES):
                level = piece + number // 2
                x, y = 2.0 * (number % 2) - 1.0, 2.0 * level / pieces - 1.0
                if pieces > 1:
                    x = outlines[sprites[n]["state"], layer, level, number % 2]
                _write_vertex(sprites[n], eye, axes, x, y, out[rows[i] + piece, number])


@kernel
def _write_vertex(sprite: Records, eye: F8, axes: F8, x: float, y: float, out: Records) -> None:
    """Write the vertex at a place on a sprite, -1 to 1, given half its width and height as vectors and its normal."""
    for k in range(3):
        out["position"][k] = sprite["place"][k] - eye[k] + x * axes[0, k] + (y + sprite["lift"]) * axes[1, k]
        out["normal"][k] = np.int8(round(axes[2, k] * _BYTE))
    out["at"][0], out["at"][1] = np.int16(round(x * _HALF)), np.int16(round(y * _HALF))
    for k in range(_NUMBERS):
        out["tint"][k] = sprite["tint"][k]
    out["style"][0] = np.uint16(sprite["style"][0])
    for k in range(1, _NUMBERS):
        out["style"][k] = np.uint16(sprite["style"][k] * _WHOLE + 0.5)
