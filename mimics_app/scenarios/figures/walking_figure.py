"""Functions shared by figures that walk: place, pace and legs of a model, and eyes that do not see their own head."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from mimics_app.maths import quat
from mimics_app.world.graph.scene_node import SceneNode

if TYPE_CHECKING:
    from mimics_app.contracts.arrays import F8
    from mimics_app.world.content.motion.animator import Animator
    from mimics_app.world.content.motion.gait import Pace, Walk
    from mimics_app.world.content.motion.motion import Motion
    from mimics_app.world.graph.camera import Camera

__all__ = ["OWN_HEAD", "add_walk", "below", "pace_at", "pace_with", "see_past_head", "stand"]

Part = TypeVar("Part")
"""An animator or a state machine."""

_CRAWL = 0.02
"""Speed below which the legs stand [m/s]."""
OWN_HEAD = 0.15
"""Distance from the eyes within which everything of the own head is that could be seen [m]; a test measures it."""


def stand(node: SceneNode, place: tuple[float, float, float], yaw: float, ahead: float) -> None:
    """Place a figure.

    Args:
        node: The figure's node.
        place: Its position [m].
        yaw: Where the figure looks: angle about +y from +z [rad].
        ahead: 1 for a figure that looks along +z of its node, -1 along -z.
    """
    node.set_position(np.array(place))
    node.set_orientation(quat.about_axis((0.0, 1.0, 0.0), yaw + (0.0 if ahead > 0.0 else math.pi)))


def pace_at(speed: float) -> Pace:
    """Return the pace of the legs at a speed [m/s], negative for walking backwards; they stand when it is tiny."""
    from mimics_app.world.content.motion.gait import Pace, natural_step

    return Pace(0.0, 0.0) if abs(speed) < _CRAWL else Pace(speed, natural_step(abs(speed)))


def pace_with(speed: float, step: float) -> Pace:
    """Return the pace of the legs at a speed [m/s] with a step [m]; they stand when the speed is tiny."""
    from mimics_app.world.content.motion.gait import Pace

    return Pace(0.0, 0.0) if abs(speed) < _CRAWL else Pace(speed, step)


def below(node: SceneNode, parts: Mapping[int, Part]) -> Part | None:
    """Return the part, by the index of its node, of the model at a node or at a child of it."""
    return next((parts[each.index] for each in (node, *node.children) if each.index in parts), None)


def see_past_head(cameras: Iterable[Camera], person: SceneNode) -> None:
    """Let the cameras at a person's eyes begin in front of the person's own head.

    Every other camera, a mirror and the sun see the head.

    Args:
        cameras: All cameras.
        person: Node of the person; its eyes are cameras below it.
    """
    for camera in cameras:
        parent = camera.node.parent
        if parent is not None and parent.index == person.index:
            camera.near = max(camera.near, OWN_HEAD)


def add_walk(
    motion: Motion,
    animator: Animator | None,
    pace: Callable[[], Pace],
    ground: Callable[[], tuple[float, float, float]],
    material: Callable[[], str] = str,
    *,
    legs: Callable[[], F8] | None = None,
    phase: Callable[[], float] | None = None,
    step: str = "step",
) -> Walk | None:
    """Let the legs of a model walk with its node, each heel strike an event; without a model nothing happens.

    Args:
        motion: Motion of the model's world.
        animator: Animator of the model.
        pace: Returns speed and step length.
        ground: Returns the model's place and heading on the ground: x, z [m] and the angle about +y from +z [rad].
        material: Returns the material of the ground under the model, "" for that of the scene.
        legs: Returns the present angles of the person's legs, see `Walk`; None: by the published curves.
        phase: Returns the phase of the person's left leg; None: the model's own.
        step: Kind of the event of a heel strike.

    Returns:
        The gait of the model; None without one.
    """
    if animator is None:
        return None
    from mimics_app.world.content.motion.gait import LeadingLegs, Walk
    from mimics_app.world.content.motion.humanoid import find_humanoid
    from mimics_app.world.content.motion.soles import outline_soles

    bones = find_humanoid(animator.rig)
    if bones.missing:
        return None
    walk = Walk(
        animator.rig,
        bones,
        pace,
        legs=LeadingLegs(None if legs is None else lambda _: legs(), phase),
        ground=ground,
        soles=outline_soles(animator.rig, bones, motion.bodies.values()),
        events=lambda event: animator.events.append(replace(event, kind=step, material=material())),
    )
    animator.steps.insert(0, walk)  # the head turns to a person after the trunk has
    return walk
