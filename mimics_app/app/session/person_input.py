"""Input of the person at the window of a run: mouse, keyboard and gamepad."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from mimics_app.app.session.core import simulated_person
from mimics_app.app.session.mover import mover_of
from mimics_app.app.session.session import Session
from mimics_app.contracts.arrays import Vec3
from mimics_app.contracts.messages.window_input import GamepadState, InputEvent
from mimics_app.contracts.ports.input_port import Ray
from mimics_app.contracts.ports.scenario_port import Scenario
from mimics_app.inputs.interaction.plane import FrontalPlane
from mimics_app.inputs.interaction.pointer import Pointer, PointerSettings
from mimics_app.inputs.stage import Inputs
from mimics_app.maths import mat
from mimics_app.rendering.haptic.devices.robot_reach import Reach
from mimics_app.world.components.robot import Ball, Robot
from mimics_app.world.files.scene.scene import Scene

if TYPE_CHECKING:
    from mimics_app.app.picture.picture import Picture

__all__ = ["person_inputs", "pointer_plane", "ray_to_the_hand"]

_LEAST_HALF = 0.1
"""Smallest half width and half height of the plane of the cursor [m]."""


def person_inputs(session: Session) -> Inputs:
    """Return the input stage of a window; the cursor moves in the frontal plane through the robot's centre.

    Where the hand is a lever, the middle of the plane is the start of a trial.

    With a robot that runs in real time the person moves the robot, and the mouse does not; a simulated person, also
    that of an emulated robot, follows the target of the scene.
    """
    picture = session.picture
    if picture is None:
        raise RuntimeError("user input requires a window")
    ball, lever = session.scene.first(Ball), session.tasks.lever
    plane = pointer_plane(session.scene, session.scenario, lever=lever)
    settings = PointerSettings() if ball is None else PointerSettings(grasp_full=ball.grasp_force_full)

    def ray(right: float, up: float) -> Ray | None:
        return ray_to_the_hand(picture.ray(right, up), session.scenario.hand_frame())

    at_mouse = Pointer(plane, ray, settings, lever=lever)
    plugin = session.haptics.plugin
    others = plugin.real_time or mover_of(plugin) == "simulated"
    on_robot = [simulated_person(session.scene, session.scenario)] if others else []
    return Inputs([*on_robot, at_mouse], session.inputs.signals, window=_WindowAndHands(picture))


def pointer_plane(scene: Scene, scenario: Scenario, *, lever: bool) -> FrontalPlane:
    """Return the plane of the cursor, through the centre of the robot's workspace; of a lever through its middle."""
    robot = scene.first(Robot) or Robot()
    centre = _start(robot, scenario) if lever else robot.robot_to_world.translation
    half_width, half_height = _half_sizes(Reach(robot))
    return FrontalPlane(centre, half_width=half_width, half_height=half_height)


def _start(robot: Robot, scenario: Scenario) -> Vec3:
    """Return the place of the hand at the start of a trial, world [m]."""
    place = Reach(robot).points(np.array(scenario.task_context.start_joints))[0]
    x, y, z = np.array(robot.robot_to_world.rotation) @ place + np.array(robot.robot_to_world.translation)
    return float(x), float(y), float(z)


def ray_to_the_hand(ray: Ray | None, world_from_hand: NDArray[np.float64] | None) -> Ray | None:
    """Return a ray of the world in the frame in which the hand moves, see `Scenario.hand_frame`."""
    if ray is None or world_from_hand is None:
        return ray
    hand_from_world = np.zeros((4, 4))
    mat.affine_inverse(world_from_hand, hand_from_world)
    x, y, z = (hand_from_world @ (*ray[0], 1.0))[:3].tolist()
    dx, dy, dz = (hand_from_world[:3, :3] @ ray[1]).tolist()
    return (x, y, z), (dx, dy, dz)


class _WindowAndHands:
    """The window of a picture, and the controllers of its display."""

    def __init__(self, picture: Picture) -> None:
        self._picture = picture

    @property
    def gamepad(self) -> GamepadState:
        """Gamepad of the window."""
        return self._picture.surface.gamepad

    def poll(self) -> Sequence[InputEvent]:
        """Return the events of both since the last call; a controller's button has no release event."""
        names = self._picture.presenter.take_pressed()
        return [*self._picture.surface.poll(), *(InputEvent("pad", name, pressed=True) for name in names)]


def _half_sizes(reach: Reach) -> tuple[float, float]:
    """Return the reach of the robot sideways and up from the centre of its workspace [m]."""
    highest = np.array(reach.limits.highest)
    if not reach.descriptor.polar:
        centre, corner = reach.points(0.5 * (np.array(reach.limits.lowest) + highest))[0], reach.points(highest)[0]
        away = np.maximum(np.abs(corner - centre), _LEAST_HALF)
        return float(away[1]), float(away[2])
    aside = reach.points(np.array([0.0, highest[1], 0.0]))[0]
    return float(aside[1]), float(highest[2])
