"""Reports of each stop and hold of the haptic loop during a run: cause, time, and what to do."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from numpy.typing import NDArray

from mimics_app.app.terminal.output import say
from mimics_app.contracts.clock import TICKS_PER_SECOND
from mimics_app.contracts.loop.haptic import EventKind, SafetyState
from mimics_app.contracts.system.phrases import phrase
from mimics_app.recording.trips import Trip, TripReader
from mimics_app.rendering.haptic.histogram import LatenessReport

__all__ = ["SafetyWatch", "hold_message"]

_QUIET_TICKS = 5 * TICKS_PER_SECOND
"""Shortest time between two reported holds [ticks]: a busy machine holds again and again."""

_PAUSED = phrase("Paused: this computer is too busy. It resumes on its own")


def hold_message(state: int) -> str:
    """Return the text over the picture in a short hold, by SafetyState; "" in other states."""
    return _PAUSED if state == SafetyState.DEGRADED else ""


class SafetyWatch:
    """Keeps the newest trips of the haptic loop, and reports them.

    Args:
        report: Shows a line to the person.

    Attributes:
        stop: The newest stop that was latched, None while there was none.
        hold: The newest short hold, None while there was none.
    """

    def __init__(self, report: Callable[[str], None] = say) -> None:
        self._report = report
        self._reader = TripReader()
        self._holds = 0
        self._limited = False
        self.stop: Trip | None = None
        self.hold: Trip | None = None

    def see(self, events: NDArray[Any]) -> None:
        """Take the EVENT records of a frame, oldest first, and report what of them a person should know."""
        self._see_limit(events)
        for event in events[events["kind"] == EventKind.OSCILLATION] if len(events) else ():
            seconds = int(event["tick"]) / TICKS_PER_SECOND
            self._report(
                f"{seconds:.3f} s: the rendered force shook the hand ({float(event['force']):.1f} N) and fades; "
                "make what was touched softer or less damped"
            )
        for trip in self._reader.take(events):
            if trip.latched:
                self.stop = trip
                self._say(trip, "safety stop")
            else:
                self._note_hold(trip)

    def _see_limit(self, events: NDArray[Any]) -> None:
        """Report once that a force was cut at its limit; the report of the run counts all of them."""
        if self._limited or not len(events):
            return
        cut = events[events["kind"] == EventKind.FORCE_LIMIT]
        if not len(cut):
            return
        self._limited = True
        seconds, wanted = int(cut[0]["tick"]) / TICKS_PER_SECOND, float(cut[0]["force"])
        self._report(
            f"{seconds:.3f} s: a virtual force of {wanted:.0f} N was cut at force_limit, which a hand may feel"
        )

    def _note_hold(self, trip: Trip) -> None:
        self._holds += 1
        if self.hold is None or trip.tick - self.hold.tick > _QUIET_TICKS:
            self._say(trip, f"force paused ({self._holds}), it comes back")
        self.hold = trip

    def _say(self, trip: Trip, kind: str) -> None:
        self._report(f"{trip.seconds:.3f} s: {kind}: {trip.what}; {trip.advice}")

    def summary(self, state: int, late: LatenessReport) -> dict[str, Any]:
        """Return `safety` of a run's answer: last state, stops and holds, and cause and time of the last of them.

        A stop takes precedence over a later hold.
        """
        answer = {"state": SafetyState(state).name, "stops": late.stops, "holds": late.holds}
        last = self.stop or self.hold
        if last is None:
            return answer
        return {**answer, "cause": last.cause.name, "what": last.what, "advice": last.advice, "t_s": last.seconds}
