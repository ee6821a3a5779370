"""The shape of a head: a smooth skin over landmarks, then nose, lips, chin and lids as blended forms.

Landmarks are in millimetres from the middle of the head: x to the person's left, y up from the level of the pupils,
z ahead of the plane of the ear canals; they describe a plain adult face, and `Face` says how a person departs from it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from assets.builders.avatars.fields import F8, Ball, Blend, Field, Loft
from assets.builders.avatars.person import Face, Person
from assets.builders.avatars.skeleton import Skeleton

__all__ = ["EYE_RADIUS", "Head", "lid_lines", "make_head", "over_eye"]

EYE_RADIUS = 0.0121
"""Radius of an eyeball [m] (Bekerman et al. 2014: axial length 24.2 mm in the mean of adults)."""

_MARKS = {
    # midline
    "crown": (0, 114, -14), "vertex": (0, 107, 36), "hairline": (0, 78, 79), "forehead": (0, 48, 95),
    "glabella": (0, 20, 99),
    "sellion": (0, 4, 94), "under_nose": (0, -46, 98), "lip_top": (0, -58, 98), "stomion": (0, -65, 97),
    "lip_low": (0, -74, 96), "chin_fold": (0, -83, 95.2), "pogonion": (0, -98, 100), "menton": (0, -110, 92),
    "under_chin": (0, -111, 66), "throat": (0, -106, 42), "back_top": (0, 84, -68), "back": (0, 34, -96),
    "inion": (0, -22, -88), "nape": (0, -62, -70),
    # one side
    "crown_side": (40, 102, -12), "front_side": (38, 74, 67), "temple_top": (58, 50, 52), "temple": (66, 18, 50),
    "forehead_side": (34, 46, 84), "euryon": (77, 42, -14), "side_top": (66, 74, -16), "ear_top": (74, 8, -2),
    "ear_low": (70, -28, 2), "mastoid": (64, -38, -24), "back_side": (58, 34, -74), "back_low": (52, -26, -68),
    "back_high": (48, 78, -56), "brow_in": (14, 17, 97), "brow_mid": (32, 19, 93.5), "brow_out": (51, 13, 76),
    "orbit_out": (55, -2, 68), "orbit_low": (31, -19, 86.5), "orbit_in": (14, -4, 86), "nose_side": (16, -22, 88),
    "cheekbone": (50, -20, 74), "zygion": (68, -16, 42), "malar": (42, -31, 82), "fold": (25, -46, 90),
    "cheek": (42, -54, 75), "cheek_back": (58, -48, 44), "mouth_corner": (27, -66, 90), "beside_lip": (36, -70, 82),
    "gonion": (53, -70, 14), "jaw": (45, -88, 48), "jaw_front": (29, -102, 78), "chin_side": (18, -104, 91),
    "below_jaw": (31, -102, 42), "below_ear": (58, -56, -10),
}  # fmt: skip

_MM = 1e-3
_SMOOTH = 2e-4
"""Smoothing of the skin over landmarks: a little, so that it does not ripple."""


@dataclass(frozen=True)
class Head:
    """The head of a person.

    Attributes:
        middle: Origin of the landmarks' frame [m], [3].
        field: Skin of head and neck without ears [m].
        eyes: Centres of the left and of the right eyeball, [2, 3].
        gape: Half width of the opening of the lids [m].
        mouth: Half width of the mouth [m].
        stomion: Point of the midline at which the lips meet [m], [3].
        size: Breadth, height and depth as factors on the plain head, [3].
    """

    middle: F8
    field: Field
    eyes: F8
    gape: float
    mouth: float
    stomion: F8
    size: F8

    def mark(self, x: float, y: float, z: float) -> F8:
        """Return a point given in millimetres of the plain head, in the body's frame [m]."""
        place: F8 = self.middle + self.size * np.array([x, y, z]) * _MM
        return place


class _Skin:
    """Radial distance to a skin over landmarks: a thin plate spline over directions (Duchon 1977)."""

    def __init__(self, middle: F8, marks: F8) -> None:
        self._middle = middle
        away = np.linalg.norm(marks, axis=1)
        self._knots = marks / away[:, None]
        count = len(marks)
        rows = self._rows(self._knots)
        matrix = np.zeros((count + 4, count + 4))
        matrix[:count, :count] = rows[:, :count] + _SMOOTH * np.eye(count)
        matrix[:count, count:] = rows[:, count:]
        matrix[count:, :count] = rows[:, count:].T
        self._weights = np.linalg.solve(matrix, np.concatenate([away, np.zeros(4)]))

    def _rows(self, units: F8) -> F8:
        apart = np.maximum(2.0 - 2.0 * units @ self._knots.T, 0.0)  # squared distances of unit vectors
        return np.concatenate([apart * np.log(np.maximum(apart, 1e-12)), np.ones((len(units), 1)), units], axis=1)

    def at(self, places: F8) -> F8:
        """As `Field`."""
        offset = places - self._middle
        away = np.maximum(np.linalg.norm(offset, axis=1), 1e-6)
        result: F8 = 0.92 * (away - self._rows(offset / away[:, None]) @ self._weights)
        return result


