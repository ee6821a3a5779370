"""Parameters that the PD controllers share: a gain of the error and one of the velocity, for each joint or axis."""

from __future__ import annotations

from mimics_app.contracts.loop.controller_port import ControllerParameter, places_of
from mimics_app.contracts.loop.loop_fields import MAX_JOINTS

__all__ = ["GAINS", "KD", "KP"]

GAINS = (
    ControllerParameter("kp", 4.0, 0.0, 1e4, "1/s", size=MAX_JOINTS),
    ControllerParameter("kd", 0.1, 0.0, 1e4, size=MAX_JOINTS),
)
"""Parameters of a PD controller of velocities (D2.1 4.2.5, 4.2.6), kp in 1/s; kd from 1 on is unstable with a servo."""

KP, KD = (slice(place, place + MAX_JOINTS) for place in places_of(GAINS))
"""Where they are in the vector of parameters."""
