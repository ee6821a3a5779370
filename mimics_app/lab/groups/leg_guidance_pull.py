"""Guidance of a leg in the gait orthosis: cost against how it pulls at a person who walks the path, but late."""

from __future__ import annotations

from mimics_app.lab.haptic.guidance_rivals import GUIDANCE_RIVALS, cost_us, pull_on_late_leg
from mimics_app.lab.haptic.probe import reference_us
from mimics_app.lab.rivals import Probes, compare

__all__: list[str] = []

compare(
    __name__,
    "a leg that walks the reference, late by a twentieth of the cycle; error: root mean square torque of the guidance",
    "N m",
    GUIDANCE_RIVALS,
    Probes(cost_us, pull_on_late_leg, reference_us),
    default="impedance",
    why_default="whoever cannot walk by themselves is to be led in time",
)
