"""Curves of a joint's reference: cost of a joint in a tick against the error of its position."""

from __future__ import annotations

from mimics_app.lab.haptic.probe import reference_us
from mimics_app.lab.haptic.reference_rivals import REFERENCE_RIVALS, cost_us, position_error
from mimics_app.lab.rivals import Probes, compare

__all__: list[str] = []

compare(
    __name__,
    "reference of a joint over a cycle of one second; error: its largest deviation from the movement",
    "rad",
    REFERENCE_RIVALS,
    Probes(cost_us, position_error, reference_us),
    default="series, 11",
    why_default="its coefficients may grow with speed and step, and its acceleration is continuous at any size",
)
