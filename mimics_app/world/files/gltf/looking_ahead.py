"""Persons who look another way than +z in their file are turned round: everything here takes +z as the front."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from mimics_app.world.content.motion.facing import facing
from mimics_app.world.content.motion.humanoid import find_humanoid
from mimics_app.world.content.motion.pose import Pose
from mimics_app.world.content.motion.rig import Rig
from mimics_app.world.files.gltf.nodes import GltfNode
from mimics_app.world.files.gltf.skins import GltfSkin

__all__ = ["turn_to_front"]


_WORDS = {1: "+x", 2: "-z", 3: "-x"}
"""Where one looks who is so many quarters of a turn about +y from +z."""


def turn_to_front(
    nodes: list[GltfNode], roots: list[int], skins: Sequence[GltfSkin], bones: Mapping[str, int]
) -> tuple[list[int], str]:
    """Hang the roots of a person's model on a new node that turns it to look along +z.

    Args:
        nodes: Nodes of the file; where the person looks another way one is added.
        roots: Roots of the default scene.
        skins: Skins of the file.
        bones: Node of each bone that the file names, see `read_bones`.

    Returns:
        The roots, and where the person looked; "" where nothing is turned.
    """
    rig = _skeleton(nodes, roots, bones)
    joints = {joint for skin in skins for joint in skin.joints}
    found = find_humanoid(rig)
    if not found.complete or not any(rig.entities[slot] in joints for slot in found.slots.values()):
        return roots, ""
    yaw = facing(rig.rest_places(), found.slots)
    quarters = 0 if yaw is None else round(yaw / (0.5 * math.pi)) % 4
    if not quarters:
        return roots, ""
    half = -0.25 * math.pi * quarters
    number = len(nodes)
    nodes.append(GltfNode(rotation=(0.0, math.sin(half), 0.0, math.cos(half)), children=list(roots)))
    for root in roots:
        nodes[root].parent = number
    return [number], _WORDS[quarters]


def _skeleton(nodes: Sequence[GltfNode], roots: Sequence[int], bones: Mapping[str, int]) -> Rig:
    """Return the nodes of the scene as a rig, whose entities are the numbers of the nodes."""
    order, waiting = list[int](), list(reversed(roots))
    while waiting:
        order.append(waiting.pop())
        waiting += reversed(nodes[order[-1]].children)
    slot = {index: number for number, index in enumerate(order)}
    here = [nodes[index] for index in order]
    rest = Pose(
        np.array([node.translation for node in here]).reshape(-1, 3),
        np.array([node.rotation for node in here]).reshape(-1, 4),
        np.array([node.scale for node in here]).reshape(-1, 3),
        np.zeros(0),
    )
    parents = np.array([slot.get(-1 if node.parent is None else node.parent, -1) for node in here], np.int32)
    return Rig(
        tuple(node.name for node in here),
        np.array(order, np.int32),
        parents,
        rest,
        np.zeros(len(order) + 1, np.int32),
        (),
        bones={bone: slot[index] for bone, index in bones.items() if index in slot},
    )
