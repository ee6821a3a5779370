"""A simulated person as a source of input. The person itself lives in the haptic device and acts through its sensor."""

from __future__ import annotations

from mimics_app.contracts.input_port import Vec3, WindowFrame
from mimics_app.contracts.messages import PointerState

__all__ = ["SimulatedPatient"]


class SimulatedPatient:
    """Says only that somebody is there; where they push is decided in the device, tick by tick.

    Args:
        intent: False: the person takes the handle but wants nothing.
    """

    def __init__(self, *, intent: bool = True) -> None:
        self._intent = intent
        self._point: Vec3 = (0.0, 0.0, 0.0)

    def read(self, window: WindowFrame, now_ns: int) -> PointerState:
        """Active whenever the person has an intent; the grasp force comes from the device's own profile."""
        return PointerState(self._point, 0.0, self._intent)

    def hold_at(self, point_world: Vec3) -> None:
        """Keep the point, so that a recorded pointer never names a place nobody was at."""
        self._point = point_world
