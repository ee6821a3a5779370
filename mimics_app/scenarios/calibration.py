"""Calibration of a person: the light that the hand follows, the letter that is read."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.errors import SceneError
from mimics_app.contracts.messages.orders import Shown
from mimics_app.contracts.messages.stage_messages import Aim, HapticSnapshot, TaskOrders
from mimics_app.maths.quat import about_axis
from mimics_app.scenarios.parts.robot_scene import triple
from mimics_app.scenarios.parts.touch_scene import TouchScene
from mimics_app.tasks.kinds.calibration.kind import LETTER, LIGHT, WISH
from mimics_app.tasks.kinds.calibration.spec import CalibrationSpec
from mimics_app.tasks.scene_section import section_of
from mimics_app.world.components.visible import CameraComponent
from mimics_app.world.content.world import World
from mimics_app.world.files.scene.placing import pose_of
from mimics_app.world.files.scene.scene import Scene

__all__ = ["SCENARIO", "Calibration"]

_TURNS = {"right": 0.0, "up": 0.5 * math.pi, "left": math.pi, "down": -0.5 * math.pi}
"""Rotation of the letter about the line of sight by where it is open [rad]."""
_CANVAS = 720.0
"""Height of the picture in which letters are measured [px]."""


class Calibration(TouchScene):
    """Light and letter of a calibration.

    Args:
        scene: The checked scene; needs a robot and a task with `calibration`.
        world: The world built from it.

    Raises:
        SceneError: the task has no calibration, or its person no eye.
    """

    def __init__(self, scene: Scene, world: World) -> None:
        super().__init__(scene, world)
        spec = section_of(scene, CalibrationSpec)
        self._rest = pose_of(scene, spec.rest)[0]
        self._light, self._letter = world.find(spec.light), world.find(spec.letter)
        self._metres_per_px = _metres_per_px(scene, spec)
        self._now = Shown((LIGHT, LETTER, WISH))

    @property
    def via_points_world(self) -> NDArray[np.float64]:
        return np.array([self._start])  # the simulated person goes where the task leads, and along no path

    def apply(self, orders: TaskOrders, snapshot: HapticSnapshot) -> None:
        super().apply(orders, snapshot)
        self._now.follow(orders.visual)
        light, (direction, height) = self._now[LIGHT], self._now[LETTER]
        self._light.visible, self._letter.visible = bool(light), height > 0.0
        if light:
            self._light.set_position(self._rest + np.array(light))
        if height > 0.0:
            self._letter.set_scale((height * self._metres_per_px,) * 3)
            self._letter.set_orientation(about_axis((0.0, 0.0, 1.0), _TURNS[direction]))

    def aim(self, snapshot: HapticSnapshot) -> Aim:
        """Return where the hand of a simulated person goes."""
        wish = self._now[WISH]
        target = self._rest + np.array(wish[:3])
        return Aim(triple(target), close=wish.squeezes, strain=1.0 if wish.squeezes else 0.0)


def _metres_per_px(scene: Scene, spec: CalibrationSpec) -> float:
    """Return the height of one px of the canvas at the letter [m], along the view of the ears' camera."""
    camera = scene.by_id[spec.ears].components.get("camera")
    if not isinstance(camera, CameraComponent):
        what = f'"{spec.ears}" has no camera'
        raise SceneError(scene.issue("/task/calibration/ears", what, "name the entity of the person's eye"))
    between = np.linalg.norm(pose_of(scene, spec.letter)[0] - pose_of(scene, spec.ears)[0])
    return float(2.0 * between * math.tan(0.5 * camera.vertical_fov) / _CANVAS)


SCENARIO = Calibration
