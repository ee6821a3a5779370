"""The right arms with which participants see themselves grip: from the shoulder to five fingers that close."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from assets.builders.avatars.build import linear_colour, skin_colour
from assets.builders.avatars.export import FigureWriter, Paint
from assets.builders.avatars.fields import F8
from assets.builders.avatars.person import EVERYBODY, Person
from assets.builders.avatars.piece import Piece
from assets.builders.avatars.skeleton import FINGERS, Skeleton, arm_axes
from assets.builders.avatars.whole_person import Figure, make_figure
from assets.builders.hands.pad_grip import Grip, Gripper
from mimics_app.maths.quat import about_axis, product

__all__ = ["CLOSED", "OPEN", "compose", "make_grips"]

_GENERATOR = "mimics_app assets build hands"
_PEOPLE = ("woman_mara", "twin_woman")
"""With bare forearms, which hide least of what is gripped: a dark and a light skin."""
CLOSED, OPEN = 0.004, 0.044
"""Half openings at the start and at the end of the clip [m]."""
_KEYS = 11
_SECONDS = 1.0
"""Duration of the clip."""
_SLANT = 0.72
"""Angle from the hand's direction to that from the thumb to the fingers, to the little finger's side [rad]."""
_DIP = 0.21
"""By which the hand points down [rad]."""
_LEAN = 0.17
"""Of the forearm about the back of the hand [rad]: it comes from the participant's own side."""
_EXTENSION = -0.42
"""Of the wrist [rad]: the forearm comes from below."""
_ELBOW = (-0.55, -0.38)
"""Of the elbow about the back of the hand and about its thumb's side [rad]: the upper arm comes from the viewer."""
_JOINTS = ("hand", "forearm", "upperArm")
_LONGER = 1.6
"""Length of the upper arm as a share of the person's: it ends out of the picture."""
_SLEEVES = ("shirt_long", "shirt", "blouse", "tunic", "jersey")


def compose(seed: int) -> dict[str, bytes]:
    """Return a GLB file of each arm by name.

    Args:
        seed: Of nothing that is seen of an arm; people are modelled with it.
    """
    files = {}
    for person in EVERYBODY:
        if person.name in _PEOPLE:
            figure = make_figure(person, seed)
            files[f"{person.name}_right.glb"] = _write(figure)
    return files


def make_grips(figure: Figure) -> list[Grip]:
    """Return the grips of the clip's key frames, from closed to open."""
    gripper = Gripper(figure.bones, figure.pieces["skin"], figure.person.body.hand / 0.190)
    return gripper.family(np.linspace(CLOSED, OPEN, _KEYS))


def _frame() -> F8:
    """Axes of the file in the body's frame: from the thumb to the fingers, up, across, [3, 3]."""
    along, back, thumb = arm_axes(-1)
    level, up = np.cos(_DIP) * along + np.sin(_DIP) * back, np.cos(_DIP) * back - np.sin(_DIP) * along
    x = np.cos(_SLANT) * level - np.sin(_SLANT) * thumb
    return np.stack([x, up, np.cross(x, up)])


def _write(figure: Figure) -> bytes:
    axes = _frame()
    bones = _arm(figure.bones, axes)
    person = figure.person
    cloth = next(name for name, _ in person.clothes if name in _SLEEVES)
    worn = [_longer(figure.pieces[name], figure.bones) for name in ("skin", cloth)]
    pieces = [_cut(piece, figure.bones, bones, axes) for piece in worn]
    writer = _ArmWriter(_GENERATOR, bones, "arm")
    writer.add_arm(pieces, _paints(person, pieces, cloth))
    writer.add_grips(make_grips(figure), figure.bones, axes)
    return writer.to_bytes()


def _paints(person: Person, pieces: list[Piece], cloth: str) -> dict[str, Paint]:
    folder = "../avatars"
    skin, sleeve = pieces
    return {
        skin.material: Paint(
            skin_colour(person), 0.64, f"{folder}/hands_base.jpg", f"{folder}/hands_normal.jpg", soft=1.0
        ),
        sleeve.material: Paint(linear_colour(dict(person.clothes)[cloth]), 0.85, "", f"{folder}/cloth_normal.jpg"),
    }


