"""Checks of a scene's contacts against the region that is stable on its device: what no cap could render is refused."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from mimics_app.contracts.errors import DeviceError, Issue, SceneError
from mimics_app.contracts.loop.controller_slots import CommandKind, Slot
from mimics_app.contracts.loop.device_descriptor import Dynamics
from mimics_app.contracts.loop.haptic_objects import STATIC, EffectKind, ForceLaw, ShapeKind
from mimics_app.contracts.loop.loop_ports import DevicePlugin
from mimics_app.rendering.haptic.devices.dynamics import known_dynamics, opened_dynamics
from mimics_app.rendering.haptic.kernels.closed_region import REGION, find_region, stiffness_limit
from mimics_app.rendering.haptic.scene_block import scene_from_components
from mimics_app.rendering.haptic.scene_objects import SceneObjects, objects_of_scene
from mimics_app.world.components.objects import HapticEffect, HapticObject, HapticWalls
from mimics_app.world.components.robot import Admittance, Impedance, Robot, Safety, Tunnel
from mimics_app.world.files.scene.scene import Scene

__all__ = ["check_stability", "softened_contacts"]

_PERIOD = 1e-3
"""Period of the loop [s]."""

_MOST_VIRTUAL = 0.5
"""Largest virtual damping [virtual masses per tick], as the loop renders it."""

_STEPS = 64

_FIELDS = {
    "delay": "device_delay",
    "lag": "device_lag",
    "filtering": "device_filter",
    "quantum": "device_quantum",
    "mass": "device_mass",
}
"""Field of SCENE of each number of the dynamics."""


class _Stable:
    """What is stable on a scene's device at its nominal period and delay.

    Args:
        scene: The checked scene.
        robot: Its robot.
        dynamics: Dynamics of that robot.

    Attributes:
        name: Name of the device.
        damping: Largest damping of a contact [N s/m].
        stiffness: Largest stiffness at any damping [N/m].
    """

    def __init__(self, scene: Scene, robot: Robot, dynamics: Dynamics) -> None:
        block = scene_from_components(robot, scene.first(Admittance), safety=scene.first(Safety))[0]
        for name, value in dynamics.items():
            block[_FIELDS[name]] = value
        if dynamics["mass"] > 0.0:
            block["force_driven"], block["commands"][Slot.PERSON] = 1, CommandKind.FORCE
            block["virtual_damping"] = 0.0
            block["device_damping"] = (scene.first(Impedance) or Impedance()).device_damping
        region = np.zeros(1, REGION)[0]
        find_region(block, float(block["device_delay"]), _PERIOD, region)
        self.name = robot.device
        self.damping = float(region["most_damping"])
        tries = np.linspace(0.0, self.damping, _STEPS)
        self.stiffness = max(stiffness_limit(region, float(B)) for B in tries)

    def fault(self, stiffness: float, damping: float) -> tuple[str, str, str] | None:
        """Return field, fault and remedy of a contact [N/m, N s/m] that cannot be rendered; None: it can."""
        if damping > self.damping:
            what = f"{damping:g} N s/m shakes at any stiffness: {self.name} holds up to {self.damping:.0f} N s/m"
            return "damping", what, f"stay below {0.8 * self.damping:.0f}"
        if stiffness > self.stiffness:
            what = f"{stiffness:g} N/m shakes at any damping: {self.name} holds up to {self.stiffness:.0f} N/m"
            return "stiffness", what, f"stay below {0.8 * self.stiffness:.0f}"
        return None


def check_stability(scene: Scene) -> list[Issue]:
    """Return the contacts that the scene's device cannot hold, and the thin ones that a hand goes through.

    Of a real device only what is known before it runs counts: see `known_dynamics`.
    """
    robot = scene.first(Robot) or Robot()
    try:
        objects = objects_of_scene(scene)
    except SceneError as error:
        return error.issues
    thin = _check_thin(scene, objects)
    try:
        dynamics = known_dynamics(robot)
    except DeviceError:  # a device that does not exist is reported elsewhere
        dynamics = None
    if dynamics is None:
        return thin
    stable = _Stable(scene, robot, dynamics)
    return [*_check_controller(scene, dynamics, stable), *_check_contacts(scene, objects, stable), *thin]


def softened_contacts(scene: Scene, robot: Robot, plugin: DevicePlugin) -> list[str]:
    """Return a line for each contact that an open device cannot hold as the scene asks: the loop softens it."""
    dynamics = opened_dynamics(plugin)
    if dynamics is None:
        return []
    found = _check_contacts(scene, objects_of_scene(scene), _Stable(scene, robot, dynamics))
    return [f"{issue.pointer}: {issue.what}" for issue in found]


def _check_controller(scene: Scene, dynamics: Dynamics, stable: _Stable) -> Iterator[Issue]:
    """Return the faults of damping that is rendered with every force."""
    for _, impedance, pointer in scene.components(Impedance):
        if dynamics["mass"] > 0.0 and impedance.damping > stable.damping:
            what = f"{impedance.damping:g} N s/m shakes: {stable.name} holds up to {stable.damping:.0f} N s/m"
            yield scene.issue(f"{pointer}/damping", what, f"stay below {0.8 * stable.damping:.0f}")
    for _, admittance, pointer in scene.components(Admittance):
        most = _MOST_VIRTUAL * admittance.mass / _PERIOD
        if admittance.damping > most:
            what = f"{admittance.damping:g} N s/m on {admittance.mass:g} kg shakes: the loop renders up to {most:g}"
            yield scene.issue(f"{pointer}/damping", what, "lower it, or raise the mass")


def _contacts_of(scene: Scene, objects: SceneObjects) -> Iterator[tuple[str, float, float]]:
    """Pointer, stiffness and damping of every contact, at the largest force for a law that stiffens."""
    pointers = _pointers(scene)
    force = (scene.first(Safety) or Safety()).force_limit
    for row, entity in zip(objects.rows.shapes, objects.shape_entities, strict=True):
        yield pointers[entity], *_at_force(row, force)
    for row, entity in zip(objects.rows.tunnels, objects.tunnel_entities, strict=True):
        yield pointers.get(entity, ""), float(row["stiffness"]), float(max(row["damping"], row["drag"]))
    for row, entity in zip(objects.rows.effects, objects.effect_entities, strict=True):
        if row["kind"] not in (EffectKind.FIELD, EffectKind.VIBRATION, EffectKind.CONSTANT) and not row["on_body"]:
            yield pointers.get(entity, ""), float(row["stiffness"]), float(row["damping"])


def _pointers(scene: Scene) -> dict[str, str]:
    kinds: tuple[type[Any], ...] = (HapticObject, HapticWalls, HapticEffect, Tunnel)
    return {entity: pointer for kind in kinds for entity, _, pointer in scene.components(kind)}


def _at_force(row: np.void, force: float) -> tuple[float, float]:
    """Stiffness [N/m] and damping [N s/m] of a surface at a force [N]."""
    k, b = float(row["stiffness"]), float(row["damping"])
    if row["law"] != ForceLaw.HUNT_CROSSLEY:
        return k, b
    n = float(row["exponent"])
    depth = (force / k) ** (1.0 / n)
    return k * n * depth ** (n - 1.0), k * b * depth**n


def _check_contacts(scene: Scene, objects: SceneObjects, stable: _Stable) -> Iterator[Issue]:
    reported = set()
    for pointer, stiffness, damping in _contacts_of(scene, objects):
        found = stable.fault(stiffness, damping)
        if found is not None and (pointer, found[0]) not in reported:
            reported.add((pointer, found[0]))
            yield scene.issue(f"{pointer}/{found[0]}", found[1], found[2])


def _thickness(row: np.void) -> float:
    """Depth at which a primitive of the static scene lets a point go to its other side [m]; inf: never."""
    size = row["size"]
    if row["body"] != STATIC or row["kind"] in (ShapeKind.WALL, ShapeKind.MESH):
        return math.inf
    if row["kind"] == ShapeKind.BOX:  # the face of entry is held behind it, while its bounds are near
        return float(0.5 * size.min() + 0.5 * np.linalg.norm(size))
    return float(2.0 * size[0])


def _check_thin(scene: Scene, objects: SceneObjects) -> list[Issue]:
    """Return the fixed shapes through which less than the force limit presses a hand."""
    pointers = _pointers(scene)
    force = (scene.first(Safety) or Safety()).force_limit
    points = objects.rows.points["radius"]
    radius = float(points.min()) if len(points) else 0.0
    issues: dict[str, Issue] = {}
    for row, entity in zip(objects.rows.shapes, objects.shape_entities, strict=True):
        k, _ = _at_force(row, force)
        through = k * (_thickness(row) + 2.0 * radius)
        if through < force and pointers[entity] not in issues:
            what = f"{through:.0f} N press a hand through it, and force_limit is {force:g} N"
            fix = "make it thicker or stiffer, give it a mesh, or lower safety.force_limit"
            issues[pointers[entity]] = scene.issue(pointers[entity], what, fix)
    return list(issues.values())
