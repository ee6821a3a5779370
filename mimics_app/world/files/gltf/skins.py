"""Skins of a glTF file: joints and inverse bind matrices."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.world.files.gltf.accessors import GltfAccessors
from mimics_app.world.files.gltf.gltf_document import GltfSource
from mimics_app.world.files.gltf.meshes import GltfMesh
from mimics_app.world.files.gltf.nodes import GltfNode

__all__ = ["MAX_JOINTS", "MAX_SKINNED", "GltfSkin", "GltfSkins", "check_bound_nodes"]

MAX_JOINTS = 1365
"""Maximum joints of a skin: matrices of three rows of four floats that fit the 64 KiB every uniform block may have."""

MAX_SKINNED = 5_000
"""Maximum number of nodes with a skin: each is bound and deformed by itself."""

_LAST_ROW = 1e-4
"""Tolerance of the last row of an inverse bind matrix, 0 0 0 1."""


@dataclass(frozen=True, eq=False)
class GltfSkin:
    """A skin.

    Attributes:
        name: "" for none.
        joints: Indices of nodes.
        inverse_bind: T_joint_from_mesh at rest, float64 [joints, 4, 4].
    """

    name: str
    joints: tuple[int, ...]
    inverse_bind: NDArray[np.float64]


class GltfSkins:
    """Reader of skins, in file order."""

    def __init__(self, source: GltfSource, accessors: GltfAccessors) -> None:
        self._source = source
        self._accessors = accessors

    def read_all(self) -> list[GltfSkin]:
        """Read every skin; faults are collected, and a faulty skin has no joints."""
        skins = self._source.table("skins")
        return self._source.read_each(skins, "/skins", self._read, lambda: GltfSkin("", (), np.zeros((0, 4, 4))))

    def _read(self, item: dict[str, Any], place: str) -> GltfSkin:
        source = self._source
        nodes = len(source.table("nodes"))
        listed = source.list(item, "joints", place)
        if not listed:
            source.fail(f"{place}/joints", "has no joint")
        if len(listed) > MAX_JOINTS:
            source.fail(f"{place}/joints", f"{len(listed)} joints are more than {MAX_JOINTS}")
        joints = [source.index(value, nodes, "nodes", f"{place}/joints/{i}") for i, value in enumerate(listed)]
        if len(set(joints)) < len(joints):
            second = next(i for i, joint in enumerate(joints) if joint in joints[:i])
            source.fail(f"{place}/joints/{second}", f"node {joints[second]} is a joint of this skin already")
        return GltfSkin(source.text(item, "name", place), tuple(joints), self._inverse(item, place, len(joints)))

    def _inverse(self, item: dict[str, Any], place: str, joints: int) -> NDArray[np.float64]:
        if "inverseBindMatrices" not in item:
            return np.tile(np.eye(4), (joints, 1, 1))
        where = f"{place}/inverseBindMatrices"
        values = self._accessors.floats(item["inverseBindMatrices"], where, "MAT4")
        if len(values) < joints:
            self._source.fail(where, f"has {len(values)} matrices, the skin has {joints} joints")
        matrices = values[:joints].astype(np.float64).reshape(-1, 4, 4).transpose(0, 2, 1).copy()
        off = np.abs(matrices[:, 3] - (0.0, 0.0, 0.0, 1.0)).max(axis=1)
        if off.max() > _LAST_ROW:
            self._source.fail(where, f"the last row of matrix {int(np.argmax(off))} is not 0 0 0 1")
        matrices[:, 3] = (0.0, 0.0, 0.0, 1.0)
        return matrices


def check_bound_nodes(
    source: GltfSource, nodes: Sequence[GltfNode], meshes: Sequence[GltfMesh], skins: Sequence[GltfSkin]
) -> None:
    """Report joints of vertices that their skin lacks; note meshes without joints on a node with a skin."""
    skinned = [i for i, node in enumerate(nodes) if node.skin is not None and node.mesh is not None]
    if len(skinned) > MAX_SKINNED:
        source.fail(f"/nodes/{skinned[MAX_SKINNED]}/skin", f"more than {MAX_SKINNED} nodes have a skin")
    for i, node in enumerate(nodes):
        if node.skin is None or node.mesh is None:
            continue
        joints = len(skins[node.skin].joints)
        other = [level for level in node.levels if nodes[level].skin not in (None, node.skin)]
        if other:
            with source.collecting():
                source.fail(f"/nodes/{other[0]}/skin", f"is another skin than that of node {i}, whose level it is")
        shown = [node.mesh, *(nodes[level].mesh for level in node.levels)]
        for part in (part for mesh in shown if mesh is not None for part in meshes[mesh].primitives):
            weights = part.mesh.weights
            if weights is None:
                source.note(f"/nodes/{i} has a skin, {part.pointer} has no joints: it moves with its node")
            elif joints and weights.highest >= joints:
                vertex = int(np.flatnonzero((weights.joints >= joints).any(axis=1))[0])
                what = f"vertex {vertex} follows joint {weights.highest}; skin {node.skin} has {joints} joints"
                with source.collecting():
                    source.fail(f"{part.pointer}/attributes/JOINTS_0", what)