class _Pressed:
    """A field with soft dents and swellings: (place, spread [m], height [m]) each; the height is outwards."""

    def __init__(self, base: Field, marks: list[tuple[F8, F8, float]]) -> None:
        self._base, self._marks = base, marks

    def at(self, places: F8) -> F8:
        """As `Field`."""
        total = self._base.at(places)
        for place, spread, height in self._marks:
            total = total - height * np.exp(-(((places - place) / spread) ** 2).sum(axis=1))
        return total


def make_head(person: Person, bones: Skeleton, neck: Field) -> Head:
    """The head of a person over their neck."""
    face, body = person.face, person.body
    scale = (0.955 if body.woman else 1.0) * np.array([face.breadth, face.length, 1.0])
    middle = np.array([0.0, body.stature - 0.1145 * scale[1], 0.004])
    eyes = np.array([[side * 31.5, 0.0, 76.5] for side in (1, -1)]) * scale * _MM + middle
    eyes[:, 2] = middle[2] + 76.5 * scale[2] * _MM
    marks = _departed(face, body.woman)
    both = np.array([mark for mark in marks.values()] + [(-x, y, z) for x, y, z in marks.values() if x])
    skin = _Skin(middle, both * scale * _MM)
    head = Head(
        middle, skin, eyes, 0.0150 * face.eyes * scale[0], 0.0255 * face.mouth * scale[0],
        middle + scale * _MM * np.array([0.0, -65.0, 101.5]), scale,
    )  # fmt: skip
    features: Field = Blend([skin, *_nose(head, face), *_lips(head, face)], 0.0055)
    lids = [Ball(eye, (EYE_RADIUS + 0.0016,) * 3) for eye in eyes]
    seated: Field = Blend([_Pressed(features, _dents(head, face, body.woman)), *lids], 0.006)
    whole: Field = Blend([seated, neck], 0.016)
    return Head(middle, whole, eyes, head.gape, head.mouth, head.stomion, scale)


def _departed(face: Face, woman: bool) -> dict[str, tuple[float, float, float]]:
    """The landmarks of a face."""
    marks = {name: (float(x), float(y), float(z)) for name, (x, y, z) in _MARKS.items()}

    def move(name: str, x: float = 0.0, y: float = 0.0, z: float = 0.0) -> None:
        a, b, c = marks[name]
        marks[name] = (a + x, b + y, c + z)

    for name, share in (("glabella", 1.0), ("brow_in", 0.9), ("brow_mid", 0.7), ("brow_out", 0.4)):
        move(name, z=share * face.brow)
    if woman:
        move("forehead", z=2.0)
        move("hairline", z=2.0)
    for name in ("gonion", "jaw", "jaw_front", "below_jaw"):
        x, y, z = marks[name]
        marks[name] = (x * face.jaw, y + (3.0 if woman else 0.0), z)
    for name, share in (
        ("pogonion", 1.0),
        ("menton", 1.0),
        ("chin_side", 0.8),
        ("chin_fold", 0.4),
        ("under_chin", 0.5),
    ):
        move(name, z=share * face.chin)
    for name, share in (("cheekbone", 1.0), ("zygion", 0.8), ("malar", 0.6)):
        move(name, x=share * face.cheek, z=0.4 * share * face.cheek)
    for name, share in (("cheek", 1.0), ("beside_lip", 0.6), ("cheek_back", 0.8), ("jaw", 0.6), ("below_jaw", 0.6)):
        move(name, x=share * face.full, z=0.5 * share * face.full)
    move("under_chin", y=-0.6 * face.full)
    return marks


def _nose(head: Head, face: Face) -> list[Field]:
    """Bridge, tip and wings."""
    long, wide, high = face.nose, face.nose_breadth, face.bridge
    tip_y = -36.0 * long
    root = head.mark(0.0, 6.0, 88.0 + 0.5 * high)
    tip = head.mark(0.0, tip_y + 4.0, 106.0 + 0.5 * high)
    bridge = Loft(
        root, tip,
        [(0.0, 0.0062 * wide, 0.0070, 0.0, 0.0), (0.35, 0.0068 * wide, 0.0078, 0.0, 0.0015 + high * _MM),
         (0.7, 0.0078 * wide, 0.0080, 0.0, 0.0015 + 0.5 * high * _MM), (1.0, 0.0088 * wide, 0.0086, 0.0, 0.0)],
    )  # fmt: skip
    parts: list[Field] = [bridge, Ball(head.mark(0.0, tip_y, 108.5), (0.0096 * wide, 0.0086, 0.0096))]
    parts += [Ball(head.mark(side * 11.2 * wide, tip_y - 3.6, 100.5), (0.0062, 0.0068, 0.0096)) for side in (1, -1)]
    parts.append(Ball(head.mark(0.0, tip_y - 7.0, 103.0), (0.0038, 0.0045, 0.0095)))
    return parts


