"""The skin from neck to wrists and ankles as one surface in rings: loops at every joint, the same for everybody."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np

from assets.builders.avatars.fields import F8, Field
from assets.builders.avatars.flesh import NECK_BASE, Flesh
from assets.builders.avatars.person import Person
from assets.builders.avatars.sheet import I8, Sheet, settle
from assets.builders.avatars.skeleton import Skeleton, arm_axes

__all__ = ["ARM_ROWS", "AROUND", "LEG_ROWS", "LIMB_AROUND", "Cage", "make_cage"]

AROUND, LIMB_AROUND = 32, 20
"""Vertices of a ring of the trunk, and of an arm or a leg."""

_TRUNK_ROWS = (
    # heights in statures: before, beside, behind
    (0.468, 0.478, 0.470), (0.490, 0.498, 0.490), (0.512, 0.518, 0.511), (0.535, 0.540, 0.535), (0.560, 0.564, 0.562),
    (0.586, 0.588, 0.588), (0.612, 0.612, 0.614), (0.638, 0.638, 0.640), (0.664, 0.664, 0.666), (0.690, 0.690, 0.692),
    (0.712, 0.714, 0.716), (0.732, 0.736, 0.738), (0.748, 0.754, 0.756), (0.762, 0.768, 0.774), (0.775, 0.785, 0.793),
    (0.787, 0.802, 0.811), (0.797, 0.824, 0.828),
)  # fmt: skip
"""From the crotch to the tops of the shoulders."""

_HOLE_LOW, _HOLE_HIGH = 12, 16
_HOLE = (5, 11)
"""Rows and columns of the trunk that bound the left armhole."""
_YOKE = (0.36, 0.70)
"""Rows between the tops of the shoulders and the root of the neck."""
_NECK_TOP = (0.846, 0.864, 0.876)
"""Where the head begins, in statures: before, beside, behind."""

ARM_ROWS = (0.12, 0.26, 0.46, 0.68, 0.84, 0.94, 1.0, 1.07, 1.18, 1.42, 1.72, 2.0)
"""From the shoulder, 0, by the elbow, 1, to the wrist, 2."""
LEG_ROWS = (0.09, 0.20, 0.38, 0.60, 0.80, 0.92, 1.0, 1.07, 1.18, 1.36, 1.60, 1.82, 2.0)
"""From the hip, 0, by the knee, 1, to the ankle, 2."""

_ROUNDS = 14
_APART = 0.003
"""Smallest distance of each leg from the plane of symmetry [m]."""
_CROTCH = 3


@dataclass(frozen=True)
class Cage:
    """The surface and its rings.

    Attributes:
        places: Vertices [m], [n, 3].
        faces: Quadrilaterals; wrists, ankles and neck stay open.
        trunk: Vertices by row and column, column 0 before, 8 left; -1 within the armholes; the last two rows are the
            root of the neck and where the head begins, [rows, 32].
        arms, legs: By side (1: left, -1: right), row and place around; row 0 is where they leave the trunk, [rows, 20].
    """

    places: F8
    faces: list[tuple[int, ...]]
    trunk: I8
    arms: dict[int, I8]
    legs: dict[int, I8]


def make_cage(person: Person, bones: Skeleton, flesh: Flesh) -> Cage:
    """Lay the rings on the surface of a person's body."""
    sheet = Sheet()
    trunk = _trunk_rings(sheet, person, flesh)
    arms = {side: _arm_rings(sheet, trunk, bones, flesh.arms[side], side) for side in (1, -1)}
    crotch = _crotch(sheet, trunk, person)
    legs = {side: _leg_rings(sheet, trunk, crotch, bones, flesh.legs[side], side) for side in (1, -1)}
    places = sheet.places()
    free = np.zeros(len(places))
    free[trunk[9:-2][trunk[9:-2] >= 0]] = 1.0
    free[trunk[:5].ravel()] = 0.7
    free[trunk[7:9].ravel()] = 0.3
    free[crotch] = 0.8
    for side in (1, -1):
        free[arms[side][1:4].ravel()] = np.repeat([0.9, 0.6, 0.2], LIMB_AROUND)
        free[arms[side][0]] = 1.0
        free[legs[side][1:4].ravel()] = np.repeat([0.9, 0.8, 0.5], LIMB_AROUND)
    places = settle(places, sheet.faces, free, flesh.whole, _ROUNDS)
    places[crotch, 0] = 0.0
    for side in (1, -1):
        rows = legs[side][1:]
        places[rows, 0] = side * np.maximum(side * places[rows, 0], _APART)
    return Cage(places, sheet.faces, trunk, arms, legs)


def reach(field: Field, start: F8, directions: F8, first: float = 0.012) -> F8:
    """Return where rays that begin inside a field leave it, [n, 3]: starts [n, 3] or [3], unit directions [n, 3]."""
    far = np.full(len(directions), first)
    for _ in range(40):
        far -= 0.85 * field.at(start + far[:, None] * directions)
        far = np.clip(far, 1e-3, 0.4)
    result: F8 = start + far[:, None] * directions
    return result


def _level(heights: tuple[float, float, float], turn: F8) -> F8:
    before, beside, behind = heights
    c = np.cos(turn)
    return beside + 0.5 * (before - behind) * c + (0.5 * (before + behind) - beside) * c * c


