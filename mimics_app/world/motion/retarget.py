"""Retarget: transfer of poses between skeletons by rotations relative to rest, in the axes of the model."""

from __future__ import annotations

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.world.motion.animator import Rig
from mimics_app.world.motion.humanoid import BONES, HumanoidMap
from mimics_app.world.motion.kernels.chain import multiply_rows
from mimics_app.world.motion.pose import Pose
from mimics_app.world.motion.reach import Chain

__all__ = ["Retarget"]


class Retarget:
    """Transfer of poses from one rig to another, bone by bone.

    A bone has the rotation from rest of its counterpart, in the axes of the model (+y up, +z forward). The hips are
    also translated, scaled by the ratio of hip heights. Bones that only one of the two has are ignored.

    Args:
        source, source_bones: Rig of the given poses.
        target, target_bones: Rig of the resulting poses.
        mirrored: True: left and right are exchanged.

    Attributes:
        report: Report of what is transferred and what is not.
    """

    def __init__(
        self, source: Rig, source_bones: HumanoidMap, target: Rig, target_bones: HumanoidMap, *, mirrored: bool = False
    ) -> None:
        pairs = []
        for bone in BONES:
            other = _other_side(bone) if mirrored else bone
            if bone in target_bones.slots and other in source_bones.slots:
                pairs.append((source_bones.slots[other], target_bones.slots[bone]))
        self._from, self._to = (np.array(slots, np.intp) for slots in zip(*pairs, strict=True))
        self._sign = np.array([1.0, -1.0, -1.0, 1.0]) if mirrored else np.ones(4)
        self._shift_sign = np.array([-1.0, 1.0, 1.0]) if mirrored else np.ones(3)
        rest, own = Chain(source), Chain(target)
        self._above_from = _parents_turns(source, rest)[self._from]
        self._above_to = _parents_turns(target, own)[self._to]
        self._rest_from, self._rest_to = source.rest.rotations[self._from], target.rest.rotations[self._to]
        self._hips = source_bones.slots["hips"], target_bones.slots["hips"]
        self._rest_hips = (
            source.rest.translations[self._hips[0]].copy(),
            target.rest.translations[self._hips[1]].copy(),
        )
        heights = rest.places[self._hips[0], 1], own.places[self._hips[1], 1]
        self._scale = float(heights[1] / heights[0]) if heights[0] > 1e-6 else 1.0
        lost = [bone for bone in source_bones.slots if bone not in target_bones.slots]
        self.report = [f"{len(pairs)} bones carried over, lengths scaled by {self._scale:.3f}"]
        self.report += [f"left out: {bone}, which the target lacks" for bone in lost]

    def apply(self, rotations: F8, translations: F8, pose: Pose) -> None:
        """Write a pose of the source to the target.

        Args:
            rotations: Local rotations of the source, [slots, 4].
            translations: Local translations of the source [m], [slots, 3].
            pose: Pose of the target, changed.
        """
        delta = _multiply(rotations[self._from], _conjugate(self._rest_from))
        delta = self._sign * _multiply(_multiply(self._above_from, delta), _conjugate(self._above_from))
        own = _multiply(_multiply(_conjugate(self._above_to), delta), self._above_to)
        turned = _multiply(own, self._rest_to)
        pose.rotations[self._to] = turned / np.linalg.norm(turned, axis=1, keepdims=True)
        source, target = self._hips
        shift = self._scale * self._shift_sign * (translations[source] - self._rest_hips[0])
        pose.translations[target] = self._rest_hips[1] + shift


def _other_side(bone: str) -> str:
    if bone.startswith("left"):
        return "right" + bone.removeprefix("left")
    return "left" + bone.removeprefix("right") if bone.startswith("right") else bone


def _parents_turns(rig: Rig, rest: Chain) -> F8:
    """Return the orientation of each slot's parent at rest, [slots, 4]."""
    turns = np.tile([0.0, 0.0, 0.0, 1.0], (len(rig.names), 1))
    hung = rig.parents >= 0
    turns[hung] = rest.turns[rig.parents[hung]]
    return turns


def _conjugate(q: F8) -> F8:
    return q * np.array([-1.0, -1.0, -1.0, 1.0])


def _multiply(a: F8, b: F8) -> F8:
    """Return products of quaternions row by row, [n, 4]."""
    product = np.empty_like(a)
    multiply_rows(a, b, product)
    return product
