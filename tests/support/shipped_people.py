"""The shipped people as arrays, read from their files: what is judged is what is shipped."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from assets.builders.avatars.person import EVERYBODY, Person
from assets.builders.avatars.skeleton import Skeleton, make_skeleton
from mimics_app.contracts.system.resources import root
from mimics_app.world.files.gltf.file import load_gltf

F8 = NDArray[np.float64]
I8 = NDArray[np.int64]

NAMES = [person.name for person in EVERYBODY]


@dataclass(frozen=True)
class Part:
    """What of a person has one material, in full detail: corners [m], normals, triangles, weights of joints, morphs."""

    places: F8
    normals: F8
    triangles: I8
    weights: F8
    moves: dict[str, F8]


@dataclass(frozen=True)
class Shipped:
    """A person of the files: who it is, their joints at rest, and their parts by material."""

    person: Person
    bones: Skeleton
    parts: dict[str, Part]


def load_shipped(name: str) -> Shipped:
    """One of the shipped people."""
    person = next(each for each in EVERYBODY if each.name == name)
    bones = make_skeleton(person)
    model = load_gltf(root() / "assets" / "models" / "avatars" / f"{name}.glb", without_pictures=True)
    parts = {}
    for node in model.nodes:
        if node.mesh is None or node.skin is None or not node.levels:
            continue
        joints = np.array([bones.index(model.nodes[joint].name) for joint in model.skins[node.skin].joints])
        mesh = model.meshes[node.mesh]
        for primitive in mesh.primitives:
            given, bound = primitive.mesh, primitive.mesh.weights
            assert bound is not None and primitive.material is not None
            weights = np.zeros((len(given.positions), len(bones.names)))
            for k in range(bound.influences):
                np.add.at(weights, (np.arange(len(weights)), joints[bound.joints[:, k]]), bound.weights[:, k])
            moves = {target.name: target.positions.astype(float) for target in given.morphs}
            parts[model.materials[primitive.material].name] = Part(
                given.positions.astype(float),
                given.normals.astype(float),
                np.asarray(given.indices, np.int64).reshape(-1, 3),
                weights,
                moves,
            )
    return Shipped(person, bones, parts)
