"""The cards that a task shows over the picture, one figure each."""

from __future__ import annotations

import math
from functools import lru_cache

from mimics_app.contracts.messages.board import Bar, Card, Tone
from mimics_app.contracts.system.phrases import phrase

__all__ = ["CARDS", "count_card", "force_card", "progress_card", "state_card", "time_card", "trial_card"]

CARDS = ("progress", "time", "contacts", "force", "score", "state", "trial", "margin", "gait")
"""Cards of every task; "margin" belongs to the stability monitor, "gait" to a walk in a gait orthosis."""

_WITH_BAR = 290.0
_IN_MINUTES_S = 100.0
"""Time limit from which the card shows minutes and seconds [s]."""


def progress_card(share: float, label: str = phrase("Tunnel")) -> Card:
    """Return the card of the progress, 0-1."""
    return Card(label, f"{100.0 * share:.0f} %", bar=Bar(share), width=_WITH_BAR)


def time_card(seconds: float, left_s: float | None = None, limit_s: float = 0.0) -> Card:
    """Return the card of the time [s], with the time left (None: no travel) [s]; as 4:58 under a long limit [s]."""
    in_minutes = limit_s >= _IN_MINUTES_S
    spent = _clock(int(seconds)) if in_minutes else f"{seconds:.1f} s"
    left = "" if left_s is None else _clock(math.ceil(left_s)) if in_minutes else f"{math.ceil(left_s)} s"
    return Card(phrase("Time"), spent, remark=left and phrase("{left} left", left=left), width=204.0)


def _clock(seconds: int) -> str:
    return f"{seconds // 60}:{seconds % 60:02d}"


@lru_cache(maxsize=64)
def trial_card(which: str) -> Card:
    """Return the card of the trial's caption."""
    number, _, trials = which.removeprefix("Trial ").partition(" of ")
    text = phrase("{number:d} of {trials:d}", number=int(number), trials=int(trials)) if trials else which
    return Card(phrase("Trial"), text)


@lru_cache(maxsize=64)
def count_card(label: str, number: float, width: float = 150.0) -> Card:
    """Return the card of a count."""
    return Card(label, f"{number:.0f}", width=width)


@lru_cache(maxsize=64)
def state_card(state: str) -> Card:
    """Return the card of the trial's state, named as in the scene file."""
    return Card(phrase("State"), state, width=170.0)


def force_card(newtons: float, limb: str) -> Card:
    """Return the card of the force on the person's limb [N]; the scene sets the full scale of its bar."""
    label = phrase("Force on the {limb}", limb=limb)
    return Card(label, f"{newtons:.1f} N", bar=Bar(newtons, None, Tone.LOAD), width=_WITH_BAR)
