"""Measures of a walk that every kind of walk has, and its section in a report: steps, symmetry, lift, speed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from mimics_app.contracts.messages.board import Bar, Card
from mimics_app.contracts.messages.report_section import ReportedAttempt, ReportSection
from mimics_app.contracts.system.phrases import phrase
from mimics_app.tasks.kinds.kind import Measure, Values
from mimics_app.tasks.walking.footfalls import Footfalls
from mimics_app.tasks.walking.walker import Walker

__all__ = ["WALK_MEASURES", "WalkSection", "speed_card", "symmetry_card", "walk_values"]

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


def speed_card(speed: float, fastest: float, *, led: bool) -> Card:
    """Return the card of the speed [m/s], with a bar up to the fastest; it says how to stop, who is led by Space."""
    caption = phrase("Speed (Space: stop)") if led else phrase("Speed (down: stop)")
    return Card(caption, f"{speed:.1f} m/s", bar=Bar(speed, fastest), width=260.0)


def symmetry_card(falls: Footfalls) -> Card:
    """Return the card of the symmetry of the steps, with a bar."""
    symmetry = falls.symmetry
    text = "..." if symmetry is None else f"{100.0 * symmetry:.0f} %"
    return Card(phrase("Even steps"), text, bar=Bar(symmetry or 0.0, 1.0, right=(0.9, 1.0)), width=220.0)


_OF_EVERY_WALK = {
    phrase("steps"): ("steps", ""),
    phrase("walked"): ("distance_m", "m"),
    phrase("walking speed"): ("walk_speed_mps", "m/s"),
    phrase("symmetry of the steps"): ("symmetry", ""),
    phrase("step length"): ("step_length_m", "m"),
    phrase("lift of the foot that lifts less"): ("foot_clearance_m", "m"),
}
"""Figures of every walk by caption: name among the totals, unit."""


class WalkSection(ReportSection):
    """Section of runs with trials of a kind of walk: the kind's own figures, and those of every walk.

    Args:
        column: Column of the trial table by which a run of the kind is known.
        own: Captions of the kind's own figures, with their names among the totals.
    """

    def __init__(self, column: str, own: Mapping[str, str]) -> None:
        self._column = column
        self._figures = {**{caption: (name, "") for caption, name in own.items()}, **_OF_EVERY_WALK}

    def takes(self, facts: Mapping[str, Any], attempts: Sequence[ReportedAttempt]) -> bool:
        return any(self._column in attempt.row for attempt in attempts)

    def tiles(self, task: Mapping[str, Any]) -> Mapping[str, tuple[Any, str]]:
        return {caption: (task.get(name), unit) for caption, (name, unit) in self._figures.items()}
