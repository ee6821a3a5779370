"""The textures of a head: skin, lips, brows, lashes, stubble, and the scalp under the hair."""

from __future__ import annotations

import numpy as np

from assets.builders.avatars.face_map import LID_LIFT, LID_POINTS, MOUTH_RISE
from assets.builders.avatars.face_relief import face_relief
from assets.builders.avatars.face_shape import Head, lid_lines, over_eye
from assets.builders.avatars.fields import F8, step
from assets.builders.avatars.hair import hairline
from assets.builders.avatars.person import Person
from assets.builders.avatars.piece import Piece
from assets.builders.avatars.textures import encode, place_map, slopes
from assets.builders.market.sculpt import noise

__all__ = ["paint_face"]

_SIZE = 512
_LEAST_PITCH, _MOST_PITCH = 3e-4, 2e-3
"""Limits of the size of a texel [m], by which heights become slopes."""
_SPOTS = 0.3
"""Depth of the spots of age, for each part of an age over 0.6."""
_BROW_TINT = np.array([1.0, 0.94, 0.86])
"""Factor on the colour of hair: skin shows between the hairs of a brow, without which grey ones look blue."""
_HAIRS = 75.0
"""Density of painted hairs at the hairline [1/rad]."""
_ENCODED = 1.0 / 2.2
"""Exponent of a linear factor that is applied to an encoded colour."""


def paint_face(person: Person, head: Head, skin: Piece, count: int) -> tuple[bytes, bytes]:
    """Return base colour and normal map of a head's skin as JPEG files.

    Args:
        person: Description of the person.
        head: Shape of the head.
        skin: The skin of the head.
        count: Number of its first vertices that are those of the face.
    """
    triangles = skin.triangles[(skin.triangles < count).all(axis=1)]
    sheet, _ = place_map(skin.uvs[:count], triangles, skin.places[:count], (_SIZE, _SIZE))
    places = sheet.reshape(-1, 3)
    mm = (places - head.middle) / head.size * 1e3
    colour = _skin(person, mm, places)
    colour = _lips(person, head, mm, places, colour)
    colour = _eyes(person, head, places, colour)
    colour = _brows(person, mm, places, colour)
    colour = _scalp(person, head, places, colour)
    relief = face_relief(head, skin, triangles, sheet)
    colour = colour.reshape(_SIZE, _SIZE, 3) * np.clip(relief.open, 0.3, 1.25)[..., None] ** _ENCODED
    heights = _heights(person, head, mm, places).reshape(_SIZE, _SIZE)
    pitch = np.clip(np.linalg.norm(np.gradient(sheet, axis=1), axis=2), _LEAST_PITCH, _MOST_PITCH)
    return encode(colour), encode(slopes(heights, pitch, more=relief.slopes))


def _mix(colour: F8, other: F8, share: F8) -> F8:
    return colour + share[:, None] * (other - colour)


def _spot(mm: F8, x: float, y: float, wide: float, high: float) -> F8:
    """Return a soft spot on both sides of the face, 0 to 1."""
    ahead = step(10.0, 40.0, mm[:, 2])
    result: F8 = ahead * np.exp(-(((np.abs(mm[:, 0]) - x) / wide) ** 2) - ((mm[:, 1] - y) / high) ** 2)
    return result


