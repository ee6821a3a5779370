"""Hints on a scene without faults: likely mistakes, such as lengths in millimetres, and ports open to the network."""

from __future__ import annotations

from difflib import get_close_matches

import numpy as np

from mimics_app.contracts.errors import Issue
from mimics_app.contracts.loop.gait_state import GAIT_STATES
from mimics_app.contracts.messages.trial_state import TrialState
from mimics_app.inputs.trackers.network_place import hears_the_network, listening, place_of
from mimics_app.rendering.haptic.devices.robot_reach import Reach
from mimics_app.world.components.haptic_shapes import (
    BoxSolid,
    CapsuleSolid,
    CylinderSolid,
    MeshSolid,
    Solid,
    SphereSolid,
)
from mimics_app.world.components.objects import HapticObject
from mimics_app.world.components.robot import Robot
from mimics_app.world.components.visible import Sound
from mimics_app.world.files.scene.object_bodies import shapes_of
from mimics_app.world.files.scene.placing import pose_of
from mimics_app.world.files.scene.scene import Scene

__all__ = ["hints"]

_MAX_WIDTH = 10.0
"""Width of an object above which its unit is likely another one [m]; robots reach about 1 m."""

_MAX_DISTANCE = 2.0
"""Distance from the centre of the workspace beyond which nothing is felt [m]."""

_TRIGGERS = (
    "contact", "contact_end", "impact", "start", "goal", "step",
    *GAIT_STATES, *(state.name.lower() for state in TrialState),
)  # fmt: skip
"""Triggers of the loop, the task and walkers. Models and scenarios have more, so an unknown name is no fault."""

_ALIKE = 0.75
"""Similarity above which a name is taken as misspelt, as defined in difflib."""


def hints(scene: Scene) -> list[Issue]:
    """Return the hints on a scene that passed every check, each with its JSON pointer."""
    return [*_triggers(scene), *_sizes(scene), *_out_of_reach(scene), *_open_doors(scene)]


def _open_doors(scene: Scene) -> list[Issue]:
    what, fix = (
        "other machines can send poses here",
        "give 127.0.0.1:PORT if the sender runs on this one",
    )
    return [
        scene.issue(pointer, f'"{address}": {what}', fix)
        for pointer, address in listening(scene)
        if hears_the_network(place_of(address)[0])
    ]


def _triggers(scene: Scene) -> list[Issue]:
    found = []
    for _, sound, pointer in scene.components(Sound):
        name = sound.trigger or ""
        close = get_close_matches(name, _TRIGGERS, n=1, cutoff=_ALIKE)
        if name and name not in _TRIGGERS and close:
            what = f'no part of this scene sends the trigger "{name}"'
            found.append(scene.issue(f"{pointer}/trigger", what, f'did you mean "{close[0]}"'))
    return found


def _sizes(scene: Scene) -> list[Issue]:
    return [
        scene.issue(pointer, f'"{name}" is {2.0 * radius:g} m wide', "lengths are metres")
        for name, body, pointer in scene.components(HapticObject)
        if 2.0 * (radius := _radius(scene, name, body)) > _MAX_WIDTH
    ]


def _out_of_reach(scene: Scene) -> list[Issue]:
    if not scene.components(Robot):
        return []
    reach = Reach(scene.one(Robot)[1])
    centre = reach.points(0.5 * (np.array(reach.limits.lowest) + np.array(reach.limits.highest)))[0]
    found = []
    for name, body, pointer in scene.components(HapticObject):
        place = pose_of(scene, name)[0]
        away = float(np.linalg.norm(reach.from_world(place) - centre)) - _radius(scene, name, body)
        if away > _MAX_DISTANCE:
            what = f'"{name}" is {away:.1f} m from where the robot is, out of its reach'
            found.append(scene.issue(pointer, what, "move it or the robot (robot_to_world)"))
    return found


def _radius(scene: Scene, name: str, body: HapticObject) -> float:
    """Return the radius of the sphere about the entity's origin that contains its shapes, except for meshes [m]."""
    return max(_radius_of(shape) for shape in shapes_of(scene, name, body))


def _radius_of(shape: Solid) -> float:
    away = float(np.linalg.norm(shape.position))
    if isinstance(shape, BoxSolid):
        return away + 0.5 * float(np.linalg.norm(shape.size))
    if isinstance(shape, SphereSolid):
        return away + shape.radius
    if isinstance(shape, CylinderSolid | CapsuleSolid):
        return away + 0.5 * shape.length + shape.radius
    assert isinstance(shape, MeshSolid)
    return away
