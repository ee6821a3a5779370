"""Who is at the window of a run: a person with mouse, keyboard and gamepad."""

from __future__ import annotations

import numpy as np

from mimics_app.app.session.core import simulated_person
from mimics_app.app.session.session import Session
from mimics_app.inputs.interaction.plane import FrontalPlane
from mimics_app.inputs.interaction.pointer import Pointer, PointerSettings
from mimics_app.inputs.stage import Inputs
from mimics_app.world.components.robot import Ball, Robot

__all__ = ["person_inputs"]


def person_inputs(session: Session) -> Inputs:
    """The input stage of a window; the cursor moves in the frontal plane through the robot's centre.

    On a robot with a time of its own the person leads by the robot, and the mouse by nothing but its stops: one who is
    simulated, on an emulated robot, does what the screen asks for.
    """
    picture = session.picture
    if picture is None:
        raise RuntimeError("a person needs a window")
    robot, ball = session.scene.first(Robot) or Robot(), session.scene.first(Ball)
    centre = robot.robot_to_world.translation
    half_width = float(np.sin(robot.joint_max[1]) * (robot.stroke / 2 + robot.offset))
    plane = FrontalPlane(centre, half_width=half_width, half_height=robot.joint_max[2])
    settings = PointerSettings() if ball is None else PointerSettings(grasp_full=ball.grasp_force_full)
    at_mouse = Pointer(plane, picture.ray, settings)
    on_robot = [simulated_person(session.scene, session.scenario)] if session.haptics.plugin.real_time else []
    return Inputs([*on_robot, at_mouse], session.inputs.signals, window=picture.surface)
