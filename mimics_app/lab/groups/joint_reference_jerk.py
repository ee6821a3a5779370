"""Curves of a joint's reference: cost of a joint in a tick against the jerk that the curve adds to the movement."""

from __future__ import annotations

from mimics_app.lab.haptic.probe import reference_us
from mimics_app.lab.haptic.reference_rivals import REFERENCE_RIVALS, cost_us, jerk_error
from mimics_app.lab.rivals import Probes, compare

__all__: list[str] = []

compare(
    __name__,
    "reference of a joint over a cycle of one second; error: the largest jerk that it adds at 1 kHz",
    "rad/s^3",
    REFERENCE_RIVALS,
    Probes(cost_us, jerk_error, reference_us),
    default="series, 11",
    why_default="its jerk is that of a movement without its higher harmonics, never a jump at a knot",
)
