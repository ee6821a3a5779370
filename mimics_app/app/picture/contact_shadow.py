"""Shadow under the hand that stays when the governor has taken all others: it shows where the hand is."""

from __future__ import annotations

import math

import numpy as np

from mimics_app.app.picture.nudges import hand_of
from mimics_app.maths import quat
from mimics_app.world.components.effects import Projector
from mimics_app.world.content.world import World
from mimics_app.world.files.scene.scene import Scene

__all__ = ["ContactShadow"]

_WIDTH, _DEPTH = 0.10, 0.8
"""Diameter of the spot, and how far below the hand surfaces are darkened [m]."""
_BELOW = 0.015
"""Distance of the uppermost darkened place below the centre of the hand [m]."""
_SPOT = Projector(
    shape="dot", size=(_WIDTH, _WIDTH), depth=_DEPTH, blend="stain", colour=(0.0, 0.0, 0.0, 0.75), full_angle=0.9
)


class ContactShadow:
    """A dark spot on all surfaces below the hand, straight down; nothing where the scene has no shadows or no hand.

    Args:
        scene: The scene.
        world: The world built from it.
    """

    def __init__(self, scene: Scene, world: World) -> None:
        self.world = world
        self._hand, self._node = hand_of(scene, world), None
        if self._hand is None or not any(light.casts_shadow for light in world.lights):
            return
        self._node = world.root.create_child("")
        self._node.set_orientation(quat.about_axis((1.0, 0.0, 0.0), -0.5 * math.pi))
        world.effects.add(self._node.index, _SPOT)
        world.effects.contact_shadows.add(self._node.index)
        self.follow()

    def follow(self) -> None:
        """Place it below the hand as of the world's last update."""
        if self._hand is not None and self._node is not None:
            place = np.array(self._hand.world_matrix()[:3, 3])
            place[1] -= _BELOW + 0.5 * _DEPTH
            self._node.set_position(place)
