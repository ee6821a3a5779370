"""Retarget: transfer of poses between skeletons that rest differently, each bone after its counterpart."""

from __future__ import annotations

import math

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.maths.poses import conjugate, rotate_vector
from mimics_app.maths.quat import about_axis, product
from mimics_app.world.content.motion.facing import facing
from mimics_app.world.content.motion.humanoid import BONES, HumanoidMap
from mimics_app.world.content.motion.kernels.chain import arc, carry_over
from mimics_app.world.content.motion.pose import Pose
from mimics_app.world.content.motion.reach import Chain
from mimics_app.world.content.motion.rig import Rig

__all__ = ["Retarget"]


_NEXT = {
    f"{side}{bone}": f"{side}{after}"
    for side in ("left", "right")
    for bone, after in (
        ("UpperArm", "LowerArm"),
        ("LowerArm", "Hand"),
        ("UpperLeg", "LowerLeg"),
        ("LowerLeg", "Foot"),
        ("Foot", "Toes"),
    )
}
"""The bone at whose joint each bone of a limb ends."""

_TRUNK = {"hips": "spine", "spine": "chest", "chest": "upperChest", "upperChest": "neck", "neck": "head"}
_TRUNK |= {f"{side}Shoulder": f"{side}UpperArm" for side in ("left", "right")}
"""The same of bones that are not aligned: a spine keeps its own curve, a collar bone its own slope."""

_ABOVE = {"LowerArm": "UpperArm", "Hand": "LowerArm", "LowerLeg": "UpperLeg", "Toes": "Foot"}
"""Bone whose alignment one takes before its own."""

_UP = np.array([0.0, 1.0, 0.0])
_LEAST_REPORTED = math.radians(0.5)
"""Angle from which the report names a bone [rad]."""


