"""A person of sticks made by tests: the bones by any names, a skinned tube on the arms, nothing of a real body."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from tests.support.gltf_maker import GltfMaker, write_gltf

PLACES: dict[str, tuple[str, tuple[float, float, float]]] = {
    "hips": ("", (0.0, 0.95, 0.0)),
    "spine": ("hips", (0.0, 1.05, 0.0)),
    "chest": ("spine", (0.0, 1.18, 0.0)),
    "upperChest": ("chest", (0.0, 1.30, 0.0)),
    "neck": ("upperChest", (0.0, 1.48, 0.0)),
    "head": ("neck", (0.0, 1.58, 0.01)),
}
for _side, _word in ((1.0, "left"), (-1.0, "right")):
    PLACES |= {
        f"{_word}Eye": ("head", (_side * 0.03, 1.64, 0.08)),
        f"{_word}Shoulder": ("upperChest", (_side * 0.03, 1.42, 0.0)),
        f"{_word}UpperArm": (f"{_word}Shoulder", (_side * 0.17, 1.42, 0.0)),
        f"{_word}LowerArm": (f"{_word}UpperArm", (_side * 0.36, 1.21, -0.01)),
        f"{_word}Hand": (f"{_word}LowerArm", (_side * 0.54, 1.01, 0.01)),
        f"{_word}UpperLeg": ("hips", (_side * 0.09, 0.92, 0.0)),
        f"{_word}LowerLeg": (f"{_word}UpperLeg", (_side * 0.09, 0.50, 0.01)),
        f"{_word}Foot": (f"{_word}LowerLeg", (_side * 0.09, 0.08, -0.02)),
        f"{_word}Toes": (f"{_word}Foot", (_side * 0.09, 0.02, 0.12)),
    }


REST_ARMS = {"A": 45.0, "T": 0.0, "low": 60.0, "down": 85.0}
"""Angle of the arms below the horizontal in rest poses that are in use [degrees]."""

Places = dict[str, tuple[str, tuple[float, float, float]]]


def resting(arms: float, *, apart: float = 0.0) -> Places:
    """The bones with stretched arms at an angle below the horizontal and legs apart [degrees]."""
    places = dict(PLACES)
    for side, word in ((1.0, "left"), (-1.0, "right")):
        way = np.array([side * np.cos(np.radians(arms)), -np.sin(np.radians(arms)), 0.0])
        leg = np.array([side * np.sin(np.radians(apart)), -np.cos(np.radians(apart)), 0.0])
        at, hip = np.array(PLACES[f"{word}UpperArm"][1]), np.array(PLACES[f"{word}UpperLeg"][1])
        for bone, away in (("LowerArm", 0.28), ("Hand", 0.55)):
            places[word + bone] = (PLACES[word + bone][0], tuple(at + away * way))
        for bone in ("LowerLeg", "Foot", "Toes"):
            old = np.array(PLACES[word + bone][1])
            moved = hip + (hip[1] - old[1]) * leg + (0.0, 0.0, old[2])
            places[word + bone] = (PLACES[word + bone][0], tuple(moved))
    return places


def person(
    names: dict[str, str] | None = None,
    *,
    scale: float = 1.0,
    turns: dict[str, list[float]] | None = None,
    places: Places | None = None,
    armature: bool = False,
    back: bool = False,
) -> GltfMaker:
    """A maker of the person; node 0 is the body, bones follow.

    Args:
        names: What bones are called; absent: as VRM 1.0 has it.
        scale: Of all lengths.
        turns: Rotation in the model of some bones at rest (xyzw): their children's places are given in it.
        places: Parent and place of each bone; absent: `PLACES`.
        armature: True: the hips hang below a node turned by -90 degrees about x, in centimetres, as most exports have.
        back: True: looks along -z.
    """
    maker = GltfMaker()
    bones = PLACES if places is None else places
    way = np.array([-1.0, 1.0, -1.0]) if back else np.ones(3)
    bones = {bone: (parent, tuple(way * np.array(place))) for bone, (parent, place) in bones.items()}
    order = list(bones)
    stands = np.array([-(0.5**0.5), 0.0, 0.0, 0.5**0.5]) if armature else np.array((0, 0, 0, 1.0))
    size = 0.01 if armature else 1.0
    turned = {bone: np.array((turns or {}).get(bone, stands)) for bone in order}
    nodes = [{"name": "Body", "mesh": 0, "skin": 0}]
    for bone in order:
        parent, place = bones[bone]
        above = np.array(bones[parent][1]) if parent else np.zeros(3)
        back_turn = _conjugate(turned[parent]) if parent else _conjugate(stands)
        local = _rotate(back_turn, scale / size * (np.array(place) - above))
        nodes.append(
            {
                "name": (names or {}).get(bone, bone),
                "translation": local.tolist(),
                "rotation": _multiply(back_turn, turned[bone]).tolist(),
                "children": [1 + k for k, child in enumerate(order) if bones[child][0] == bone],
            }
        )
        if not nodes[-1]["children"]:
            del nodes[-1]["children"]
    if armature:
        nodes.append({"name": "Armature", "rotation": stands.tolist(), "scale": [size] * 3, "children": [1]})
    positions = np.array([scale * np.array(bones[bone][1]) + d for bone in order for d in np.eye(3) * 0.03], "f4")
    joints = np.zeros((len(positions), 4), np.uint8)
    joints[:, 0] = np.repeat(np.arange(len(order)), 3)
    weights = np.tile(np.array([1, 0, 0, 0], "f4"), (len(positions), 1))
    inverse = np.zeros((len(order), 4, 4), "f4")
    for k, bone in enumerate(order):
        own = _conjugate(turned[bone])
        inverse[k, :3, :3] = np.array([_rotate(own, axis) for axis in np.eye(3)]) / size  # stored column by column
        inverse[k, 3, :3] = -_rotate(own, scale / size * np.array(bones[bone][1]))
        inverse[k, 3, 3] = 1.0
    attributes = {
        "POSITION": maker.array(positions),
        "NORMAL": maker.array(np.tile(np.array([0, 0, 1], "f4"), (len(positions), 1))),
        "JOINTS_0": maker.array(joints),
        "WEIGHTS_0": maker.array(weights),
    }
    bound = maker.array(inverse.reshape(-1, 16))
    maker.more = {
        "scene": 0,
        "scenes": [{"nodes": [0, len(nodes) - 1 if armature else 1]}],
        "nodes": nodes,
        "meshes": [{"name": "Body", "primitives": [{"attributes": attributes}]}],
        "skins": [{"joints": list(range(1, 1 + len(order))), "inverseBindMatrices": bound}],
    }
    return maker


def write_person(path: Path, **options: object) -> Path:
    """The person as a file."""
    return write_gltf(path, person(**options).document())  # type: ignore[arg-type]


def _conjugate(q: np.ndarray) -> np.ndarray:
    return q * (-1, -1, -1, 1)


def _multiply(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return np.append(a[3] * b[:3] + b[3] * a[:3] + np.cross(a[:3], b[:3]), a[3] * b[3] - a[:3] @ b[:3])


def _rotate(q: np.ndarray, v: np.ndarray) -> np.ndarray:
    turn = 2.0 * np.cross(q[:3], v)
    return v + q[3] * turn + np.cross(q[:3], turn)
