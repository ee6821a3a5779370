"""Trips of the safety state machine in words for the user: what happened, and what to do.

A trip either latches a stop, which a person must reset, or is a short hold (DEGRADED), which ends on its own.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from numpy.typing import NDArray

from mimics_app.contracts.clock import TICKS_PER_SECOND
from mimics_app.contracts.loop.haptic import EventKind, SafetyState, TripCause
from mimics_app.contracts.system.phrases import phrase

__all__ = ["Trip", "TripReader"]

_BUSY = phrase("close other programs (mimics doctor: scheduling)")

_WORDS: Mapping[TripCause, tuple[str, str]] = {
    TripCause.NONE: (phrase("a safety stop"), phrase("look at the recording")),
    TripCause.STOP_KEY: (phrase("the stop key was pressed"), phrase("reset it when it is safe")),
    TripCause.DEVICE_BUTTON: (
        phrase("the device's stop button was pressed"),
        phrase("release it, then reset when it is safe"),
    ),
    TripCause.NOT_FINITE: (
        phrase("a number that is not finite reached the loop"),
        phrase("check the device's data and its cable"),
    ),
    TripCause.LATE_TICK: (phrase("this computer was too busy"), _BUSY),
    TripCause.MISSED_IN_ROW: (phrase("this computer was too busy: many control cycles in a row were missed"), _BUSY),
    TripCause.STALE_DEVICE: (
        phrase("the device sent nothing new for too long"),
        phrase("check its cable and its power"),
    ),
    TripCause.WORKSPACE: (phrase("the hand left the workspace"), phrase("lead it back before the reset")),
    TripCause.VELOCITY: (
        phrase("the hand was faster than velocity_limit"),
        phrase("move more slowly, or look at the device"),
    ),
    TripCause.DEVICE_FAULT: (
        phrase("the device reports a fault, is gone, or takes no command"),
        phrase("check the device and its cable"),
    ),
    TripCause.JUMP: (
        phrase("the position jumped further than a hand can move"),
        phrase("check the device's sensors and its cable"),
    ),
    TripCause.SENSOR: (
        phrase("the measured force stayed beyond measured_force_limit, or did not change at all"),
        phrase("look at the device's force sensor"),
    ),
    TripCause.NOT_FOLLOWING: (
        phrase("the device does not move as it is driven"),
        phrase("look at its position sensors and its drives"),
    ),
    TripCause.OSCILLATION: (
        phrase("the rendered force shook the hand and did not calm down"),
        phrase("make what was touched softer and less damped, or look at the device's delay"),
    ),
    TripCause.CONTROLLER: (
        phrase("the walk in the orthosis waited too long in a step"),
        phrase("see that both legs hang free and the patient stands, then reset"),
    ),
    TripCause.ENERGY: (
        phrase("a contact generated more energy than energy_limit"),
        phrase("make what was touched softer or more damped"),
    ),
}
"""What happened and what to do, by cause."""


@dataclass(frozen=True, slots=True)
class Trip:
    """One trip.

    Attributes:
        tick: Tick of the trip.
        cause: Cause of the trip.
        latched: True for a stop that a person must reset, False for a short hold.
    """

    tick: int
    cause: TripCause
    latched: bool

    @property
    def seconds(self) -> float:
        """Session time of the trip [s]."""
        return self.tick / TICKS_PER_SECOND

    @property
    def what(self) -> str:
        """What happened, in words."""
        return _WORDS[self.cause][0]

    @property
    def advice(self) -> str:
        """What to do about it, in words."""
        return _WORDS[self.cause][1]


class TripReader:
    """Finds the trips among the loop's events, which arrive in batches."""

    def __init__(self) -> None:
        self._state = int(SafetyState.OFF)

    def take(self, events: NDArray[Any]) -> list[Trip]:
        """Return the trips among EVENT records [n], oldest first; the STATE event of a trip comes before it."""
        trips: list[Trip] = []
        for event in events:
            if event["kind"] == EventKind.STATE:
                self._state = _whole(event["force"])
            elif event["kind"] == EventKind.TRIP:
                latched = self._state != SafetyState.DEGRADED
                trips.append(Trip(int(event["tick"]), _cause_of(_whole(event["force"])), latched))
        return trips


def _whole(number: float) -> int:
    """Return a number of an event as an integer; -1 for an invalid one of a damaged recording."""
    return int(number) if abs(float(number)) < 1e9 else -1


def _cause_of(number: int) -> TripCause:
    return TripCause(number) if number in set(TripCause) else TripCause.NONE
