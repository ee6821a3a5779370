"""The visible hand of the participant: where it is, and how far it is open."""

from __future__ import annotations

from collections.abc import Sequence

from mimics_app.contracts.arrays import F8, Vec3
from mimics_app.contracts.loop.haptic_objects import ShapeKind
from mimics_app.contracts.messages.stage_messages import HapticSnapshot
from mimics_app.rendering.haptic.scene_objects import SceneObjects
from mimics_app.world.components.hand import GraspingHand
from mimics_app.world.content.motion.layer import Layer
from mimics_app.world.content.world import World
from mimics_app.world.files.scene.scene import Scene
from mimics_app.world.graph.scene_node import SceneNode

__all__ = ["ShownHand", "half_height"]

_CLIP = "grip"
"""Clip of the model of an arm, from closed to open."""


class ShownHand:
    """The entity with the `grasping_hand`: its fingers slide along its x, or the clip of its arm closes them.

    Args:
        scene: The scene; has one `grasping_hand`.
        world: The world built from it.

    Attributes:
        node: Its node, between the fingertips.
        spec: Its component.
    """

    def __init__(self, scene: Scene, world: World) -> None:
        name, self.spec, _ = scene.one(GraspingHand)
        self.node: SceneNode = world.find(name)
        self._fingers = tuple(world.find(finger) for finger in self.spec.fingers)
        self._clips = [_held_clip(world, arm) for arm in (self.spec.arm,) if arm is not None]

    def follow(self, snapshot: HapticSnapshot, objects: SceneObjects) -> None:
        """Show the hand at the HIP, closed by the grasp force; around a held body, whose centre it is at."""
        place, gap = snapshot.hip_world, self.spec.open
        gap += min(1.0, snapshot.grasp / self.spec.closing_force) * (self.spec.closed - self.spec.open)
        if snapshot.held_body >= 0:
            gap = max(gap, half_height(objects, snapshot.held_body))
            place = snapshot.poses[snapshot.held_body, :3]
        self.show(place, gap)

    def show(self, place: Vec3 | F8 | Sequence[float], gap: float) -> None:
        """Place the hand.

        Args:
            place: Between the fingertips, world [m].
            gap: From there to the inner side of a finger [m].
        """
        self.node.set_position(place)
        for finger, side in zip(self._fingers, (-1.0, 1.0), strict=False):
            finger.set_position((side * gap, 0.0, 0.0))
        share = (gap - self.spec.closed) / (self.spec.open - self.spec.closed)
        for layer in self._clips:
            layer.at = min(max(share, 0.0), 1.0) * layer.clip.duration


def half_height(objects: SceneObjects, row: int) -> float:
    """Return the distance from the centre of a body to its surface, by its first shape [m]."""
    shapes = objects.rows.shapes
    shape = next(shapes[i] for i in range(len(shapes)) if shapes[i]["body"] == row)
    size = shape["size"]
    return float(0.5 * size.max() if shape["kind"] == ShapeKind.BOX else size[0])


def _held_clip(world: World, arm: str) -> Layer:
    """Return the clip of the arm's model, which advances only as it is set."""
    return world.motion.animators[world.find(arm).index].play(_CLIP, speed=0.0, loop=False)