def _trunk_rings(sheet: Sheet, person: Person, flesh: Flesh) -> I8:
    h = person.body.stature
    turn = 2.0 * math.pi * np.arange(AROUND) / AROUND
    directions = np.stack([1.35 * np.sin(turn), np.zeros(AROUND), np.cos(turn)], axis=1)
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)

    def ring(heights: tuple[float, float, float], aim: F8, back: float) -> F8:
        start = np.stack([np.zeros(AROUND), _level(heights, turn) * h, np.full(AROUND, back)], axis=1)
        return reach(flesh.trunk, start, aim)

    rows = [ring(heights, directions, -0.012) for heights in _TRUNK_ROWS]
    around = np.stack([np.sin(turn), np.zeros(AROUND), np.cos(turn)], axis=1)
    base, top = ring(NECK_BASE, around, -0.030), ring(_NECK_TOP, around, -0.018)
    rows += [(1.0 - share) * rows[-1] + share * base for share in _YOKE] + [base, top]
    trunk = np.full((len(rows), AROUND), -1, np.int64)
    hole = np.zeros_like(trunk, np.bool_)
    for low, high in (_HOLE, (AROUND - _HOLE[1], AROUND - _HOLE[0])):
        hole[_HOLE_LOW + 1 : _HOLE_HIGH, low + 1 : high] = True
    for row, places in enumerate(rows):
        trunk[row, ~hole[row]] = sheet.add(places[~hole[row]])
    _join_trunk(sheet, trunk)
    return trunk


def _join_trunk(sheet: Sheet, trunk: I8) -> None:
    for row in range(len(trunk) - 1):
        for column in range(AROUND):
            following = (column + 1) % AROUND
            mirrored = min(column, AROUND - 1 - column)
            if _HOLE_LOW <= row < _HOLE_HIGH and _HOLE[0] <= mirrored < _HOLE[1]:
                continue
            corners = (trunk[row, column], trunk[row, following], trunk[row + 1, following], trunk[row + 1, column])
            sheet.faces.append((int(corners[0]), int(corners[1]), int(corners[2]), int(corners[3])))


def _hole_ring(trunk: I8, side: int) -> I8:
    """Return the rim of an armhole, from its lowest vertex by the back over the top and down the front, [20]."""
    low, high = _HOLE
    middle = (low + high) // 2
    rim = [(_HOLE_LOW, column) for column in range(middle, high + 1)]
    rim += [(row, high) for row in range(_HOLE_LOW + 1, _HOLE_HIGH + 1)]
    rim += [(_HOLE_HIGH, column) for column in range(high - 1, low - 1, -1)]
    rim += [(row, low) for row in range(_HOLE_HIGH - 1, _HOLE_LOW - 1, -1)]
    rim += [(_HOLE_LOW, column) for column in range(low + 1, middle)]
    return np.array([trunk[row, column if side > 0 else -column % AROUND] for row, column in rim])


def _arm_rings(sheet: Sheet, trunk: I8, bones: Skeleton, field: Field, side: int) -> I8:
    word = "left" if side > 0 else "right"
    along, back, thumb = arm_axes(side)
    joints = [bones.place(f"{word}{name}") for name in ("UpperArm", "LowerArm", "Hand")]
    turn = 2.0 * math.pi * np.arange(LIMB_AROUND) / LIMB_AROUND
    directions = -np.cos(turn)[:, None] * back - np.sin(turn)[:, None] * thumb
    rings = [_hole_ring(trunk, side)]
    for row in ARM_ROWS:
        part = min(int(row), 1)
        middle = joints[part] + (row - part) * (joints[part + 1] - joints[part])
        lean = 0.75 * max(1.0 - row / 0.40, 0.0)  # near the shoulder the rings turn towards the armhole
        places = reach(field, middle, directions)
        places += lean * ((places - middle) @ back)[:, None] * along * -0.55
        rings.append(sheet.add(places))
    for lower, upper in itertools.pairwise(rings):
        sheet.join(lower, upper, flip=side < 0)
    return np.array(rings)


def _crotch(sheet: Sheet, trunk: I8, person: Person) -> I8:
    """Add the vertices between the legs from back to front, [3]."""
    behind, before = sheet.corners[trunk[0, AROUND // 2]], sheet.corners[trunk[0, 0]]
    share = (np.arange(_CROTCH) + 1.0) / (_CROTCH + 1)
    places = behind + share[:, None] * (before - behind)
    places[:, 1] = 0.462 * person.body.stature
    places[:, 0] = 0.0
    return sheet.add(places)


def _leg_rings(sheet: Sheet, trunk: I8, crotch: I8, bones: Skeleton, field: Field, side: int) -> I8:
    word = "left" if side > 0 else "right"
    joints = [bones.place(f"{word}{name}") for name in ("UpperLeg", "LowerLeg", "Foot")]
    turn = 0.5 * math.pi + 2.0 * math.pi * (np.arange(LIMB_AROUND) - 8.0) / LIMB_AROUND
    directions = np.stack([side * np.sin(turn), np.zeros(LIMB_AROUND), np.cos(turn)], axis=1)
    half = AROUND // 2
    outer = [trunk[0, column if side > 0 else -column % AROUND] for column in range(half + 1)]
    rings = [np.array([*outer, *crotch])]
    for row in LEG_ROWS:
        part = min(int(row), 1)
        begin = joints[part]
        if part == 0:  # the first row lies below the crotch
            begin = begin - [0.0, 0.105 * (joints[0][1] - joints[1][1]) + 0.012, 0.0]
        middle = begin + (row - part) * (joints[part + 1] - begin)
        rings.append(sheet.add(reach(field, middle, directions)))
    for lower, upper in itertools.pairwise(rings):
        sheet.join(lower, upper, flip=side > 0)
    return np.array(rings)
