"""Measures of a walk that every kind of walk has: steps, distance, symmetry, lift of the feet, speed."""

from __future__ import annotations

from mimics_app.contracts.messages.board import Bar, Card
from mimics_app.contracts.system.phrases import phrase
from mimics_app.tasks.kinds.kind import Measure, Values
from mimics_app.tasks.walking.footfalls import Footfalls
from mimics_app.tasks.walking.walker import Walker

__all__ = ["WALK_MEASURES", "symmetry_card", "walk_values"]

WALK_MEASURES = (
    Measure.totalled("steps", "steps", "Steps.", 100.0, 0.0, sums=True),
    Measure.totalled("distance_m", "distance", "Distance walked [m].", 60.0, 0.0, sums=True),
    Measure.totalled("symmetry", "symmetry", "Shorter over longer of the mean steps of both sides.", 1.0, 0.4),
    Measure.totalled("step_length_m", "step_length", "Mean step length [m].", 0.65, 0.2),
    Measure.totalled("foot_clearance_m", "foot_clearance", "Lift of the foot that lifts less [m].", 0.15, 0.05),
    Measure.totalled("walk_speed_mps", "walk_speed", "Mean walking speed [m/s].", 1.3, 0.2),
)
"""Measures of every walk."""


def walk_values(walker: Walker, seconds: float) -> Values:
    """Return the values of `WALK_MEASURES` of a walk of some time [s]."""
    falls = walker.footfalls
    return {
        "steps": float(falls.count),
        "distance_m": walker.walked,
        "symmetry": falls.symmetry,
        "step_length_m": falls.step_length,
        "foot_clearance_m": falls.clearance,
        "walk_speed_mps": walker.walked / seconds if seconds > 0.0 else None,
    }


def symmetry_card(falls: Footfalls) -> Card:
    """Return the card of the symmetry of the steps, with a bar."""
    symmetry = falls.symmetry
    text = "..." if symmetry is None else f"{100.0 * symmetry:.0f} %"
    return Card(phrase("Even steps"), text, bar=Bar(symmetry or 0.0, 1.0, right=(0.9, 1.0)), width=220.0)
