"""Assembly of a person: skin, face, hair and clothes on one skeleton."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, replace

import numpy as np

from assets.builders.avatars.cage import AROUND, Cage, make_cage
from assets.builders.avatars.cloth import Tailor
from assets.builders.avatars.draft import Draft, openness
from assets.builders.avatars.ears import make_ears
from assets.builders.avatars.eyes import make_eyes, make_mouth
from assets.builders.avatars.face_mesh import FaceMesh, face_uvs, make_face
from assets.builders.avatars.face_shape import Head, make_head
from assets.builders.avatars.fields import F8, step
from assets.builders.avatars.flesh import Flesh, make_flesh, make_neck
from assets.builders.avatars.folds import smooth_folds
from assets.builders.avatars.hair import make_hair, make_hair_wisps
from assets.builders.avatars.hand import Hand, make_hand
from assets.builders.avatars.person import Person
from assets.builders.avatars.piece import Piece, joined
from assets.builders.avatars.sheet import corner_normals, near_means, triangles_of
from assets.builders.avatars.skeleton import Skeleton, arm_axes, make_skeleton
from assets.builders.avatars.wardrobe import SLEEVES, cover_of, dress
from assets.builders.avatars.weights import cage_weights, spine_weights

__all__ = ["Figure", "make_figure"]

_HAND_PICTURE = (0.16, 0.21)
"""Extent of a hand on its texture, across and along [m]: the back in the left half, the palm in the right."""
_BREATH = 0.006
"""Rise of the chest in a deep breath [m]."""
_BIB_ROW = 15
_EVENED = 12
"""Rounds in which shades and normals below the jaw are evened out."""
_WITHIN = 0.5
"""Where the bare arm begins, of the way from the last ring within the sleeve to its end."""


@dataclass(frozen=True)
class Figure:
    """A person as triangles.

    Attributes:
        person: Description of the person.
        bones: Joints at rest.
        head: Shape of the head.
        pieces: By name: "head", "eyes", "mouth", "skin", "hair", "wisps" and the clothes.
        face_corners: Number of the head's first vertices that are the outside of the face; mouth, lids' edges and ears
            follow.
    """

    person: Person
    bones: Skeleton
    head: Head
    pieces: dict[str, Piece]
    face_corners: int


def make_figure(person: Person, seed: int) -> Figure:
    """Model a person; `seed` is that of the hair."""
    bones = make_skeleton(person)
    flesh = make_flesh(person, bones)
    cage = make_cage(person, bones, flesh)
    weights = cage_weights(cage, bones)
    tailor = Tailor.of(cage, flesh, weights)
    head = make_head(person, bones, make_neck(person))
    face = make_face(person, head, cage.places[cage.trunk[-1]])
    clothes = {
        name: piece if name == "shoes" else smooth_folds(piece, bones)
        for name, piece in dress(tailor, person, bones).items()
    }
    held = _held_by_sleeves(person, cage, weights, clothes)
    neck = _shared_normals(face, cage)
    pieces = {"skin": smooth_folds(_skin(person, bones, cage, flesh, held, tailor, neck), bones)}
    pieces |= _head_pieces(person, bones, head, face, cage, weights, flesh, neck)
    pieces["hair"] = make_hair(head, bones, person.looks, seed)
    pieces["wisps"] = make_hair_wisps(head, bones, person.looks, seed)
    pieces |= clothes
    for name in ("skin", *(name for name in clothes if name != "shoes")):
        pieces[name] = _breathing(pieces[name], bones)
    return Figure(person, bones, head, pieces, face.outside)


def _head_pieces(
    person: Person, bones: Skeleton, head: Head, face: FaceMesh, cage: Cage, weights: F8, flesh: Flesh, neck: F8
) -> dict[str, Piece]:
    own = spine_weights(bones, face.places)
    own[face.border] = weights[cage.trunk[-1]]
    own[face.inside] = 0.0
    own[face.inside, bones.index("head")] = 1.0
    ring = cage.places[cage.trunk[-1]]
    normals = face.normals.copy()
    normals[face.border] = neck
    normals = _even_below_jaw(normals, face)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    open_ = openness(head.field, face.places, normals)
    below = 0.30 + 0.70 * openness(flesh.trunk, face.places, normals)
    height = face.places[:, 1] - np.interp(np.abs(face.turns[:, 0]), [0.0, math.pi], ring[[0, AROUND // 2], 1])
    high = step(0.0, 0.035, height)
    shades = (below + high * (0.45 + 0.55 * open_ - below))[:, None] * np.ones(3)
    shades = _even_below_jaw(shades, face)
    shades[face.inside] = (0.22, 0.05, 0.05)
    skin = Piece("skin_head", face.places, normals, face_uvs(face.turns), face.triangles, own, shades, face.moves)
    return {
        "head": joined([skin, make_ears(head, bones)]),
        "eyes": make_eyes(head, bones),
        "mouth": make_mouth(head, bones),
    }


def _held_by_sleeves(person: Person, cage: Cage, weights: F8, clothes: dict[str, Piece]) -> F8:
    """Return the cage's weights, with those of the cloth for arms within sleeves, so that they stay inside of it."""
    from scipy.spatial import KDTree

    cover = cover_of(person)
    cloth = next(piece for name, piece in clothes.items() if name in SLEEVES)
    hidden = np.concatenate([cage.arms[side][: cover.arm + 1].ravel() for side in (1, -1)])
    held = weights.copy()
    held[hidden] = cloth.weights[KDTree(cloth.places).query(cage.places[hidden])[1]]
    return held