def _skin(person: Person, mm: F8, places: F8) -> F8:
    base = np.array(person.looks.skin, float)
    grain = 0.55 * noise(places, 0.0022, 1) + 0.45 * noise(places, 0.011, 2) - 0.5
    colour = base * (1.0 + 0.075 * grain)[:, None]
    red, dark, warm = base * [0.98, 0.80, 0.78], base * [0.80, 0.70, 0.70], base * [1.03, 1.01, 0.95]
    colour = _mix(colour, red, 0.38 * _spot(mm, 40.0, -30.0, 17.0, 14.0))
    colour = _mix(colour, red, 0.45 * _spot(mm, 0.0, -36.0, 13.0, 9.0))
    colour = _mix(colour, red, 0.25 * _spot(mm, 0.0, -98.0, 14.0, 10.0))
    colour = _mix(colour, warm, 0.5 * _spot(mm, 0.0, 45.0, 45.0, 22.0))
    colour = _mix(colour, dark, (0.05 + 0.22 * person.face.age) * _spot(mm, 27.0, -13.0, 12.0, 4.0))
    colour = _mix(colour, dark, 0.12 * _spot(mm, 30.0, 8.5, 15.0, 5.0))
    colour = _mix(colour, dark, 0.45 * person.face.age * _spot(mm, 27.5, -50.0, 3.2, 11.0))
    colour = _mix(
        colour, base * 0.30, 0.55 * _spot(mm, 6.5 * person.face.nose_breadth, -36.0 * person.face.nose - 9.0, 3.0, 2.0)
    )
    spots = step(0.66, 0.74, noise(places, 0.007, 31)) * step(0.45, 0.60, noise(places, 0.021, 32))
    colour = _mix(colour, dark, _SPOTS * max(person.face.age - 0.6, 0.0) * spots)
    if person.looks.stubble:
        beard = (
            step(-38.0, -54.0, mm[:, 1] - 0.22 * np.abs(mm[:, 0]))
            * step(-118.0, -100.0, mm[:, 1])
            * step(5.0, 30.0, mm[:, 2])
        )
        beard *= 1.0 - 0.85 * _spot(mm, 44.0, -42.0, 14.0, 16.0)
        hairs = np.clip(0.35 + 1.1 * (noise(places, 0.0011, 5) - 0.35), 0.0, 1.0)
        shadow = np.array(person.looks.hair, float) * 0.6 + base * 0.25
        colour = _mix(colour, shadow, person.looks.stubble * 0.55 * beard * hairs)
    return colour


def _lips(person: Person, head: Head, mm: F8, places: F8, colour: F8) -> F8:
    half = head.mouth / (head.size[0] * 1e-3)
    share = np.abs(mm[:, 0]) / half
    inside = np.clip(share, 0.0, 1.0)
    line = -65.0 + MOUTH_RISE * inside**2
    full = person.face.lips
    upper = 7.4 * full * (1.0 - inside**2.2) * (1.0 - 0.12 * np.exp(-((inside / 0.16) ** 2)))
    lower = 9.0 * full * (1.0 - inside**2.4)
    up = mm[:, 1] - line
    red = (
        step(upper + 1.2, upper - 1.2, up)
        * step(-lower - 1.2, -lower + 2.2, up)
        * step(1.02, 0.86, share)
        * step(60.0, 75.0, mm[:, 2])
    )
    lips = (
        np.array(person.looks.lips, float) * (1.0 + 0.10 * (noise(places * [3.0, 0.6, 1.0], 0.0016, 7) - 0.5))[:, None]
    )
    lips = lips * (1.0 - 0.12 * step(0.0, upper + 0.1, up))[:, None]
    colour = _mix(colour, lips, 0.80 * red)
    seam = np.exp(-((up / (0.85 - 0.25 * inside)) ** 2)) * step(1.02, 0.80, share) * step(60.0, 75.0, mm[:, 2])
    return _mix(colour, np.array(person.looks.lips, float) * 0.35, 0.75 * seam)


def _eyes(person: Person, head: Head, places: F8, colour: F8) -> F8:
    """Lashes as a dark edge, and the lids' wet rims."""
    upper, lower = lid_lines(head, person.face, LID_POINTS * 4)
    dark = 0.35 * np.array(person.looks.hair, float)
    thick = 0.00115 if person.body.woman else 0.0008
    for side, eye in ((1, head.eyes[0]), (-1, head.eyes[1])):
        for line, width, strength in ((upper, thick, 0.92), (lower, 0.0006, 0.42)):
            edge = over_eye(eye, line, side, LID_LIFT)
            near = np.linalg.norm(places - eye, axis=1) < 0.03
            far = np.full(len(places), 1.0)
            far[near] = np.sqrt(((places[near][:, None, :] - edge[None]) ** 2).sum(axis=2)).min(axis=1)
            colour = _mix(colour, dark, strength * step(1.6 * width, 0.4 * width, far))
    return colour


