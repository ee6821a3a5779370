"""SkinnedBody: a deformable body with palette, morph weights and bounding box of the present frame."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from mimics_app.contracts.arrays import F4, F8, I4
from mimics_app.world.content.meshes.mesh import MeshData
from mimics_app.world.content.motion.kernels.skinning_palette import (
    bound_joints,
    has_moved,
    take_weights,
    write_palette,
)
from mimics_app.world.graph.transforms import TransformTable

__all__ = ["Binding", "SkinnedBody", "Skinning", "bind"]


Skinning = Literal["linear", "dual"]
"""Skinning method: blended matrices (glTF 2.0), or dual quaternions, which keep the volume of twisted limbs (Kavan et
al. 2008)."""

_STRETCHED = 2e-3
"""Error of products of a joint's axes beyond which it is not a rotation: singular values 1e-3 from 1."""

_BULGE = 0.12
"""Margin for vertices that dual quaternions move out of the box about the joints' boxes, as a share of its size."""


@dataclass(frozen=True, eq=False)
class Binding:
    """A skin as entities of a world.

    Attributes:
        joints: Entity index of each joint, int32 [joints].
        inverse_bind: T_joint_from_mesh at rest, float64 [joints, 4, 4].
        boxes: Bounding box of each joint's vertices in the mesh [m], float64 [joints, 2, 3].
    """

    joints: I4
    inverse_bind: F8
    boxes: F8


def bind(joints: I4, inverse_bind: F8, meshes: Sequence[MeshData]) -> Binding:
    """Create the binding of a skin, with the bounding boxes of each joint's vertices in some meshes."""
    boxes = np.empty((len(joints), 2, 3))
    boxes[:, 0], boxes[:, 1] = np.inf, -np.inf
    for mesh in meshes:
        if mesh.weights is None:
            continue
        for k in range(mesh.weights.influences):
            follows = mesh.weights.weights[:, k] > 0.0
            numbers, places = mesh.weights.joints[follows, k], mesh.positions[follows].astype(np.float64)
            np.minimum.at(boxes[:, 0], numbers, places)
            np.maximum.at(boxes[:, 1], numbers, places)
    return Binding(np.ascontiguousarray(joints, np.int32), np.ascontiguousarray(inverse_bind), boxes)


class SkinnedBody:
    """One deformable body; all its meshes have the same skin.

    Args:
        entity: Entity index of its node.
        meshes: Its meshes by key in the world.
        binding: Its skin; None for a body with morph targets only.
        morphs: Weights of its morph targets, a view of the model's pose, [targets].
        skinning: Method while no joint is stretched; otherwise matrices are blended.

    Attributes:
        rows: Palette in the frame of the node, three matrix rows per joint, float32 [joints, 3, 4].
        duals: Palette as dual quaternions, float32 [joints, 8].
        weights: Weights of its morph targets in this frame, float32 [targets].
        morphed: True when any of these is not zero.
        stretched: True when a joint is stretched in this frame.
        margin: Margin of its morph targets in this frame, with rounding, on each side [m], [3].
        bounds: Bounding box in the frame of the node: minimum and maximum [m].
        revision: Changes with every deformation.
    """

    def __init__(
        self, entity: int, meshes: dict[str, MeshData], binding: Binding | None, morphs: F8, skinning: Skinning
    ) -> None:
        self.entity = entity
        self.meshes = meshes
        self.binding = binding
        self.skinning = skinning
        joints = 0 if binding is None else len(binding.joints)
        self.rows: F4 = np.zeros((joints, 3, 4), np.float32)
        self.duals: F4 = np.zeros((joints, 8), np.float32)
        self.weights: F4 = np.zeros(len(morphs), np.float32)
        self.morphed = self.stretched = False
        self.revision = 0
        self._morphs = morphs
        self.margin = self._grown = _growth(list(meshes.values()))
        self._least, self._greatest = np.zeros(3), np.zeros(3)
        self._order = -1
        self._joint_rows: I4 = np.zeros(joints, np.int32)

    @property
    def method(self) -> Skinning:
        """Skinning method of this frame."""
        return "linear" if self.stretched else self.skinning

    @property
    def bounds(self) -> tuple[F8, F8]:
        """Bounding box in the frame of its node: minimum and maximum [m], [3] each."""
        return self._least, self._greatest

    def follow(self, transforms: TransformTable) -> None:
        """Update the palette, morph weights and bounds from the present transforms."""
        bent = self.revision == 0
        if self.binding is not None:
            if self._order != transforms.revision:
                self._order, bent = transforms.revision, True
                self._joint_rows = transforms.rows(self.binding.joints)
            row = transforms.row(self.entity)
            bent = bent or has_moved(self._joint_rows, row, transforms.changed)
            if bent:
                self._write(row, transforms.world)
        if len(self._morphs) and (greatest := take_weights(self._morphs, self.weights)) >= 0.0:
            bent, self.morphed = True, greatest > 0.0
            self.margin = self._grown * max(1.0, greatest)
        if bent:
            self._bound()
            self.revision += 1

    def _write(self, row: int, world: F8) -> None:
        assert self.binding is not None
        given = (self._joint_rows, row, world, self.binding.inverse_bind)
        worst = write_palette(*given, self.rows, self.duals)
        if worst >= 0.0:
            self.stretched = worst > _STRETCHED

    def _bound(self) -> None:
        grown = self.margin
        if self.binding is None:
            corners = [mesh.bounds for mesh in self.meshes.values()]
            self._least = np.min([corner[0] for corner in corners], axis=0) - grown
            self._greatest = np.max([corner[1] for corner in corners], axis=0) + grown
            return
        least, greatest = np.empty(3), np.empty(3)
        bound_joints(self.rows, self.binding.boxes, grown, least, greatest)
        if self.method == "dual":
            bulge = _BULGE * float((greatest - least).max())
            least, greatest = least - bulge, greatest + bulge
        self._least, self._greatest = least, greatest


def _growth(meshes: Sequence[MeshData]) -> F8:
    """Return the margin of all morph targets at weight 1 on each side [m], with rounding, [3]."""
    grown, size = np.zeros(3), 0.0
    for mesh in meshes:
        if mesh.morphs:
            added = np.sum([np.abs(morph.positions.astype(np.float64)) for morph in mesh.morphs], axis=0)
            grown = np.maximum(grown, added.max(axis=0, initial=0.0))
        size = max(size, float(np.abs(mesh.bounds).max()))
    return grown + 1e-5 * size
