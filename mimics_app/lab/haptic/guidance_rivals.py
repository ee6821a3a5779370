"""Rivals of a leg's guidance: impedance around the reference, and path control with a moving window."""

from __future__ import annotations

from mimics_app.lab.haptic.led_leg import Leg
from mimics_app.lab.rivals import Rival

__all__ = ["GUIDANCE_RIVALS", "away", "cost_us", "pull_on_late_leg"]

_WIDTH = 0.05
"""Free width of a window [rad]."""


def _leg(window: float) -> Leg:
    return Leg(servo=False, guidance={"window": window, "width": _WIDTH})


def cost_us(window: float) -> float:
    """Return the cost of the guidance of one leg in a tick [us], for a window [s]; 0: impedance."""
    return _leg(window).cost_us()


def away(window: float) -> float:
    """Return the root mean square deviation of a passive leg from the reference [rad]."""
    return _leg(window).lead().away


def pull_on_late_leg(window: float) -> float:
    """Return the root mean square torque on a person who walks the path, but late by a twentieth of the cycle [N m]."""
    return _leg(window).lead(late=True).torque


GUIDANCE_RIVALS = (
    Rival(
        "impedance",
        "a spring and a damper around the reference at its time",
        "persons who are to keep step",
        {"guidance_window": 0.0},
        (0.0,),
    ),
    *(
        Rival(
            f"window of {round(1e3 * window)} ms",
            "a spring to the nearest place of the path within the window, none within 0.05 rad",
            "persons who walk by themselves, at their own time",
            {"guidance_window": window},
            (window,),
        )
        for window in (0.05, 0.15)
    ),
)
"""The impedance, and windows of two lengths."""