def _lips(head: Head, face: Face) -> list[Field]:
    """Two rolls that meet in the corners."""
    half, full = head.mouth / (head.size[0] * _MM), face.lips
    parts: list[Field] = []
    for side in (1, -1):
        upper_mid, upper_end = head.mark(0.0, -61.0, 98.4), head.mark(side * half * 0.92, -64.0, 89.6)
        bow = head.mark(side * 0.36 * half, -60.3, 98.2)
        parts.append(
            Loft(upper_mid, bow, [(0.0, 0.0038 * full, 0.0044, 0.0, 0.0), (1.0, 0.0042 * full, 0.0046, 0.0, 0.0)])
        )
        parts.append(Loft(bow, upper_end, [(0.0, 0.0042 * full, 0.0046, 0.0, 0.0), (1.0, 0.0020, 0.0032, 0.0, 0.0)]))
        lower_mid, lower_end = head.mark(0.0, -70.4, 97.2), head.mark(side * half * 0.86, -65.4, 89.8)
        belly = head.mark(side * 0.38 * half, -70.0, 96.4)
        parts.append(
            Loft(lower_mid, belly, [(0.0, 0.0046 * full, 0.0047, 0.0, 0.0), (1.0, 0.0044 * full, 0.0046, 0.0, 0.0)])
        )
        parts.append(Loft(belly, lower_end, [(0.0, 0.0044 * full, 0.0046, 0.0, 0.0), (1.0, 0.0020, 0.0030, 0.0, 0.0)]))
    return parts


def _dents(head: Head, face: Face, woman: bool) -> list[tuple[F8, F8, float]]:
    """Sockets of the eyes, philtrum, line of the mouth, folds beside nose and mouth, nostrils, temple."""
    mm = np.array([1.0, 1.0, 1.0]) * _MM
    dents = [
        (head.mark(0.0, -52.5, 101.0), np.array([3.0, 5.0, 9.0]) * _MM, -0.0012),
        (head.stomion - [0.0, 0.0, 0.002], np.array([0.92e3 * head.mouth, 1.5, 12.0]) * _MM, -0.0024),
        (head.mark(0.0, -81.0, 100.0), np.array([15.0, 6.0, 10.0]) * _MM, -0.0005),
    ]
    age = 0.35 + 0.65 * face.age
    for side in (1, -1):
        dents += [
            (head.mark(side * 26.0, 9.5, 86.0), 9.0 * mm, -0.0030),
            (head.mark(side * 14.0, 2.0, 88.0), 6.5 * mm, -0.0040),
            (head.mark(side * 46.0, 6.0, 76.0), 8.0 * mm, -0.0010),
            (head.mark(side * 7.0, -36.0 * face.nose - 8.4, 104.0), np.array([3.0, 2.6, 5.0]) * _MM, -0.0034),
            (
                head.mark(side * 17.0 * face.nose_breadth, -36.0 * face.nose - 1.0, 94.0),
                np.array([3.0, 6.0, 6.0]) * _MM,
                -0.0016,
            ),
            (head.mark(side * 28.5, -54.0, 90.0), np.array([4.0, 9.0, 8.0]) * _MM, -0.0012 * age),
            (head.mark(side * 30.0, -72.0, 88.0), np.array([4.0, 5.0, 8.0]) * _MM, -0.0007 * age),
            (head.mark(side * 29.0, -15.0, 86.0), np.array([9.0, 3.5, 8.0]) * _MM, -0.0010 * age),
        ]
    return dents


def lid_lines(head: Head, face: Face, count: int) -> tuple[F8, F8]:
    """Edges of the upper and of the lower lid of the left eye before the eyeball's middle, right and up [m], [n, 2].

    Both run from the inner to the outer corner and share these ends.
    """
    share = 0.5 - 0.5 * np.cos(math.pi * np.linspace(0.0, 1.0, count))
    across = head.gape * (2.0 * share - 1.0)
    base = (-0.6 + (1.6 + face.slant) * share) * _MM
    arch = np.sin(math.pi * share)
    upper = base + 4.5 * _MM * face.eyes * arch**0.80 * (1.0 - 0.16 * (share - 0.42))
    lower = base - 4.5 * _MM * face.eyes * arch**0.95 * (1.0 + 0.35 * (share - 0.5))
    return np.stack([across, upper], axis=1), np.stack([across, lower], axis=1)


def over_eye(eye: F8, flat: F8, side: int, lift: float) -> F8:
    """Places on the lids before an eyeball [m], [n, 3]: `lift` above the ball, and level with the corners beside it.

    Args:
        eye: Middle of the eyeball [m].
        flat: Towards the temple and up from there [m], [n, 2].
        side: 1: left, -1: right.
        lift: [m].
    """
    far = EYE_RADIUS + lift
    ball = np.sqrt(np.maximum(far * far - (flat**2).sum(axis=1), 0.0))
    corner = np.interp(flat[:, 0], [-0.015, 0.015], [0.0072, 0.0018])
    overlap = np.maximum(0.003 - np.abs(ball - corner), 0.0) / 0.003
    depth = np.maximum(ball, corner) + 0.00075 * overlap**2
    places: F8 = eye + np.stack([side * flat[:, 0], flat[:, 1], depth], axis=1)
    return places
