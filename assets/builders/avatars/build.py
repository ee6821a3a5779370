"""The people: women, men, twins, soccer players and a therapist, each a model on a skeleton with motions."""

from __future__ import annotations

import numpy as np

from assets.builders.avatars.export import FigureWriter, Paint
from assets.builders.avatars.motions import MOTIONS
from assets.builders.avatars.paint_face import paint_face
from assets.builders.avatars.paint_stuff import paint_cloth, paint_curls, paint_eye, paint_hair, paint_hands
from assets.builders.avatars.person import EVERYBODY, Person
from assets.builders.avatars.piece import Piece
from assets.builders.avatars.sheet import I8
from assets.builders.avatars.skeleton import FINGERS, arm_axes
from assets.builders.avatars.whole_person import Figure, make_figure
from assets.builders.avatars.wisps import paint_wisps
from assets.builders.avatars.worn_bodies import write_bodies
from assets.builders.kit.palette_texture import Rgb
from mimics_app.maths.colour import linear_light

__all__ = ["compose", "linear_colour", "skin_colour", "write_figure"]

_GENERATOR = "mimics_app assets build avatars"
_BODIES = "bodies.json"
_CLOTH, _HANDS, _HANDS_SLOPES = "cloth_normal.jpg", "hands_base.jpg", "hands_normal.jpg"
_WISPS = "wisps.png"
_HAIR, _CURLS = ("hair_base.jpg", "hair_normal.jpg"), ("curls_base.jpg", "curls_normal.jpg")
_CURLY = ("curls", "crop")
"""Styles of hair without a course of the strands."""
_SOFT = 1.0
"""`softness` of the material of skin."""
_HAND_TINT = 238.0
"""Plain tone of the texture of hands, sRGB."""


def compose(seed: int) -> dict[str, bytes]:
    """Return the files of all people by name: a GLB each, the textures they share, the table of their bodies.

    Args:
        seed: Of the random numbers of the hair.
    """
    files: dict[str, bytes] = {_BODIES: write_bodies(), _CLOTH: paint_cloth()}
    files[_WISPS] = paint_wisps()
    files |= dict(zip(_HAIR, paint_hair(), strict=True)) | dict(zip(_CURLS, paint_curls(), strict=True))
    for person in EVERYBODY:
        figure = make_figure(person, seed)
        if _HANDS not in files:
            files[_HANDS], files[_HANDS_SLOPES] = _hands(figure)
        files[f"{person.name}.glb"] = write_figure(figure, seed)
    return files


def write_figure(figure: Figure, seed: int) -> bytes:
    """Return a person as a GLB file."""
    person, pieces = figure.person, figure.pieces
    base, slopes = paint_face(person, figure.head, pieces["head"], figure.face_corners)
    clothes = dict(person.clothes)
    paints = {
        "skin_head": Paint((1.0, 1.0, 1.0), 0.64, base, slopes, soft=_SOFT),
        "skin_body": Paint(skin_colour(person), 0.64, _HANDS, _HANDS_SLOPES, soft=_SOFT),
        "eye": Paint((1.0, 1.0, 1.0), 0.12, paint_eye(person.looks.iris, seed)),
        "mouth": Paint((1.0, 1.0, 1.0), 0.35),
        "hair": Paint(
            linear_colour(person.looks.hair, 205.0), 0.80, *(_CURLS if person.looks.style in _CURLY else _HAIR)
        ),
        "wisps": Paint(linear_colour(person.looks.hair, 205.0), 0.80, _WISPS, masked=True),
        "shoes": Paint(linear_colour(clothes["shoes"]), 0.5),
    }
    for name, colour in person.clothes:
        if name != "shoes":
            rough = 0.92 if name in ("socks", "jersey") else 0.85
            paints[pieces[name].material] = Paint(linear_colour(colour), rough, "", _CLOTH)
    writer = FigureWriter(_GENERATOR, figure.bones, person.name)
    writer.add_skinned("face", [pieces["head"], pieces["mouth"]], paints)
    worn = [pieces[name] for name, _ in person.clothes if name != "shoes"]
    writer.add_skinned("body", [pieces["skin"], *worn], paints)
    writer.add_skinned("things", [pieces["hair"], pieces["eyes"], pieces["shoes"], pieces["wisps"]], paints)
    for name, motion in MOTIONS.items():
        writer.add_motion(name, motion)
    return writer.to_bytes()


def skin_colour(person: Person) -> tuple[float, float, float]:
    """Return the linear factors of a person's skin on the texture of hands."""
    return linear_colour(person.looks.skin, _HAND_TINT)


def linear_colour(colour: Rgb, white: float = 255.0) -> tuple[float, float, float]:
    """Return linear factors of an sRGB colour (IEC 61966-2-1) on a texture whose plain tone is `white`."""
    one, base = (np.asarray(c, float) / 255.0 for c in (colour, (white,) * 3))
    red, green, blue = (float(linear_light(c) / linear_light(w)) for c, w in zip(one, base, strict=True))
    return min(red, 1.0), min(green, 1.0), min(blue, 1.0)


def _hands(figure: Figure) -> tuple[bytes, bytes]:
    """Return the shared texture of hands and its normal map, painted on the left hand of one person."""
    bones, piece = figure.bones, figure.pieces["skin"]
    along, back, thumb = arm_axes(1)
    wrist = bones.place("leftHand")
    axes = np.stack([along, back, thumb])
    size = 0.190 / figure.person.body.hand
    hand = _left_hand(piece)
    joints = {}
    for finger in FINGERS:
        kinds = ("Metacarpal", "Proximal", "Distal") if finger == "Thumb" else ("Proximal", "Intermediate", "Distal")
        for number, kind in enumerate(kinds):
            joints[f"{finger}{number}"] = size * (axes @ (bones.place(f"left{finger}{kind}") - wrist))
        joints[f"{finger}3"] = size * (axes @ (bones.tips[f"left{finger}Tip"] - wrist))
    places = size * ((piece.places - wrist) @ axes.T)
    return paint_hands(piece.uvs, hand, places, joints)


def _left_hand(piece: Piece) -> I8:
    """Return the triangles of the left hand: those on its part of the texture."""
    left = piece.places[piece.triangles][:, :, 0].min(axis=1) > 0.0
    shown = piece.uvs[piece.triangles][:, :, 1].max(axis=1) < 0.82
    wanted: I8 = piece.triangles[left & shown]
    return wanted