def _shared_normals(face: FaceMesh, cage: Cage) -> F8:
    """Return normals of the neck's ring by the faces on both sides of it, [32, 3]."""
    places = np.vstack([cage.places, face.places])
    start = len(cage.places)
    triangles = np.vstack([triangles_of(cage.faces, cage.places), face.triangles + start])
    same = np.arange(len(places))
    same[start + face.border] = cage.trunk[-1]
    normals = corner_normals(places, same[triangles])
    result: F8 = normals[cage.trunk[-1]]
    return result


def _even_below_jaw(values: F8, face: FaceMesh) -> F8:
    """Shades or normals evened out below the jaw: triangles are long there, and each vertex that differed a streak."""
    below = step(-0.80, -1.00, face.turns[:, 1])
    below[face.border] = below[face.inside] = 0.0
    means = near_means(face.places, face.triangles)
    for _ in range(_EVENED):
        values = values + 0.6 * below[:, None] * (means @ values - values)
    return values


def _skin(person: Person, bones: Skeleton, cage: Cage, flesh: Flesh, weights: F8, tailor: Tailor, neck: F8) -> Piece:
    """Return the bare skin: root of the neck, arms from within the sleeves, hands, legs from within the hem."""
    cover = cover_of(person)
    parts = [_bib(cage, weights, flesh, neck)]
    for side, word in ((1, "left"), (-1, "right")):
        wrist = cage.arms[side][-1]
        hand = make_hand(bones, side, person.body.hand, cage.places[wrist], weights[wrist])
        parts.append(_arm(cage, flesh, weights, hand, bones, side, word, max(cover.arm - 1, 1), person.body.hand))
        first, last = cover.leg
        if last > first:
            parts.append(tailor.sleeve("skin_body", "legs", side, range(first, last + 1), 0.0, _leg_uv))
    return joined(parts)


def _leg_uv(row: int, place: int) -> tuple[float, float]:
    return 0.05 + 0.9 * place / 20.0, 0.86 + 0.10 * row / 16.0