def _brows(person: Person, mm: F8, places: F8, colour: F8) -> F8:
    x = np.abs(mm[:, 0])
    middle = np.interp(x, [9.0, 14.0, 26.0, 38.0, 47.0, 54.0], [18.0, 18.9, 20.9, 22.2, 21.2, 18.2])
    if person.body.woman:
        middle = middle + 1.0 + 1.4 * np.exp(-(((x - 38.0) / 9.0) ** 2))
    wide = np.interp(x, [9.0, 14.0, 30.0, 46.0, 54.0], [2.0, 3.4, 3.3, 2.3, 0.9]) * (
        0.80 if person.body.woman else 1.08
    )
    off = mm[:, 1] - middle
    # hairs stand up at the inner end and lie down outwards
    lean = np.interp(x, [8.0, 20.0, 50.0], [0.25, 0.8, 1.6])
    across = np.stack([x - lean * off, 0.25 * off, np.where(mm[:, 0] > 0.0, 0.0, 50.0)], axis=1)
    hairs = np.clip(0.42 + 2.1 * (noise(across, 0.75, 9) - 0.42), 0.0, 1.0)
    mask = step(1.25, 0.45, np.abs(off) / wide) * step(7.5, 17.0, x) * step(57.0, 49.0, x) * step(40.0, 55.0, mm[:, 2])
    dark = 0.75 * np.array(person.looks.hair, float) * _BROW_TINT
    return _mix(colour, dark, 0.86 * mask * (0.30 + 0.70 * hairs))


def _scalp(person: Person, head: Head, places: F8, colour: F8) -> F8:
    offset = places - head.middle
    azimuth = np.arctan2(offset[:, 0], offset[:, 2])
    elevation = np.arcsin(np.clip(offset[:, 1] / np.linalg.norm(offset, axis=1), -1.0, 1.0))
    # single hairs stand before the line, close together behind it; the line itself is not even
    turned = np.stack([azimuth * _HAIRS, elevation * 9.0 + 2.0 * azimuth, 0 * azimuth], axis=1)
    line = hairline(azimuth, person.looks.recess) + 0.05 * (noise(places, 0.014, 12) - 0.5)
    dense = step(-0.085, 0.045, elevation - line)
    hairs = step(0.0, 0.2, dense) * step(-0.45, 0.35, 1.2 * dense - noise(turned, 1.0, 11))
    hair = np.array(person.looks.hair, float)
    deep = 0.62 + 0.14 * min(float(hair.mean()), 80.0) / 160.0  # between light hairs it is less dark
    dark = hair * (deep + 0.3 * noise(turned, 0.9, 13))[:, None]
    return _mix(_mix(colour, dark, 0.30 * dense), dark, 0.90 * hairs)


def _heights(person: Person, head: Head, mm: F8, places: F8) -> F8:
    """Pores, creases of the lips and lids, lines of age [m]."""
    age = person.face.age
    pores = 0.00006 * noise(places, 0.0013, 21) + 0.00010 * noise(places, 0.0034, 22)
    lid = _spot(mm, 31.0, 9.3 + 0.6 * person.face.eyes, 13.0, 0.9)
    brow_lines = sum(np.exp(-(((mm[:, 1] - y - 1.6 * np.cos(0.09 * mm[:, 0])) / 1.1) ** 2)) for y in (38.0, 47.0, 56.0))
    brow_lines = brow_lines * step(48.0, 25.0, np.abs(mm[:, 0])) * step(30.0, 60.0, mm[:, 2])
    feet = sum(_spot(mm, 54.0, y, 7.0, 0.8) for y in (-6.0, 0.0, 5.0))
    fold = (
        np.exp(-(((np.abs(mm[:, 0]) - 22.0 - 0.26 * (-40.0 - mm[:, 1])) / 1.6) ** 2))
        * step(-38.0, -44.0, mm[:, 1])
        * step(-72.0, -62.0, mm[:, 1])
    )
    lips = step(9.0, 7.0, np.abs(mm[:, 1] + 65.0)) * step(26.0, 20.0, np.abs(mm[:, 0])) * step(60.0, 75.0, mm[:, 2])
    creases = lips * 0.00016 * noise(places * [3.0, 0.5, 1.0], 0.0022, 23)
    result: F8 = pores + creases - 0.0005 * lid - age * (0.0006 * brow_lines + 0.00055 * feet + 0.0007 * fold)
    return result