def _arm(bones: Skeleton, axes: F8) -> Skeleton:
    """Return the joints of an arm: the hand, the forearm behind it, the fingers, in the frame of the file."""
    wrist = bones.place("rightHand")
    elbow = axes @ (bones.place("rightLowerArm") - wrist)
    names, parents, places = list(_JOINTS), [-1, 0, 1], [np.zeros(3), np.zeros(3), elbow]
    for finger in FINGERS:
        kinds = ("Metacarpal", "Proximal", "Distal") if finger == "Thumb" else ("Proximal", "Intermediate", "Distal")
        for number, kind in enumerate(kinds):
            parents.append(0 if number == 0 else len(names) - 1)
            names.append(f"{finger}{kind}")
            places.append(axes @ (bones.place(f"right{finger}{kind}") - wrist))
    return Skeleton(tuple(names), tuple(parents), np.array(places), {})


def _longer(piece: Piece, bones: Skeleton) -> Piece:
    """Return a piece whose right arm is longer above the elbow."""
    along = arm_axes(-1)[0]
    far = ((piece.places - bones.place("rightHand")) @ along)[:, None]
    elbow = float((bones.place("rightLowerArm") - bones.place("rightHand")) @ along)
    return replace(piece, places=piece.places + np.minimum(far - elbow, 0.0) * (_LONGER - 1.0) * along)


def _cut(piece: Piece, bones: Skeleton, arm: Skeleton, axes: F8) -> Piece:
    """Return what of a piece the right arm moves, in the frame of the file."""
    weights = np.zeros((len(piece.places), len(arm.names)))
    for number, name in enumerate(("Hand", "LowerArm", "UpperArm", *arm.names[3:])):
        weights[:, number] = piece.weights[:, bones.index(f"right{name}")]
    total = weights.sum(axis=1)
    kept = piece.triangles[(total[piece.triangles] > 0.9).all(axis=1)]
    rows, triangles = np.unique(kept, return_inverse=True)
    triangles = triangles.reshape(-1, 3)
    return replace(
        piece,
        places=(piece.places[rows] - bones.place("rightHand")) @ axes.T,
        normals=piece.normals[rows] @ axes.T,
        uvs=piece.uvs[rows],
        triangles=triangles,
        weights=weights[rows] / total[rows, None],
        shades=piece.shades[rows],
        moves={},
    )


class _ArmWriter(FigureWriter):
    """Writes one arm."""

    def add_arm(self, pieces: list[Piece], paints: dict[str, Paint]) -> None:
        """Add the skinned mesh; it is always near, and has no coarser levels."""
        node = self.add_node("skin", parent=self._root, mesh=self._add_mesh("skin", pieces, paints, ()))
        self._tables["nodes"][node]["skin"] = self._skin

    def add_grips(self, grips: list[Grip], bones: Skeleton, axes: F8) -> None:
        """Add the clip "grip", whose origin is the centre of what is gripped."""
        input_ = self._times(np.linspace(0.0, _SECONDS, len(grips)))
        samplers: list[dict[str, Any]] = []
        channels: list[dict[str, Any]] = []

        def add(node: int, path: str, output: int, times: int = input_) -> None:
            samplers.append({"input": times, "output": output, "interpolation": "LINEAR"})
            channels.append({"sampler": len(samplers) - 1, "target": {"node": node, "path": path}})

        hand = np.stack(arm_axes(-1))
        add(self._joints[0], "translation", self._keys(np.array([-(axes @ hand.T) @ grip.centre for grip in grips])))
        wrist = product(_about(axes, hand[2], _EXTENSION), _about(axes, hand[1], _LEAN))
        elbow = product(_about(axes, hand[2], _ELBOW[1]), _about(axes, hand[1], _ELBOW[0]))
        for node, turn in ((self._joints[1], wrist), (self._joints[2], elbow)):
            add(node, "rotation", self._turns(turn[None]), self._times(np.zeros(1)))
        for node, name in zip(self._joints[3:], self._bones.names[3:], strict=True):
            turns = np.array([_turned(axes, grip.pose.turns[bones.index(f"right{name}")]) for grip in grips])
            add(node, "rotation", self._turns(turns * np.where(turns[:, 3:] < 0.0, -1.0, 1.0)))
        self._add("animations", {"name": "grip", "channels": channels, "samplers": samplers})


def _about(axes: F8, axis: F8, angle: float) -> F8:
    return _turned(axes, np.asarray(about_axis(axis, angle)))


def _turned(axes: F8, turn: F8) -> F8:
    """Return a rotation of the body's frame in that of the file."""
    return np.array([*(axes @ turn[:3]), turn[3]])
