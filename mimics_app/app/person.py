"""A person at the window: mouse, keyboard and gamepad as one pointing device over the robot's workspace."""

from __future__ import annotations

import numpy as np

from mimics_app.app.session import Session
from mimics_app.inputs.interaction.plane import FrontalPlane
from mimics_app.inputs.interaction.pointer import Pointer, PointerSettings
from mimics_app.inputs.stage import Inputs
from mimics_app.world.components_haptic import Ball, Robot

__all__ = ["person_inputs"]


def person_inputs(session: Session) -> Inputs:
    """The input stage of a window; the cursor moves in the frontal plane through the robot's centre."""
    picture = session.picture
    if picture is None:
        raise RuntimeError("a person needs a window")
    robots = session.scene.components(Robot)
    robot = robots[0][1] if robots else Robot()
    balls = session.scene.components(Ball)
    centre = robot.robot_to_world.translation
    half_width = float(np.sin(robot.joint_max[1]) * (robot.stroke / 2 + robot.offset))
    plane = FrontalPlane(centre, half_width=half_width, half_height=robot.joint_max[2])
    settings = PointerSettings(grasp_full=balls[0][1].grasp_force_full if balls else PointerSettings().grasp_full)
    return Inputs([Pointer(plane, picture.ray, settings)], window=picture.surface)
