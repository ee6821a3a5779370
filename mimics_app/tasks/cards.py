"""The cards a task lays over the picture: one figure each, in words and units a person reads."""

from __future__ import annotations

import math

from mimics_app.contracts.board import Bar, Card, Tone
from mimics_app.tasks.kinds.carry_spec import GripSpec

__all__ = ["CARDS", "count_card", "force_card", "grasp_card", "progress_card", "state_card", "time_card", "trial_card"]

CARDS = ("progress", "time", "contacts", "force", "score", "state", "trial", "margin")
"""Cards that every task has; "margin" is the stability monitor's."""

_WITH_BAR = 290.0
_THREE_DIGITS_S = 100.0
"""From here on times have three digits before the point [s]."""

_GRASP_ROOM = 1.4
"""The bar of the grip goes up to this many times what is right at most."""


def progress_card(share: float, label: str = "Tunnel") -> Card:
    """How far the trial is, 0-1."""
    return Card(label, f"{100.0 * share:.0f} %", bar=Bar(share), width=_WITH_BAR)


def time_card(seconds: float, left_s: float | None = None, limit_s: float = 0.0) -> Card:
    """Time of the trial, how much of it is left [s] (None: none runs), and its limit [s], for which there is room."""
    left = "" if left_s is None else f"{math.ceil(left_s)} s left"
    return Card("Time", f"{seconds:.1f} s", remark=left, width=204.0 if limit_s < _THREE_DIGITS_S else 232.0)


def trial_card(which: str) -> Card:
    """Practice, or which trial of how many."""
    return Card("Trial", which.removeprefix("Trial "))


def count_card(label: str, number: float, width: float = 150.0) -> Card:
    """A number of things."""
    return Card(label, f"{number:.0f}", width=width)


def state_card(state: str) -> Card:
    """The state of the trial, as the scene file calls it."""
    return Card("State", state, width=170.0)


def force_card(newtons: float) -> Card:
    """Force on the hand [N]; the scene says what fills the bar."""
    return Card("Force on the hand", f"{newtons:.1f} N", bar=Bar(newtons, None, Tone.LOAD), width=_WITH_BAR)


def grasp_card(newtons: float, grip: GripSpec) -> Card:
    """Force of the grip [N] on a bar that shows between which two forces it is right."""
    full = _GRASP_ROOM * grip.most if grip.most > 0.0 else 1.0
    right = grip.least <= newtons <= grip.most
    tone = Tone.CALM if right else Tone.ACCENT if newtons < grip.least else Tone.WARN
    return Card("Grip", f"{newtons:.1f} N", bar=Bar(newtons, full, tone, (grip.least, grip.most)), width=250.0)
