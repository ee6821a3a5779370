"""Schedule of a trial's taps, seen and felt, from the session's seed."""

from __future__ import annotations

import random
from dataclasses import dataclass

from mimics_app.contracts.clock import SECOND_NS
from mimics_app.tasks.kinds.avatar_cord.spec import ConditionSpec, TapsSpec

__all__ = ["Tap", "plan_taps", "tap_number", "tap_of_number"]

_CORD_ENDS = (0.15, 0.85)
"""Shares of the cord's length between which it is tapped."""
_TAPS_A_TRIAL = 10_000
"""More taps than a trial has: numbers of taps in a session are counted from its multiples."""
_ELSEWHERE = {"back": "stomach", "stomach": "back"}


def tap_number(trial: int, tap: int) -> int:
    """Return the number of a trial's tap in the session, by which the vibrator's journal names it."""
    return trial * _TAPS_A_TRIAL + tap


def tap_of_number(number: int) -> tuple[int, int]:
    """Return trial and tap of a number."""
    return divmod(number, _TAPS_A_TRIAL)


@dataclass(frozen=True, slots=True)
class Tap:
    """One tap.

    Attributes:
        number: Within the trial, 0 first.
        seen_ns: Time of the ball's touch from the beginning of the taps [ns].
        felt_ns: Time at which it is felt, likewise [ns].
        place: "cord", "back" or "stomach".
        felt_at: Vibrator that is driven.
        share: Share of the cord's length, where `place` is "cord".
        theta: Around it [rad].
    """

    number: int
    seen_ns: int
    felt_ns: int
    place: str
    felt_at: str
    share: float
    theta: float


def plan_taps(taps: TapsSpec, condition: ConditionSpec, seed: int, trial: int) -> list[Tap]:
    """Plan the taps of a trial; the same seed and trial give the same taps on every machine.

    Args:
        taps: Times and places.
        condition: Relation of seen and felt taps.
        seed: Seed of the session.
        trial: Number of the trial.
    """
    rng = random.Random(f"taps {seed} {trial}")
    gaps = _gaps(taps, condition, rng)
    felt_gaps = gaps[:1] + rng.sample(gaps[1:], len(gaps) - 1) if condition.mode == "shuffled" else gaps
    planned, seen, felt = [], 0.0, 0.0
    places = condition.places or taps.places
    for number, (gap, felt_gap) in enumerate(zip(gaps, felt_gaps, strict=True)):
        seen, felt = seen + gap, felt + felt_gap
        place = places[number % len(places)]
        at = taps.felt if place == "cord" else place
        if condition.mode == "other_place":
            at = _ELSEWHERE.get(at, "back")
        low, high = _CORD_ENDS
        along = low + (high - low) * (number / max(1, len(gaps) - 1))
        offset = _offset_s(condition, rng)
        times = round(seen * SECOND_NS), max(0, round((felt + offset) * SECOND_NS))
        planned.append(Tap(number, *times, place, at, along, rng.uniform(-0.9, 0.9)))
    return planned


def _gaps(taps: TapsSpec, condition: ConditionSpec, rng: random.Random) -> list[float]:
    """Return the intervals between the taps within the condition's duration [s]; the first from the beginning."""
    if condition.mode == "none":
        return []
    gaps, left = list[float](), condition.duration_s - max(0.0, abs(condition.visuo_tactile_ms) * 1e-3)
    most = max(taps.least_s, taps.most_s)
    while True:
        # What is felt before it is seen must not come before the taps' beginning.
        gap = rng.uniform(taps.least_s, most) + (max(0.0, -condition.visuo_tactile_ms) * 1e-3 if not gaps else 0.0)
        left -= gap
        if left < 0.0:
            return gaps
        gaps.append(gap)


def _offset_s(condition: ConditionSpec, rng: random.Random) -> float:
    if condition.mode == "delayed":
        return condition.visuo_tactile_ms * 1e-3
    if condition.mode == "jittered":
        return rng.uniform(-1.0, 1.0) * abs(condition.visuo_tactile_ms) * 1e-3
    return 0.0
