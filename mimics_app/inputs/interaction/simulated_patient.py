"""A simulated person as a source of input. The person itself lives in the haptic device and acts through its sensor."""

from __future__ import annotations

from mimics_app.contracts.arrays import Vec3
from mimics_app.contracts.input_port import WindowFrame
from mimics_app.contracts.messages import Aim, PointerState

__all__ = ["SimulatedPatient"]


class SimulatedPatient:
    """Says that somebody is there, and what they see there is to do; how they do it is decided in the device.

    Args:
        intent: False: the person takes the handle but wants nothing.
        follows_path: The device was given a path to follow; else the person acts only while there is something to do.
    """

    def __init__(self, *, intent: bool = True, follows_path: bool = True) -> None:
        self._intent = intent
        self._follows_path = follows_path
        self._point: Vec3 = (0.0, 0.0, 0.0)
        self._aim: Aim | None = None

    def read(self, window: WindowFrame, now_ns: int) -> PointerState:
        """Active whenever the person has an intent and something to do.

        The grasp is 1 where the hand is to close, else 0: the force comes from the device's own profile.
        """
        aim = self._aim
        active = self._intent and (self._follows_path or aim is not None)
        if aim is None:
            return PointerState(self._point, 0.0, active)
        return PointerState(aim.target_world, 1.0 if aim.close else 0.0, active)

    def hold_at(self, point_world: Vec3) -> None:
        """Keep the point, so that a recorded pointer never names a place nobody was at."""
        self._point = point_world

    def aim(self, aim: Aim | None) -> None:
        """Take what the scene requests; it is seen from the next frame on."""
        self._aim = aim
