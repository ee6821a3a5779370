"""A simulated person as a pointing device; the model of the person is in the haptic device and acts on its sensor."""

from __future__ import annotations

from mimics_app.contracts.arrays import Vec3
from mimics_app.contracts.messages.stage_messages import Aim, PointerState, PointTarget
from mimics_app.contracts.ports.input_port import WindowFrame

__all__ = ["SimulatedPatient"]


class SimulatedPatient:
    """Passes the target of the scene to the simulated person in the device, which decides on the movement.

    Args:
        intent: False: the person holds the handle passively.
        follows_path: The device was given a path to follow, or its person walks; else the person acts only while there
            is a target.
    """

    def __init__(self, *, intent: bool = True, follows_path: bool = True) -> None:
        self._intent = intent
        self._follows_path = follows_path
        self._point: Vec3 = (0.0, 0.0, 0.0)
        self._aim: Aim | None = None

    def read(self, window: WindowFrame, now_ns: int) -> PointerState:
        """Return the target; active while the person has an intent and a path or target.

        The grasp is 1 where the hand is to close, 2 with all its strength, else 0: the force comes from the device's
        own profile.
        """
        aim = self._aim
        active = self._intent and (self._follows_path or aim is not None)
        if aim is None:
            return PointerState(self._point, 0.0, active)
        further = tuple(PointTarget(each.target_world, _grasp(each)) for each in aim.further)
        return PointerState(aim.target_world, _grasp(aim), active, further)

    def hold_at(self, point_world: Vec3) -> None:
        """Keep the point as the target while there is no other."""
        self._point = point_world

    def aim(self, aim: Aim | None) -> None:
        """Take the target of the scene; it counts from the next frame on."""
        self._aim = aim


def _grasp(aim: Aim) -> float:
    return 1.0 + aim.strain if aim.close else 0.0