def _bib(cage: Cage, weights: F8, flesh: Flesh, neck: F8) -> Piece:
    """The root of the neck; its upper ring has the normals `neck` [32, 3] that it shares with the head's skin."""
    draft = Draft(weights.shape[1])
    rows = [cage.trunk[row] for row in range(_BIB_ROW + 1, len(cage.trunk))]
    rings = [draft.add(cage.places[row], weights[row]) for row in rows]
    for number, (one, two) in enumerate(itertools.pairwise(rings)):
        u = [0.05 + 0.9 * i / AROUND for i in range(AROUND + 1)]
        draft.band(one, two, u, (0.96 - 0.02 * number, 0.94 - 0.02 * number))
    for row, flip in ((rows[0], True), (rows[-1], False)):  # rings of their own, or the rims would be shaded as edges
        draft.lid(draft.add(cage.places[row], weights[row]), cage.places[row].mean(axis=0), (0.5, 0.96), flip=flip)
    return draft.finish("skin_body", dim=flesh.trunk, normals=dict(zip(rings[-1].tolist(), neck, strict=True)))


def _arm(
    cage: Cage, flesh: Flesh, weights: F8, hand: Hand, bones: Skeleton, side: int, word: str, first: int, length: float
) -> Piece:
    """Forearm and hand as one surface; the hand's picture is laid from the back and from the palm."""
    draft = Draft(weights.shape[1])
    rows = cage.arms[side][first:]
    begin, held = ((1.0 - _WITHIN) * each[rows[0]] + _WITHIN * each[rows[1]] for each in (cage.places, weights))
    rings = [draft.add(begin, held), *(draft.add(cage.places[row], weights[row]) for row in rows[1:-1])]
    own = draft.add(hand.places, hand.weights)
    rings.append(own[: len(rows[0])])
    u = [0.05 + 0.9 * i / len(rows[0]) for i in range(len(rows[0]) + 1)]
    for number, (one, two) in enumerate(itertools.pairwise(rings)):
        draft.band(one, two, u, (0.84 + 0.008 * number, 0.848 + 0.008 * number), flip=side < 0)
    draft.lid(rings[0], begin.mean(axis=0), (0.5, 0.84), flip=side > 0)
    along, back, thumb = arm_axes(side)
    offset = hand.places - bones.place(f"{word}Hand")
    size = 0.190 / length
    for corners in hand.faces:
        a, b, c = (hand.places[i] for i in (corners[0], corners[1], corners[2]))
        palm = float(np.cross(b - a, c - a) @ back) < 0.0
        uvs = [_hand_uv(float(offset[i] @ thumb) * size, float(offset[i] @ along) * size, palm) for i in corners]
        draft.face([own[i] for i in corners], uvs)
    return draft.finish("skin_body", dim=flesh.whole)


def _hand_uv(across: float, along: float, palm: bool) -> tuple[float, float]:
    wide, long = _HAND_PICTURE
    u = 0.5 * min(max((across + 0.055) / wide, 0.0), 1.0)
    return u + (0.5 if palm else 0.0), 0.01 + 0.80 * min(max((along + 0.005) / long, 0.0), 1.0)


def _breathing(piece: Piece, bones: Skeleton) -> Piece:
    """Add the morph "breathe": the chest swells forwards and a little sideways, the belly less."""
    places = piece.places
    chest, spine = bones.place("upperChest")[1], bones.place("spine")[1]
    weights = piece.weights
    trunk = sum(weights[:, bones.index(name)] for name in ("spine", "chest", "upperChest"))
    height = 0.55 * np.exp(-(((places[:, 1] - chest) / 0.11) ** 2)) + 0.45 * np.exp(
        -(((places[:, 1] - spine - 0.04) / 0.09) ** 2)
    )
    ahead = step(-0.06, 0.06, places[:, 2])
    push = _BREATH * trunk * height * (0.25 + 0.75 * ahead)
    steps = push[:, None] * np.stack(
        [0.35 * np.sign(places[:, 0]) * step(0.0, 0.08, np.abs(places[:, 0])), 0.3 + 0 * ahead, 1.3 * ahead - 0.25],
        axis=1,
    )
    return replace(piece, moves=piece.moves | {"breathe": steps})
