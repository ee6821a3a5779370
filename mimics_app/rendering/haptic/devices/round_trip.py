"""How long a device outside takes from a command to the data that shows it, measured tick by tick.

Each command carries a number, each answer says which command it has seen. The delay that counts for stability is

    device's own + worst recent round trip - one tick + half of what a command is held longer than a tick

One tick of a round trip is the loop's own, which the period in the stability limit stands for; a command that is held
for several ticks is on average half of that time old. The worst is forgotten in a quarter of a second, as the measured
period is. A command that is not answered yet counts with the time it has waited.
"""

from __future__ import annotations

from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.kernel import kernel

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


_SENT = 0  # number of the newest command, counted up without end
_SEEN = 1  # newest command that an answer has confirmed; -1: none yet
_WORST = 2  # recent round trip [ticks]
_HELD = 3  # ticks from command to command, smoothed
_LAST_SENT = 4  # tick
_RING = 5
_SLOTS = 256
TRIP_LENGTH = _RING + _SLOTS
"""What is remembered, float64."""

_FORGET = 1.0 / 250.0
_SMOOTH = 0.1

_LOW_BITS = 0xFFFF
"""Bits of a command's number that an answer repeats."""


@kernel
def reset_trips(trips: Vec) -> None:
    """Nothing was sent yet."""
    trips[_SENT] = 0.0
    trips[_SEEN] = 0.0
    trips[_WORST] = 1.0
    trips[_HELD] = 1.0


@kernel
def note_sent(trips: Vec, tick: int) -> int:
    """A command leaves at this tick; its number, from 1."""
    if trips[_SENT] > 0.0:
        trips[_HELD] += _SMOOTH * (float(tick) - trips[_LAST_SENT] - trips[_HELD])
    trips[_SENT] += 1.0
    trips[_LAST_SENT] = float(tick)
    trips[_RING + int(trips[_SENT]) % _SLOTS] = float(tick)
    return int(trips[_SENT])


@kernel
def ended_trip(trips: Vec, low_bits: int) -> int:
    """The full number of the command whose lowest 16 bits an answer gives; 0 for one that was never sent."""
    back = (int(trips[_SENT]) - low_bits) & _LOW_BITS
    return max(0, int(trips[_SENT]) - back)


@kernel
def note_answer(trips: Vec, number: int, tick: int) -> None:
    """Data came at this tick, and it knows of command `number`."""
    sent = int(trips[_SENT])
    trips[_WORST] += _FORGET * (1.0 - trips[_WORST])
    if int(trips[_SEEN]) < number <= sent:
        trips[_SEEN] = float(number)
        if sent - number < _SLOTS:
            trips[_WORST] = max(trips[_WORST], float(tick) - trips[_RING + number % _SLOTS])
    trips[_WORST] = max(trips[_WORST], float(silent_for(trips, tick)))


@kernel
def silent_for(trips: Vec, tick: int) -> int:
    """Ticks that the oldest command without an answer has waited; 0 when all are answered."""
    sent, seen = int(trips[_SENT]), int(trips[_SEEN])
    if seen >= sent:
        return 0
    oldest = max(seen + 1, sent - _SLOTS + 1)
    return tick - int(trips[_RING + oldest % _SLOTS])


@kernel
def worst_trip(trips: Vec) -> float:
    """Worst recent round trip [ticks]; 1 is none."""
    return trips[_WORST]


@kernel
def delay_of(trips: Vec, own: float, dt: float) -> float:
    """Delay for the stability limit [s]; `own` is what the device adds on its own [s]."""
    return own + dt * (max(0.0, trips[_WORST] - 1.0) + 0.5 * max(0.0, trips[_HELD] - 1.0))
