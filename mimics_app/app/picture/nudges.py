"""Load of a frame of a run before its first one: something moves, and the rest of the picture stays."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from mimics_app.world.components.hand import GraspingHand
from mimics_app.world.components.robot import Ball
from mimics_app.world.content.world import World
from mimics_app.world.files.scene.scene import Scene
from mimics_app.world.graph.scene_node import SceneNode

__all__ = ["hand_of", "nudges_of"]

_FAR = 0.01
"""Length of a nudge [m]: a hand at 0.6 m/s moves as far in a frame."""


def hand_of(scene: Scene, world: World) -> SceneNode | None:
    """Return the node that shows where the person's hand is; None in a scene without one."""
    named = [entity for kind in (Ball, GraspingHand) for entity, _, _ in scene.components(kind)]
    return next((world.find(entity) for entity in named if entity in world), None)


def nudges_of(scene: Scene, world: World) -> Callable[[], None]:
    """Return a function that moves what a person moves to and fro by what it moves in a frame, and updates the world.

    It is the hand; and where the first camera is carried by another node, that node, with which the whole picture
    changes.
    """
    hand = hand_of(scene, world)
    carrier = world.cameras[0].node.parent
    carriers = [] if carrier is None or carrier.index == world.root.index else [carrier]
    places = [(node, np.array(node.position)) for node in ([] if hand is None else [hand]) + carriers]
    away = False

    def nudge() -> None:
        nonlocal away
        away = not away
        for node, place in places:
            node.set_position(place + (_FAR if away else 0.0) * np.array([1.0, 1.0, 0.0]))
        world.update()

    return nudge
