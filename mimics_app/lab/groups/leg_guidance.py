"""Guidance of a leg in the gait orthosis: cost against how far a passive leg stays from its reference."""

from __future__ import annotations

from mimics_app.lab.haptic.guidance_rivals import GUIDANCE_RIVALS, away, cost_us
from mimics_app.lab.haptic.probe import reference_us
from mimics_app.lab.rivals import Probes, compare

__all__: list[str] = []

compare(
    __name__,
    "a passive leg guided along the reference walk at 1.4 km/h; error: root mean square of hip and knee from it",
    "rad",
    GUIDANCE_RIVALS,
    Probes(cost_us, away, reference_us),
    default="impedance",
)
