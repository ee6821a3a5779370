"""Joints, weights and morph targets of the primitives of a glTF file."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.errors import counted
from mimics_app.world.content.meshes.deform import MorphTarget, VertexWeights
from mimics_app.world.files.gltf.accessors import GltfAccessors
from mimics_app.world.files.gltf.gltf_document import GltfSource
from mimics_app.world.files.gltf.primitive import GltfPrimitive

__all__ = ["GltfDeforms"]

_MAX_INFLUENCES = 16
"""Maximum joints of a vertex: JOINTS_0 to JOINTS_3."""

_MAX_MORPHS = 256
"""Maximum morph targets of a mesh."""

_UNNORMALISED = 1e-3
"""Deviation of a vertex's sum of weights from 1 that is noted; rounding of bytes alone may reach 2e-3."""

_SET = 4
"""Influences of one pair of attributes."""


class GltfDeforms:
    """Reader of JOINTS_n, WEIGHTS_n and targets of primitives."""

    def __init__(self, source: GltfSource, accessors: GltfAccessors) -> None:
        self._source = source
        self._accessors = accessors

    def vertex_weights(self, attributes: dict[str, Any], place: str, vertices: int) -> VertexWeights | None:
        """Read the joints and weights of a primitive, normalised to a sum of 1; None where it has none.

        Args:
            attributes: Attributes of the primitive.
            place: Pointer to them.
            vertices: Number of its vertices.
        """
        sets = [n for n in range(_MAX_INFLUENCES // _SET) if f"JOINTS_{n}" in attributes]
        if f"JOINTS_{_MAX_INFLUENCES // _SET}" in attributes:
            self._source.fail(
                f"{place}/JOINTS_{_MAX_INFLUENCES // _SET}", f"more than {_MAX_INFLUENCES} joints a vertex"
            )
        if not sets:
            return None
        self._source.take(12 * _SET * len(sets) * vertices, place)
        joints = np.concatenate([self._joints(attributes, n, place, vertices) for n in sets], axis=1)
        weights = np.concatenate([self._weights(attributes, n, place, vertices) for n in sets], axis=1)
        return self._scaled(joints, weights.astype(np.float64), f"{place}/WEIGHTS_0")

    def morphs(self, primitive: dict[str, Any], place: str, vertices: int) -> tuple[MorphTarget, ...]:
        """Read the morph targets of a primitive, without names."""
        found = []
        targets = self._source.list(primitive, "targets", place)
        if len(targets) > _MAX_MORPHS:
            self._source.fail(f"{place}/targets", f"{len(targets)} morph targets are more than {_MAX_MORPHS}")
        for number, target in enumerate(targets):
            here = f"{place}/targets/{number}"
            target = self._source.entry(target, here)
            positions = self._accessors.of_vertices(target, "POSITION", here, vertices, "VEC3")
            if positions is None:
                self._source.take(12 * vertices, here)
                positions = np.zeros((vertices, 3), np.float32)
            normals = self._accessors.of_vertices(target, "NORMAL", here, vertices, "VEC3")
            found.append(MorphTarget("", positions, normals))
        return tuple(found)

    def weights(self, mesh: dict[str, Any], primitives: list[GltfPrimitive], place: str) -> tuple[float, ...]:
        """Read the default weights of a mesh's morph targets; 0 where it has none."""
        counts = {len(each.mesh.morphs) for each in primitives}
        if len(counts) > 1:
            self._source.fail(f"{place}/primitives", "its primitives have different numbers of morph targets")
        count = counts.pop() if counts else 0
        return self._source.vector(mesh, "weights", place, (0.0,) * count) if count else ()

    def named(self, mesh: dict[str, Any], primitives: list[GltfPrimitive], place: str) -> list[GltfPrimitive]:
        """Return the primitives with the names of their morph targets, from `extras.targetNames`."""
        extras = mesh.get("extras")
        names = extras.get("targetNames") if isinstance(extras, dict) else None
        if not isinstance(names, list) or not all(isinstance(name, str) for name in names):
            return primitives
        result = []
        for each in primitives:
            morphs = tuple(
                replace(morph, name=names[k] if k < len(names) else "") for k, morph in enumerate(each.mesh.morphs)
            )
            result.append(replace(each, mesh=replace(each.mesh, morphs=morphs)) if morphs else each)
        return result

    def _joints(self, attributes: dict[str, Any], number: int, place: str, vertices: int) -> NDArray[np.uint16]:
        name = f"JOINTS_{number}"
        values = self._accessors.whole_numbers(attributes[name], f"{place}/{name}", "VEC4")
        self._accessors.check_count(len(values), vertices, f"{place}/{name}")
        return values

    def _weights(self, attributes: dict[str, Any], number: int, place: str, vertices: int) -> NDArray[np.float32]:
        name = f"WEIGHTS_{number}"
        if name not in attributes:
            self._source.fail(place, f"has JOINTS_{number} and no {name}")
        values = self._accessors.shares(attributes[name], f"{place}/{name}", "VEC4")
        self._accessors.check_count(len(values), vertices, f"{place}/{name}")
        if values.min(initial=0.0) < 0.0:
            vertex = int(np.flatnonzero((values < 0.0).any(axis=1))[0])
            self._source.fail(f"{place}/{name}", f"vertex {vertex} has a negative weight")
        return values

    def _scaled(self, joints: NDArray[np.uint16], weights: NDArray[np.float64], pointer: str) -> VertexWeights:
        """Sort by falling weight, drop unused columns, and normalise each vertex's weights to a sum of 1."""
        sums = weights.sum(axis=1)
        without = np.flatnonzero(sums <= 0.0)
        if without.size == len(sums):
            self._source.fail(pointer, "no vertex follows a joint: all weights are 0", "bind every vertex to a joint")
        if without.size:
            note = f"{pointer}: {counted(without.size, 'vertices')} without a weight, the first is {int(without[0])}"
            self._source.note(f"{note}; each follows the joint that it names first")
            weights[without, 0] = sums[without] = 1.0
        off = np.abs(sums - 1.0) > _UNNORMALISED
        if off.any():
            worst = float(sums[np.argmax(np.abs(sums - 1.0))])
            note = f"{pointer}: weights of {counted(int(off.sum()), 'vertices')} did not add up to 1"
            self._source.note(f"{note} (worst {worst:.3g}) and were scaled")
        order = np.argsort(-weights, axis=1, kind="stable")
        needed = max(1, int((weights > 0.0).sum(axis=1).max()))
        order = order[:, :needed]
        scaled = np.take_along_axis(weights, order, axis=1) / sums[:, None]
        numbers = np.where(scaled > 0.0, np.take_along_axis(joints, order, axis=1), 0).astype(np.uint16)
        return VertexWeights(np.ascontiguousarray(numbers), np.ascontiguousarray(scaled, np.float32))
