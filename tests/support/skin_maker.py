"""Small skinned glTF files made by tests: a bar of boxes on a chain of joints, and what may be said about it."""

from __future__ import annotations

from typing import Any

import numpy as np

from tests.support.gltf_maker import GltfMaker

RINGS, SIDES = 13, 8


def bar_arrays(joints: int = 3) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Positions, normals, indices, joints and weights of a bar 2 m high and 0.2 m wide."""
    height = np.repeat(np.linspace(0.0, 2.0, RINGS), SIDES)
    angle = np.tile(np.linspace(0.0, 2.0 * np.pi, SIDES, endpoint=False), RINGS)
    normals = np.stack([np.cos(angle), 0.0 * angle, np.sin(angle)], axis=1)
    positions = 0.1 * normals + np.stack([0 * height, height, 0 * height], axis=1)
    quads = [
        (r * SIDES + s, r * SIDES + (s + 1) % SIDES, (r + 1) * SIDES + s, (r + 1) * SIDES + (s + 1) % SIDES)
        for r in range(RINGS - 1)
        for s in range(SIDES)
    ]
    indices = np.array([(a, c, b, b, c, d) for a, b, c, d in quads], np.uint16).ravel()
    at = height / 2.0 * (joints - 1)
    low = np.minimum(at.astype(int), joints - 2)
    numbers, weights = np.zeros((len(at), 4)), np.zeros((len(at), 4))
    numbers[:, 0], numbers[:, 1] = low, low + 1
    weights[:, 0], weights[:, 1] = 1.0 - (at - low), at - low
    return positions.astype("f4"), normals.astype("f4"), indices, numbers.astype(np.uint8), weights.astype("f4")


def bar(joints: int = 3, *, weights: np.ndarray | None = None, normalized: bool = False) -> GltfMaker:
    """A maker of the bar: node 0 carries the mesh, nodes 1 to `joints` are the chain."""
    maker = GltfMaker()
    positions, normals, indices, numbers, shares = bar_arrays(joints)
    shares = shares if weights is None else weights
    attributes = {
        "POSITION": maker.array(positions),
        "NORMAL": maker.array(normals),
        "JOINTS_0": maker.array(numbers),
        "WEIGHTS_0": maker.array(shares, **({"normalized": True} if normalized else {})),
    }
    step = 2.0 / (joints - 1)
    inverse = np.tile(np.eye(4, dtype="f4"), (joints, 1, 1))
    inverse[:, 3, 1] = -step * np.arange(joints)  # stored column by column
    nodes: list[dict[str, Any]] = [{"name": "Bar", "mesh": 0, "skin": 0}]
    for j in range(joints):
        node: dict[str, Any] = {"name": f"joint{j}", "translation": [0.0, step if j else 0.0, 0.0]}
        if j + 1 < joints:
            node["children"] = [j + 2]
        nodes.append(node)
    maker.more = {
        "scene": 0,
        "scenes": [{"nodes": [0, 1]}],
        "nodes": nodes,
        "meshes": [{"name": "BarMesh", "primitives": [{"attributes": attributes, "indices": maker.array(indices)}]}],
        "skins": [
            {
                "name": "Chain",
                "joints": list(range(1, joints + 1)),
                "inverseBindMatrices": maker.array(inverse.reshape(joints, 16)),
            }
        ],
    }
    return maker


def turn(axis: str, degrees: float) -> list[float]:
    """A quaternion about x, y or z."""
    half = np.radians(degrees) / 2.0
    quaternion = [0.0, 0.0, 0.0, float(np.cos(half))]
    quaternion["xyz".index(axis)] = float(np.sin(half))
    return quaternion


def add_clip(
    maker: GltfMaker, name: str, channels: list[tuple[int, str, np.ndarray, np.ndarray, str]], **extra: Any
) -> None:
    """Add an animation of (node, path, times, values, interpolation)."""
    samplers, listed = [], []
    for node, path, times, values, kind in channels:
        source = maker.array(np.asarray(times, "f4").reshape(-1, 1))
        data = np.asarray(values, "f4")
        data = data.reshape(-1, 1) if path == "weights" else data.reshape(-1, data.shape[-1])
        samplers.append({"input": source, "output": maker.array(data), "interpolation": kind})
        listed.append({"sampler": len(samplers) - 1, "target": {"node": node, "path": path}})
    maker.more.setdefault("animations", []).append({"name": name, "samplers": samplers, "channels": listed, **extra})
