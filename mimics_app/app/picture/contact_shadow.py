"""Shadows that stay when the governor has taken all others: they show where the hand is, and on what people stand."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from msgspec import structs

from mimics_app.app.picture.nudges import hand_of
from mimics_app.contracts.arrays import F8
from mimics_app.maths import quat
from mimics_app.world.components.effects import Projector
from mimics_app.world.content.world import World
from mimics_app.world.files.scene.scene import Scene
from mimics_app.world.graph.scene_node import SceneNode

__all__ = ["ContactShadow"]

_DOT = Projector(shape="dot", depth=1.0, blend="stain", colour=(0.0, 0.0, 0.0, 0.75), full_angle=0.9)

_DOWN = quat.about_axis((1.0, 0.0, 0.0), -0.5 * math.pi)


class _Kind(NamedTuple):
    """A spot of one kind: its size, how far below the node it begins, how deep it is, and from where it is seen [m]."""

    size: tuple[float, float]
    begins: float
    depth: float
    seen: float = math.inf

    def scaled(self, scale: float) -> _Kind:
        """Return it for a model of another size."""
        wide, long = self.size
        return _Kind((wide * scale, long * scale), self.begins * scale, self.depth * scale, self.seen * scale)


_HAND = _Kind((0.10, 0.10), 0.015, 0.8)
_PERSON = _Kind((0.55, 0.85), -0.03, 0.3, 15.0)
"""Under both feet in any phase of a step; it begins just over the soles, so that it does not darken the shoes. Each
costs 1 to 2 ms in the city, and nobody sees those far away."""


class _Spot(NamedTuple):
    node: SceneNode
    under: SceneNode
    kind: _Kind


class ContactShadow:
    """Dark spots on all surfaces straight below the hand and below people; none where the scene has no shadows.

    Args:
        scene: The scene.
        world: The world built from it.
    """

    def __init__(self, scene: Scene, world: World) -> None:
        self.world = world
        self._spots: list[_Spot] = []
        if not any(light.casts_shadow for light in world.lights):
            return
        hand = hand_of(scene, world)
        if hand is not None:
            self._add(hand, _HAND)
        for person in _people(world):
            self._add(person, _PERSON.scaled(float(np.linalg.norm(person.world_matrix()[:3, 1]))))

    def follow(self, eye: F8) -> None:
        """Place them as of the world's last update; of people, only those shown near an eye [m], [3], have one."""
        for node, under, kind in self._spots:
            matrix = under.world_matrix()
            node.visible = math.dist(matrix[:3, 3], eye) < kind.seen and (kind.seen == math.inf or _is_shown(under))
            node.set_position(matrix[:3, 3] - (0.0, kind.begins + 0.5 * kind.depth, 0.0))
            turned, yaw = np.empty(4), math.atan2(matrix[0, 2], matrix[2, 2])
            quat.multiply(quat.about_axis((0.0, 1.0, 0.0), yaw), _DOWN, turned)
            node.set_orientation(turned)

    def _add(self, under: SceneNode, kind: _Kind) -> None:
        node = self.world.root.create_child("")
        self.world.effects.add(node.index, structs.replace(_DOT, size=kind.size, depth=kind.depth))
        self.world.effects.contact_shadows.add(node.index)
        self._spots.append(_Spot(node, under, kind))


def _is_shown(node: SceneNode | None) -> bool:
    """Whether a node and all above it are visible."""
    while node is not None and node.visible:
        node = node.parent
    return node is None


def _people(world: World) -> list[SceneNode]:
    """Return the nodes of all models of people."""
    if not world.motion.animators:
        return []
    from mimics_app.world.content.motion.humanoid import find_humanoid

    rigs = {index: animator.rig for index, animator in world.motion.animators.items()}
    return [world.node(index) for index, rig in rigs.items() if not find_humanoid(rig).missing]
