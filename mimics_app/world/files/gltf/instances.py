"""Meshes that a node shows several times (EXT_mesh_gpu_instancing), as child nodes with one mesh each."""

from __future__ import annotations

import math

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.world.content.meshes.mesh import FARTHEST
from mimics_app.world.files.gltf.accessors import GltfAccessors
from mimics_app.world.files.gltf.gltf_document import MAX_ITEMS, GltfSource
from mimics_app.world.files.gltf.nodes import GltfNode

__all__ = ["INSTANCING", "expand_instances"]


INSTANCING = "EXT_mesh_gpu_instancing"
_ATTRIBUTES: dict[str, tuple[str, tuple[float, ...]]] = {
    "TRANSLATION": ("VEC3", (0.0, 0.0, 0.0)),
    "ROTATION": ("VEC4", (0.0, 0.0, 0.0, 1.0)),
    "SCALE": ("VEC3", (1.0, 1.0, 1.0)),
}
"""Type of each attribute, and its value where it is absent."""


def expand_instances(source: GltfSource, accessors: GltfAccessors, nodes: list[GltfNode]) -> None:
    """Give each node with instances one child per instance, which shows its mesh; faults are collected.

    Args:
        source: The file.
        accessors: Its accessors.
        nodes: Nodes in file order; children are added behind them.
    """
    for index, item in enumerate(source.table("nodes")):
        with source.collecting():
            extension = source.extension(item, INSTANCING, f"/nodes/{index}")
            if extension and nodes[index].mesh is not None:
                _expand(source, accessors, nodes, index, extension)


def _expand(
    source: GltfSource, accessors: GltfAccessors, nodes: list[GltfNode], index: int, extension: dict[str, object]
) -> None:
    place, node = f"/nodes/{index}/extensions/{INSTANCING}", nodes[index]
    attributes = source.object(extension, "attributes", place)
    if node.skin is not None:
        source.fail(place, "a skinned mesh has no instances")
    given = {name: _values(source, accessors, attributes, name, place) for name in _ATTRIBUTES if name in attributes}
    counts = {len(values) for values in given.values()}
    if len(counts) != 1:
        source.fail(f"{place}/attributes", "has no TRANSLATION, ROTATION or SCALE, or these differ in number")
    count = counts.pop()
    if len(nodes) + count > MAX_ITEMS:
        source.fail(place, f"{count} instances are too many: a model has at most {MAX_ITEMS} nodes")
    columns = [given.get(name, np.tile(rest, (count, 1))).tolist() for name, (_, rest) in _ATTRIBUTES.items()]
    for shift, turn, size in zip(*columns, strict=True):
        node.children.append(len(nodes))
        nodes.append(
            GltfNode(
                translation=tuple(shift),
                rotation=tuple(turn),
                scale=tuple(size),
                parent=index,
                mesh=node.mesh,
                morph_weights=node.morph_weights,
            )
        )
    node.mesh = None


def _values(source: GltfSource, accessors: GltfAccessors, attributes: dict[str, object], name: str, place: str) -> F8:
    where = f"{place}/attributes/{name}"
    values = accessors.floats(attributes[name], where, _ATTRIBUTES[name][0]).astype(np.float64)
    if name != "ROTATION":
        farthest = float(np.abs(values).max(initial=0.0))
        if farthest > FARTHEST:
            source.fail(where, f"{farthest:g} is beyond {FARTHEST:g}")
        return values
    lengths = np.linalg.norm(values, axis=1, keepdims=True)
    if lengths.size and not lengths.min() > math.ulp(1.0):
        source.fail(where, f"rotation {int(np.argmin(lengths))} is a zero quaternion")
    return values / lengths
