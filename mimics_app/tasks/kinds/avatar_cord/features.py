"""What the experiment with the avatar and the cord changes in its scene."""

from __future__ import annotations

from typing import Any

from mimics_app.contracts.messages.orders import Feature

__all__ = [
    "CORD_LENGTH",
    "CORD_RADIUS",
    "CORD_SHOWN",
    "DELAY",
    "DISTANCE",
    "FEATURES",
    "MIMICRY",
    "OWN_BODY",
    "PROBE",
    "TAP",
    "THREAT",
    "VIEWPOINT",
    "ShownTap",
]

ShownTap = tuple[int, str, float, float, int]
"""Time of the touch [ns], "cord", "back" or "stomach", share of the cord's length, angle around it [rad], number."""


CORD_SHOWN = Feature("cord.shown", True)
CORD_LENGTH = Feature("cord.length_factor", 1.0)
"""Of its slack, over the scene's own."""
CORD_RADIUS = Feature("cord.radius_factor", 1.0)
"""Over the scene's own."""
DISTANCE = Feature("avatar.distance", 1.2)
"""Of the avatar before the subject [m]."""
MIMICRY = Feature("avatar.mimicry", "same")
"""Whether the avatar moves like the subject: "same", "mirror" or "none"."""
DELAY = Feature("avatar.delay_ms", 0.0)
"""How much later it does [ms]."""
VIEWPOINT = Feature("viewpoint", "first")
"""First or third person."""
OWN_BODY = Feature("own_body", True)
"""Whether the own body is shown in the first."""
TAP: Feature[ShownTap | None] = Feature("tap", None)
"""The next tap."""
THREAT: Feature[int | None] = Feature("threat_ns", None)
"""When the threat falls, on the session's clock [ns]."""
PROBE: Feature[float | None] = Feature("probe_m", None)
"""Place of the probe that asks where the hand is [m]."""

FEATURES: tuple[Feature[Any], ...] = (
    CORD_SHOWN, CORD_LENGTH, CORD_RADIUS, DISTANCE, MIMICRY, DELAY,
    VIEWPOINT, OWN_BODY, TAP, THREAT, PROBE,
)  # fmt: skip
"""All of them."""
