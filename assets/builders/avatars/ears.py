"""Ears: helix, groove, antihelix, bowl and lobe as rings about the bowl, from the skull behind to the bowl's floor."""

from __future__ import annotations

import numpy as np

from assets.builders.avatars.cage import reach
from assets.builders.avatars.face_map import turns_of
from assets.builders.avatars.face_mesh import face_uvs, welded_normals
from assets.builders.avatars.face_shape import Head
from assets.builders.avatars.fields import F8
from assets.builders.avatars.piece import Piece, joined
from assets.builders.avatars.sheet import Sheet, triangles_of
from assets.builders.avatars.skeleton import Skeleton
from assets.builders.avatars.weights import rigid

__all__ = ["make_ears"]

_MIDDLE = (-7.0, -6.0)
"""Middle of an ear on the side of the plain head: up and ahead [mm]."""
_LEAST = 0.8
"""Smallest height of an ear's front over the skull [mm]."""
_LEAN = 0.22
"""Backward lean of the ear's long axis [1]."""
_OUTLINE = np.array([
    (10.0, 0.0, 2.0), (11.6, 9.0, 2.5), (11.4, 18.5, 4.5), (6.0, 26.5, 9.0), (-2.5, 30.5, 13.0), (-11.5, 28.0, 16.0),
    (-17.6, 20.0, 18.0), (-19.4, 9.0, 18.5), (-18.2, -3.0, 18.0), (-14.4, -13.5, 15.5), (-8.6, -22.0, 12.0),
    (-2.2, -28.6, 9.0), (4.4, -28.4, 5.5), (8.6, -18.5, 2.5), (9.6, -8.5, 2.0),
])  # fmt: skip
"""Rim from the tragus up by the helix, back and down to the lobe: ahead, up, and height over the skull [mm]; real ears
stand off by 15 to 20 mm at the back."""
_ROLLED = np.array([0.0, 0.3, 0.8, 1.0, 1.0, 1.0, 1.0, 1.0, 0.9, 0.6, 0.2, 0.0, 0.0, 0.0, 0.0])
"""Depth of the groove between helix and antihelix, 1 along the helix, 0 at the lobe and before the bowl."""
_TRAGUS = np.array([1.0, 0.4, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.15, 0.0, 0.0, 0.7])
"""Height of the flap before the bowl."""
_BOWL = (1.5, -5.0)
"""Middle of the bowl [mm]."""
_SHADES = (0.55, 0.80, 1.0, 0.74, 0.95, 0.48)
"""Of the rings, from behind over the rim to the bowl; then of its middle, 0.34."""


def make_ears(head: Head, bones: Skeleton) -> Piece:
    """Return two ears, skin of the head."""
    parts = []
    for side in (1, -1):
        sheet = Sheet()
        rim = None
        for ring in _rings():
            corners = sheet.add(_place(head, side, ring))
            if rim is None:
                sheet.cap(corners, head.mark(side * 62.0, -7.0, -6.0), flip=side < 0)
            else:
                sheet.join(rim, corners, flip=side > 0)
            rim = corners
        assert rim is not None
        sheet.close(rim, _place(head, side, np.array([[*_BOWL, 0.5]]))[0])
        places = sheet.places()
        triangles = triangles_of(sheet.faces, places)
        turns = turns_of(places - head.middle)
        turns[:, 1] = np.minimum(turns[:, 1], 0.0)  # bare skin: above, the texture has hair
        count = len(_OUTLINE)
        behind, *others = _SHADES
        shades = np.repeat([behind, behind, *others, 0.34], [count, 1, *[count] * len(others), 1])[:, None]
        parts.append(
            Piece("skin_head", places, welded_normals(places, triangles), face_uvs(turns), triangles,
                  rigid(bones, "head", len(places)), shades * np.array([1.0, 0.94, 0.91]))
        )  # fmt: skip
    return joined(parts)


def _rings() -> list[F8]:
    """Return the rings about the bowl: ahead, up, and height over the skull [mm], [15, 3] each."""
    flat, high = _OUTLINE[:, :2] - _BOWL, _OUTLINE[:, 2]
    edge = np.maximum(high, 0.6)

    def ring(share: float | F8, height: F8) -> F8:
        return np.column_stack([flat * np.reshape(share, (-1, 1)) + _BOWL, height])

    return [
        ring(0.66, np.full(len(high), -7.0)),
        ring(0.98, 0.86 * high - 1.5),
        ring(0.97 - 0.02 * _ROLLED, edge + 1.0 * _ROLLED + 1.5 * _TRAGUS),
        ring(0.80, edge - 4.2 * _ROLLED + 3.4 * _TRAGUS),
        ring(0.60 + 0.06 * _TRAGUS, 0.86 * edge + 0.4 * _ROLLED + 4.0 * _TRAGUS),
        ring(0.40, np.minimum(0.30 * edge, 2.0)),
    ]


def _place(head: Head, side: int, rows: F8) -> F8:
    """Return places of points given ahead, up and out of the skull before the ear [mm], [n, 3], none under the skin."""
    y, z = _MIDDLE
    flat = np.column_stack([np.zeros(len(rows)), y + rows[:, 1], z + rows[:, 0] - _LEAN * rows[:, 1]])
    skull = _skull(head, flat)
    plane = _skull(head, np.array([[0.0, y, z + _OUTLINE[0, 0]]]))
    above = skull + np.minimum(rows[:, 2], _LEAST)
    out = np.where(rows[:, 2] < 0.0, above, np.maximum(plane + rows[:, 2], above))
    return np.array([head.mark(side * x, *at) for x, at in zip(out, flat[:, 1:], strict=True)])


def _skull(head: Head, flat: F8) -> F8:
    """Return how far the left side of the head stands out at heights and depths [mm], [n]."""
    start = np.array([head.mark(*at) for at in flat])
    sides = reach(head.field, start, np.tile([1.0, 0.0, 0.0], (len(flat), 1)), 0.06)
    return np.asarray(sides[:, 0] / (1e-3 * head.size[0]))
