"""Round-trip time of an external device, from a command to the data that acknowledges it, measured tick by tick.

Commands are numbered, and each answer acknowledges one. The delay for the stability limit is

    device's own + worst recent round trip - one tick + half of the time that a command is held beyond one tick

One tick of the round trip is that of the loop, which the period in the stability limit covers; a command that is held
for several ticks is on average half of that time old. The worst round trip decays over 250 answers. An unanswered
command counts with its waiting time.
"""

from __future__ import annotations

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec

__all__ = [
    "TRIP_LENGTH",
    "delay_of",
    "ended_trip",
    "note_answer",
    "note_sent",
    "reset_trips",
    "silent_for",
    "worst_trip",
]


_SENT = 0  # number of the newest command, from 1, without wrap-around
_SEEN = 1  # newest acknowledged command; 0: none yet
_WORST = 2  # recent round trip [ticks]
_HELD = 3  # ticks from command to command, smoothed
_LAST_SENT = 4  # tick
_RING = 5
_SLOTS = 256
TRIP_LENGTH = _RING + _SLOTS
"""Length of the memory, float64."""

_FORGET = 1.0 / 250.0
"""Decay of the worst round trip per answer."""

_SMOOTH = 0.1
"""Smoothing factor of the hold time per command."""

_LOW_BITS = 0xFFFF
"""Mask of the bits of a command's number that an answer repeats."""


@kernel
def reset_trips(trips: Vec) -> None:
    """Initialise the memory before the first command."""
    trips[_SENT] = 0.0
    trips[_SEEN] = 0.0
    trips[_WORST] = 1.0
    trips[_HELD] = 1.0


@kernel
def note_sent(trips: Vec, tick: int) -> int:
    """Record a command sent at this tick; return its number, from 1."""
    if trips[_SENT] > 0.0:
        trips[_HELD] += _SMOOTH * (float(tick) - trips[_LAST_SENT] - trips[_HELD])
    trips[_SENT] += 1.0
    trips[_LAST_SENT] = float(tick)
    trips[_RING + int(trips[_SENT]) % _SLOTS] = float(tick)
    return int(trips[_SENT])


@kernel
def ended_trip(trips: Vec, low_bits: int) -> int:
    """Return the full number of the command with these lowest 16 bits; 0 for one that was never sent."""
    back = (int(trips[_SENT]) - low_bits) & _LOW_BITS
    return max(0, int(trips[_SENT]) - back)


@kernel
def note_answer(trips: Vec, number: int, tick: int) -> None:
    """Record data received at this tick that acknowledges command `number`."""
    sent = int(trips[_SENT])
    trips[_WORST] += _FORGET * (1.0 - trips[_WORST])
    if int(trips[_SEEN]) < number <= sent:
        trips[_SEEN] = float(number)
        if sent - number < _SLOTS:
            trips[_WORST] = max(trips[_WORST], float(tick) - trips[_RING + number % _SLOTS])
    trips[_WORST] = max(trips[_WORST], float(silent_for(trips, tick)))


@kernel
def silent_for(trips: Vec, tick: int) -> int:
    """Return the ticks that the oldest unanswered command has waited; 0 when all are answered."""
    sent, seen = int(trips[_SENT]), int(trips[_SEEN])
    if seen >= sent:
        return 0
    oldest = max(seen + 1, sent - _SLOTS + 1)
    return tick - int(trips[_RING + oldest % _SLOTS])


@kernel
def worst_trip(trips: Vec) -> float:
    """Return the worst recent round trip [ticks]; 1 is the minimum."""
    return trips[_WORST]


@kernel
def delay_of(trips: Vec, own: float, dt: float) -> float:
    """Return the delay for the stability limit [s]; `own` is the device's own delay [s]."""
    return own + dt * (max(0.0, trips[_WORST] - 1.0) + 0.5 * max(0.0, trips[_HELD] - 1.0))
