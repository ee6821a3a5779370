"""Rhythm of the heart: interval and phase of the beats, and how regular they are.

On a clear signal the last beat is the reference of the next one. Where the rhythm is trusted it is an oscillator, as
the heart's pacemaker is one that noise does not reset: beats near an expected one shift it a little, others do not.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from mimics_app.compiled.kernel import kernel

if TYPE_CHECKING:
    from mimics_app.dsp.record_types import RhythmRecord

__all__ = ["RHYTHM", "T_WAVE", "USUAL_RR", "add_beat", "off_beat", "steadiness"]

RHYTHM = np.dtype(
    [
        ("last", "f8"),  # sample of the last beat; -1: none yet
        ("rr", "f8"),  # mean interval [samples]; 0: unknown
        ("phase", "f8"),  # sample of the oscillator's last beat
        ("unsteady", "f8"),  # mean relative deviation of the intervals
    ],
    align=True,
)
"""State of the rhythm, which a detector's state contains."""

T_WAVE = 0.36
"""A peak within this time of a beat [s] is its T wave, not a missed beat (Pan & Tompkins)."""

USUAL_RR = 0.8
"""Expected interval while none is known [s]."""

_LONGEST_RR = 1.2
"""Upper limit of the first interval [s]."""

_FASTEST_RR, _MISSED_RR = 0.25, 1.7
"""Range of plausible intervals: from this time [s] to this multiple of the mean; beyond, a beat is false or missed."""

_DOUBTFUL_SHARE, _DOUBTFUL_RR = 0.05, 2.0
"""Weight of an implausible interval in the mean, and upper limit of its length [s]."""

_FOLLOW = 0.1
"""Weight of a new interval in the mean relative deviation."""
_MOST_UNSTEADY = 0.5
"""Upper limit of the relative deviation of one interval."""


class _Tuning(NamedTuple):
    """Parameters of the rhythm: from a random search, see `ecg`."""

    weight: float = 0.078  # of a new interval in the mean one
    trusted: float = 0.1  # weight of the rhythm from which its phase runs on between beats
    near: float = 0.25  # largest offset from the expected beat at which a beat is in rhythm
    pull: float = 0.7  # share of that offset by which the phase is corrected
    doubt: float = 0.01  # weight of a beat out of rhythm in the mean relative deviation


_TUNING = _Tuning()


@kernel
def off_beat(t: float, share: float, state: RhythmRecord) -> float:
    """Return the offset of a sample from the nearest expected beat, as a share of the mean interval.

    `share` is the time since the last beat as a share of the expected interval; it decides while no interval is known.
    """
    if state.rr == 0.0:
        return share - 1.0
    since = (t - state.phase) / state.rr
    return since - max(np.floor(since + 0.5), 1.0)


@kernel
def steadiness(state: RhythmRecord, limit: float) -> float:
    """Return how regular the intervals are, from 0 at a mean relative deviation of `limit` and more to 1."""
    return max(1.0 - state.unsteady / limit, 0.0)


@kernel
def add_beat(t: int, state: RhythmRecord, trust: float, rate: float) -> None:
    """Update the rhythm by a beat at sample `t`; from a `trust` of `_TUNING.trusted` on the oscillator runs on."""
    if state.rr > 0.0 and trust > _TUNING.trusted:
        _entrain(t, state)
    else:
        state.phase = t
        if state.last >= 0.0:
            _measure(t - state.last, state, rate)
    state.last = t


@kernel
def _measure(rr: float, state: RhythmRecord, rate: float) -> None:
    """Update the mean interval and its deviation by an interval [samples]."""
    if state.rr == 0.0:
        state.rr = min(rr, _LONGEST_RR * rate)
        return
    state.unsteady += _FOLLOW * (min(abs(rr / state.rr - 1.0), _MOST_UNSTEADY) - state.unsteady)
    if _FASTEST_RR * rate < rr < _MISSED_RR * state.rr:
        state.rr += _TUNING.weight * (rr - state.rr)
    else:
        state.rr += _DOUBTFUL_SHARE * (min(rr, _DOUBTFUL_RR * rate) - state.rr)


@kernel
def _entrain(t: int, state: RhythmRecord) -> None:
    """Adjust the oscillator to a beat near an expected one; any other beat only counts as irregular."""
    off = off_beat(t, 1.0, state)
    if abs(off) < _TUNING.near:
        near = max(np.floor((t - state.phase) / state.rr + 0.5), 1.0)
        state.phase = t - (1.0 - _TUNING.pull) * off * state.rr
        state.rr *= 1.0 + _TUNING.weight * off / near
        state.unsteady += _FOLLOW * (min(abs(off), _MOST_UNSTEADY) - state.unsteady)
        return
    state.unsteady += _TUNING.doubt * (_MOST_UNSTEADY - state.unsteady)