class Retarget:
    """Transfer of poses from one rig to another, bone by bone.

    The rest of the target is aligned with that of the source first: arms and legs lie in the same directions, feet are
    turned about the vertical only, so that they stay flat, and who looks the other way is turned about. Then a bone has
    the rotation from rest of its counterpart, in the axes of the model (+y up). The hips are also translated, scaled by
    the ratio of leg lengths. Bones that only one of the two has are ignored.

    Args:
        source, source_bones: Rig of the given poses.
        target, target_bones: Rig of the resulting poses.

    Attributes:
        report: Report of what is transferred and what is not, and of the angles between the rests.
        residuals: Angle between each bone and its counterpart at rest that alignment leaves, by bone [rad].
    """

    def __init__(self, source: Rig, source_bones: HumanoidMap, target: Rig, target_bones: HumanoidMap) -> None:
        shared = [bone for bone in BONES if bone in source_bones.slots and bone in target_bones.slots]
        self._theirs = {bone: source_bones.slots[bone] for bone in shared}
        self._own = {bone: target_bones.slots[bone] for bone in self._theirs}
        self._source, self._target = source, target
        self._rest_from, self._rest, self._chain = Chain(source), Chain(target), Chain(source)
        yaws = facing(self._rest_from.places, self._theirs), facing(self._rest.places, self._own)
        quarters = 0.0 if None in yaws else round((yaws[1] - yaws[0]) / (0.5 * math.pi))  # type: ignore[operator]
        self._into = about_axis(_UP, 0.5 * math.pi * quarters)
        self.residuals: dict[str, float] = {}
        self._moved: dict[str, float] = {}
        self._align()
        self._back = np.array([conjugate(turn) for turn in self._rest_from.turns])
        self._turns = np.zeros_like(self._rest.turns)
        self._hips = source_bones.slots["hips"], target_bones.slots["hips"]
        self._scale = self._find_scale()
        self.report = self._report(source_bones, target_bones)

    def _align(self) -> None:
        """Find the rotation of each slot at rest after alignment, in the source's frame."""
        self._pairs = np.full(len(self._target.names), -1, np.int32)
        self._aligned = self._rest.turns.copy()
        out, found = conjugate(self._into), dict[str, F8]()
        for bone, slot in self._own.items():
            side = next((side for side in ("left", "right") if bone.startswith(side)), "")
            above = found.get(side + _ABOVE.get(bone.removeprefix(side), ""), out)
            found[bone] = self._aligned_to(bone, out, above)
            self._pairs[slot] = self._theirs[bone]
            self._aligned[slot] = product(found[bone], self._rest.turns[slot])

    def _aligned_to(self, bone: str, out: F8, above: F8) -> F8:
        """Return the rotation from the target's frame to the source's in which a bone rests as its counterpart."""
        ways = self._ways(bone, (_NEXT | _TRUNK).get(bone, ""))
        if ways is None:
            return above
        own, theirs = ways
        turn, aligned = np.empty(4), out
        if bone.endswith("Foot"):
            flat = rotate_vector(out, own) * (1.0, 0.0, 1.0), theirs * (1.0, 0.0, 1.0)
            arc(*flat, turn)
            aligned = product(turn, out) if min(map(np.linalg.norm, flat)) > 0.0 else out
        elif bone in _NEXT:
            arc(rotate_vector(above, own), theirs, turn)
            aligned = product(turn, above)
            self._moved[bone] = _angle(rotate_vector(out, own), theirs)
        self.residuals[bone] = _angle(rotate_vector(aligned, own), theirs)
        return aligned

    def _ways(self, bone: str, after: str) -> tuple[F8, F8] | None:
        """Return the vectors from a bone to the next one at rest, the target's and the source's [m]; None for none."""
        if after not in self._own:
            return None
        own = self._rest.places[self._own[after]] - self._rest.places[self._own[bone]]
        theirs = self._rest_from.places[self._theirs[after]] - self._rest_from.places[self._theirs[bone]]
        return (own, theirs) if min(float(np.linalg.norm(own)), float(np.linalg.norm(theirs))) > 1e-9 else None

    def _find_scale(self) -> float:
        """Return the ratio of leg lengths; of the heights of the hips for a rig without legs."""
        lengths = np.zeros(2)
        for bone in (bone for bone in _NEXT if bone.endswith("Leg") and bone in self._own):
            ways = self._ways(bone, _NEXT[bone])
            lengths += np.zeros(2) if ways is None else [float(np.linalg.norm(way)) for way in ways]
        if not lengths.all():
            lengths = np.array([self._rest.places[self._hips[1], 1], self._rest_from.places[self._hips[0], 1]])
        return float(lengths[0] / lengths[1]) if lengths[1] > 1e-6 else 1.0

    def _report(self, source: HumanoidMap, target: HumanoidMap) -> list[str]:
        report = [f"{len(self._own)} bones carried over, lengths scaled by {self._scale:.3f}"]
        for words, angles in (
            ("rests differed and were aligned", self._moved),
            ("rests differ and were not aligned", self.residuals),
        ):
            large = [f"{bone} {math.degrees(angle):.1f}" for bone, angle in angles.items() if angle >= _LEAST_REPORTED]
            if large:
                report.append(f"{words}, in degrees: {', '.join(large)}")
        return report + [
            f"left out: {bone}, which the target lacks" for bone in source.slots if bone not in target.slots
        ]

    def apply(self, rotations: F8, translations: F8, pose: Pose) -> None:
        """Write a pose of the source to the target.

        Args:
            rotations: Local rotations of the source, [slots, 4].
            translations: Local translations of the source [m], [slots, 3].
            pose: Pose of the target, changed.
        """
        chain, (source, target) = self._chain, self._hips
        chain.follow(Pose(translations, rotations, self._source.rest.scales, self._source.rest.morphs))
        parents, aligned = self._target.parents, self._aligned
        turned = (self._pairs, self._into, aligned, parents, pose.rotations, self._turns)
        carry_over(chain.turns, self._back, *turned)
        way = chain.places[source] - self._rest_from.places[source]
        way = self._scale * rotate_vector(self._into, way)
        above = int(parents[target])
        if above >= 0:
            way = rotate_vector(conjugate(self._turns[above]), way) / self._rest.scales[above]
        pose.translations[target] = self._target.rest.translations[target] + way


def _angle(a: F8, b: F8) -> float:
    """Return the angle between two directions [rad]."""
    return math.atan2(float(np.linalg.norm(np.cross(a, b))), float(a @ b))
