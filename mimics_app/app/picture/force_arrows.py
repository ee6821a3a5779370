"""Forces and contacts of the haptic loop as arrows in the world, for the overlay."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import F8
from mimics_app.contracts.loop.haptic import EventKind
from mimics_app.contracts.loop.loop_fields import PointSnapshot
from mimics_app.contracts.messages.stage_messages import HapticSnapshot
from mimics_app.rendering.visual.figures.hud import Colour
from mimics_app.rendering.visual.overlay.layers import Arrow

__all__ = ["SEEN_NS", "ForceArrows"]


_METRES_PER_NEWTON = 0.012
"""Length of an arrow per force [m/N]."""
_METRES_PER_SPEED = 0.15
"""Length of an impact's arrow per speed of approach [m per m/s]."""
_SHORTEST, _LONGEST = 0.004, 0.35
"""Length below which an arrow is left out, and to which a longer one is limited [m]."""
SEEN_NS = 700_000_000
"""Time for which a contact is shown, fading [ns]."""
_MAX_CONTACTS = 60
"""Largest number of contacts shown."""

_ON_HAND: Colour = (1.0, 0.45, 0.20, 1.0)
_MEASURED: Colour = (0.35, 0.70, 1.0, 1.0)
_GRIP: Colour = (0.80, 0.50, 1.0, 1.0)
_CONTACT: Colour = (1.0, 0.95, 0.55, 1.0)
_TOUCHING = (int(EventKind.CONTACT_BEGIN), int(EventKind.IMPACT))


class ForceArrows:
    """Arrows of the present forces and of recent contacts."""

    def __init__(self) -> None:
        self._contacts: list[tuple[int, F8, F8]] = []

    def of(self, snapshot: HapticSnapshot, events: NDArray[Any], now_ns: int) -> list[Arrow]:
        """Return the arrows of a frame: force on the user, measured and grip force at each point, fading contacts.

        Args:
            snapshot: The newest snapshot.
            events: EVENT records since the last frame, shape [n].
            now_ns: Session time [ns].
        """
        arrows = [arrow for point in snapshot.points for arrow in _arrows_at(point)]
        return arrows + self._fading(events, now_ns)

    def _fading(self, events: NDArray[Any], now_ns: int) -> list[Arrow]:
        for event in events[np.isin(events["kind"], _TOUCHING)]:
            length = max(_METRES_PER_NEWTON * event["force"], _METRES_PER_SPEED * event["speed"], 4.0 * _SHORTEST)
            normal = np.asarray(event["normal_world"], np.float64)
            vector = min(float(length), _LONGEST) * normal
            self._contacts.append((now_ns, np.asarray(event["position_world"], np.float64), vector))
        self._contacts = [each for each in self._contacts if now_ns - each[0] < SEEN_NS][-_MAX_CONTACTS:]
        red, green, blue, _ = _CONTACT
        return [
            Arrow(place, vector, (red, green, blue, 1.0 - (now_ns - since) / SEEN_NS))
            for since, place, vector in self._contacts
        ]


def _arrows_at(point: PointSnapshot) -> list[Arrow]:
    hip = np.asarray(point.hip_world, np.float64)
    forces = ((point.f_user_world, _ON_HAND), (point.f_meas_world, _MEASURED), (point.f_grip, _GRIP))
    vectors = [(vector, tint) for force, tint in forces if (vector := _scaled(force)) is not None]
    out = point.ball_radius  # from the surface of the ball: a force of 1.5 N would end inside of it
    return [Arrow(hip + out * vector / np.linalg.norm(vector), vector, tint) for vector, tint in vectors]


def _scaled(force: F8) -> F8 | None:
    """Return the arrow of a force [m]; None where it is too short to be seen, or not finite."""
    vector = _METRES_PER_NEWTON * np.asarray(force, np.float64)
    length = float(np.linalg.norm(vector))
    if not _SHORTEST < length < np.inf:
        return None
    return np.asarray(vector * min(1.0, _LONGEST / length))
