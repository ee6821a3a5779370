"""Hands: a palm that carries on the rings of the wrist, a thumb at its side, four fingers with webs between."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np

from assets.builders.avatars.cage import LIMB_AROUND
from assets.builders.avatars.fields import F8, step
from assets.builders.avatars.sheet import I8, Sheet, neighbour_means
from assets.builders.avatars.skeleton import FINGERS, Skeleton, arm_axes

__all__ = ["Hand", "make_hand"]

_DORSAL = {"Little": (6, 7, 8), "Ring": (8, 9, 10), "Middle": (10, 11, 12), "Index": (12, 13, 14)}
"""Vertices of the last ring of the palm on the back of the hand at the root of each finger, from the little side."""
_PALMAR = {"Little": (4, 3, 2), "Ring": (2, 1, 0), "Middle": (0, 19, 18), "Index": (18, 17, 16)}
_FOUR = ("Little", "Ring", "Middle", "Index")
_ROUND = 8
"""Vertices around a finger, from the palm's side by the little finger's to the back."""
_RADII = {"Thumb": 0.0108, "Index": 0.0086, "Middle": 0.0089, "Ring": 0.0083, "Little": 0.0073}
"""Half the breadth of each finger at its middle joint, of a hand 190 mm long [m]."""
_PALM = (
    # share of the way to the knuckles, half breadth, half thickness, shift to the thumb [m]
    (0.16, 0.0290, 0.0175, 0.001), (0.38, 0.0350, 0.0170, 0.002), (0.62, 0.0395, 0.0155, 0.001),
    (0.86, 0.0415, 0.0138, -0.002),
    (1.10, 0.0405, 0.0115, -0.003),
)  # fmt: skip
_THUMB_ROWS, _THUMB_COLUMNS = (1, 3), (14, 16)
"""Of the palm, which bound the root of the thumb."""


@dataclass(frozen=True)
class Hand:
    """A hand from the ring of the wrist on.

    Attributes:
        places: Vertices [m], [n, 3]; the first 20 are the wrist's ring.
        faces: Between them.
        weights: Of every joint, [n, joints].
        finger: Finger of each vertex, 0 thumb to 4 little, -1 the palm, [n].
        along: Position of each vertex along a finger, in bones from the knuckle, 0 to 3, [n].
    """

    places: F8
    faces: list[tuple[int, ...]]
    weights: F8
    finger: I8
    along: F8


class _Shaping:
    """A hand under construction."""

    def __init__(self, bones: Skeleton, side: int, size: float) -> None:
        self.bones, self.side, self.size = bones, side, size
        self.word = "left" if side > 0 else "right"
        self.axes = arm_axes(side)
        self.wrist = bones.place(f"{self.word}Hand")
        self.sheet = Sheet()
        self.weights: list[F8] = []
        self.finger: list[int] = []
        self.along: list[float] = []

    def joint(self, name: str) -> int:
        return self.bones.index(f"{self.word}{name}")

    def add(self, places: F8, shares: dict[int, float], finger: int = -1, along: float = 0.0) -> I8:
        row = np.zeros(len(self.bones.names))
        for joint, share in shares.items():
            row[joint] += share
        self.weights += [row] * len(places)
        self.finger += [finger] * len(places)
        self.along += [along] * len(places)
        return self.sheet.add(places)


def make_hand(bones: Skeleton, side: int, length: float, wrist_ring: F8, wrist_weights: F8) -> Hand:
    """The hand at the end of an arm.

    Args:
        bones: Joints.
        side: 1: left, -1: right.
        length: Of the hand [m].
        wrist_ring: Last ring of the arm [m], [20, 3].
        wrist_weights: Of that ring.
    """
    shaping = _Shaping(bones, side, length / 0.190)
    ring = shaping.add(wrist_ring, {})
    shaping.weights[:LIMB_AROUND] = list(wrist_weights)
    rows = [ring, *_palm(shaping)]
    _join_palm(shaping, rows)
    _fingers(shaping, rows[-1])
    _thumb(shaping, rows)
    places, weights = shaping.sheet.places(), np.array(shaping.weights)
    loose = np.array([1.0 if f < 0 or a < 0.3 else 0.0 for f, a in zip(shaping.finger, shaping.along, strict=True)])
    loose[:LIMB_AROUND] = 0.0
    for _ in range(3):
        places = places + 0.35 * loose[:, None] * (neighbour_means(len(places), shaping.sheet.faces, places) - places)
    for _ in range(2):
        weights = weights + 0.4 * loose[:, None] * (
            neighbour_means(len(weights), shaping.sheet.faces, weights) - weights
        )
    return Hand(places, shaping.sheet.faces, weights, np.array(shaping.finger), np.array(shaping.along))


def _palm(shaping: _Shaping) -> list[I8]:
    along, back, thumb = shaping.axes
    turn = 2.0 * math.pi * np.arange(LIMB_AROUND) / LIMB_AROUND
    c, s = -np.cos(turn), -np.sin(turn)
    # the corners lie evenly along the breadth, five spaces on each side, and the flat of the hand is hollow
    across = np.sign(s) * np.abs(s)
    flat = np.sign(c) * np.abs(c) ** 0.55
    rows = []
    for share, wide, thick, shift in _PALM:
        far = shaping.size * 0.088 * share
        breadth = shaping.size * (wide * np.arcsin(across) / (0.5 * math.pi) + shift)
        bow = -0.10 * (breadth / shaping.size / wide) ** 2 * wide * step(0.2, 0.8, np.array([share]))[0]
        hollow = np.where(c < 0.0, 0.0030 * step(0.2, 0.6, np.array([share]))[0] * np.cos(0.5 * math.pi * across), 0.0)
        rise = shaping.size * (thick * flat + bow + hollow + 0.002)
        reach = far - shaping.size * 0.016 * step(0.3, 1.0, np.array([share]))[0] * np.maximum(-across, 0.0) ** 2
        places = shaping.wrist + reach[:, None] * along + rise[:, None] * back + breadth[:, None] * thumb
        rows.append(shaping.add(places, {shaping.joint("Hand"): 1.0}))
    return rows


def _join_palm(shaping: _Shaping, rows: list[I8]) -> None:
    for number in range(len(rows) - 1):
        for k in range(LIMB_AROUND):
            j = (k + 1) % LIMB_AROUND
            in_hole = _THUMB_ROWS[0] <= number < _THUMB_ROWS[1] and _THUMB_COLUMNS[0] <= k < _THUMB_COLUMNS[1]
            if in_hole:
                continue
            face = (int(rows[number][k]), int(rows[number][j]), int(rows[number + 1][j]), int(rows[number + 1][k]))
            shaping.sheet.faces.append(face if shaping.side > 0 else face[::-1])


def _fingers(shaping: _Shaping, last: I8) -> None:
    """Webs between the fingers, then the fingers on what is left of the ring."""
    places = shaping.sheet.corners
    webs: dict[tuple[str, str], int] = {}
    for one, two in itertools.pairwise(_FOUR):
        low, high = places[last[_PALMAR[one][2]]], places[last[_DORSAL[one][2]]]
        middle = 0.5 * (low + high) + shaping.size * 0.002 * shaping.axes[0]
        webs[one, two] = int(shaping.add(middle[None], {shaping.joint("Hand"): 1.0})[0])
    for number, name in enumerate(_FOUR):
        little = int(last[5]) if number == 0 else webs[_FOUR[number - 1], name]
        thumb = int(last[15]) if number == 3 else webs[name, _FOUR[number + 1]]
        palmar, dorsal = (last[list(table[name])] for table in (_PALMAR, _DORSAL))
        ring = [palmar[1], palmar[0], little, dorsal[0], dorsal[1], dorsal[2], thumb, palmar[2]]
        _finger(shaping, name, np.array(ring, np.int64))


def _finger(shaping: _Shaping, name: str, root: I8) -> None:
    names = [f"{name}{kind}" for kind in ("Proximal", "Intermediate", "Distal")]
    stations = (
        # bone, share of it, radius as a share: across, thick; share of the next joint
        (0, 0.62, 1.02, 1.04, 0.0), (0, 0.88, 1.05, 1.04, 0.28), (1, 0.10, 1.02, 1.00, 0.72),
        (1, 0.52, 0.94, 0.94, 1.0),
        (1, 0.90, 0.93, 0.91, 1.35), (2, 0.20, 0.89, 0.85, 1.85), (2, 0.62, 0.84, 0.76, 2.0),
        (2, 0.93, 0.64, 0.52, 2.0),
    )  # fmt: skip
    _tube(shaping, name, names, root, stations, shaping.axes[1])


def _thumb(shaping: _Shaping, rows: list[I8]) -> None:
    (low, high), (first, last) = _THUMB_ROWS, _THUMB_COLUMNS
    a, b, c = rows[low], rows[(low + high) // 2], rows[high]
    root = [a[first + 1], a[last], b[last], c[last], c[first + 1], c[first], b[first], a[first]]
    names = [f"Thumb{kind}" for kind in ("Metacarpal", "Proximal", "Distal")]
    stations = (
        (0, 0.62, 1.36, 1.30, 0.0), (0, 0.92, 1.12, 1.06, 0.4), (1, 0.40, 0.96, 0.96, 0.95),
        (1, 0.88, 0.97, 0.92, 1.35), (2, 0.28, 0.97, 0.84, 1.9), (2, 0.68, 0.87, 0.69, 2.0), (2, 0.93, 0.64, 0.48, 2.0),
    )  # fmt: skip
    # the ring of the root starts at the side towards the wrist and turns by the palm
    _tube(shaping, "Thumb", names, np.array(root, np.int64), stations, shaping.axes[0], quarter=True)


def _tube(
    shaping: _Shaping,
    name: str,
    names: list[str],
    root: I8,
    stations: tuple[tuple[int, float, float, float, float], ...],
    back: F8,
    *,
    quarter: bool = False,
) -> None:
    """Rings along the bones of a finger and its tip; the ring's fifth corner points to `back`, or away from it."""
    word, finger = shaping.word, FINGERS.index(name)
    joints = [shaping.bones.place(f"{word}{each}") for each in names] + [shaping.bones.tips[f"{word}{name}Tip"]]
    indices = [shaping.joint(each) for each in names]
    radius = shaping.size * _RADII[name]
    turn = 2.0 * math.pi * np.arange(_ROUND) / _ROUND
    for bone, share, wide, thick, carried in stations:
        span = joints[bone + 1] - joints[bone]
        axis = span / np.linalg.norm(span)
        before = joints[bone] - joints[max(bone - 1, 0)] if bone else span
        if share < 0.3:
            axis = axis + before / max(float(np.linalg.norm(before)), 1e-9)
            axis /= np.linalg.norm(axis)
        top = back - (back @ axis) * axis
        top /= np.linalg.norm(top)
        beside = np.cross(axis, top) * shaping.side
        if quarter:
            # corners: towards the wrist, the palm, the fingers, the back of the hand
            one, two, wide_, thick_ = -top, -np.cross(axis, top) * shaping.side, wide, thick
            places = radius * (wide_ * np.cos(turn)[:, None] * one + thick_ * np.sin(turn)[:, None] * two)
        else:
            flat = np.where(np.cos(turn) < -0.5, thick, thick * 1.04)
            places = radius * (-(flat * np.cos(turn))[:, None] * top - (wide * np.sin(turn))[:, None] * beside)
        middle = joints[bone] + share * span
        low = min(int(carried), 1)
        shares = {indices[low]: 1.0 - (carried - low), indices[low + 1]: carried - low}
        ring = shaping.add(middle + places, shares, finger, bone + share)
        shaping.sheet.join(root, ring, flip=shaping.side < 0)
        root = ring
    tip = joints[-1] + 0.0002 * axis
    shaping.sheet.close(root, tip)
    shaping.weights.append(np.eye(len(shaping.bones.names))[indices[2]])
    shaping.finger.append(finger)
    shaping.along.append(3.0)
