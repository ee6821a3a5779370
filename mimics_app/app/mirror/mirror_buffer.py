"""Frames of a session as a mirror receives them: put in order, and interpolated at the time that is shown."""

from __future__ import annotations

from bisect import bisect_right, insort
from dataclasses import replace

import numpy as np
from msgspec import structs
from numpy.typing import NDArray

from mimics_app.contracts.messages.mirror_frame import MirrorFrame, SoundNote

__all__ = ["MirrorBuffer"]

_KEPT_NS = 2_000_000_000
"""Frames older than this before the newest are dropped [ns]."""


class MirrorBuffer:
    """Holds the frames of the last two seconds.

    Args:
        delay_ns: Time by which the mirror is behind the session, within which a late frame finds its place [ns].
    """

    def __init__(self, delay_ns: int) -> None:
        self._delay_ns = delay_ns
        self._frames: list[MirrorFrame] = []
        self._lead_ns: int | None = None
        self._sound = -1

    def put(self, frame: MirrorFrame, here_ns: int) -> None:
        """Take a frame that arrived at a time of this computer [ns]; one that is known already changes nothing."""
        if any(each.number == frame.number for each in self._frames):
            return
        insort(self._frames, frame, key=lambda each: each.t_ns)
        newest = self._frames[-1].t_ns
        self._frames = [each for each in self._frames if each.t_ns >= newest - _KEPT_NS]
        lead = here_ns - frame.t_ns  # the smallest is that of the fastest way; clocks that drift move it slowly
        self._lead_ns = lead if self._lead_ns is None or lead < self._lead_ns else self._lead_ns + 1000

    def at(self, here_ns: int) -> MirrorFrame | None:
        """Return the state to be shown at a time of this computer [ns]; None before the first frame.

        Poses lie between those of the frames before and after, at least the newest one: nothing is guessed ahead.
        """
        if self._lead_ns is None:
            return None
        t_ns = here_ns - self._lead_ns - self._delay_ns
        after = bisect_right(self._frames, t_ns, key=lambda each: each.t_ns)
        if after == 0 or after == len(self._frames):
            return self._frames[min(after, len(self._frames) - 1)]
        before, later = self._frames[after - 1], self._frames[after]
        return _between(before, later, (t_ns - before.t_ns) / (later.t_ns - before.t_ns))

    def take_sounds(self, shown: MirrorFrame) -> list[SoundNote]:
        """Return the sounds of a shown frame that were not returned before; those before the first frame are none."""
        if self._sound < 0:
            self._sound = shown.sounds[-1].number if shown.sounds else 0
            return []
        fresh = [each for each in shown.sounds if each.number > self._sound]
        self._sound = max([self._sound, *(each.number for each in fresh)])
        return fresh


def _between(before: MirrorFrame, later: MirrorFrame, share: float) -> MirrorFrame:
    """Return a frame between two: rows that only the later one has jump with it."""
    begun_s, ended_s = before.effects.time_s, later.effects.time_s
    effects = structs.replace(before.effects, time_s=begun_s + share * (ended_s - begun_s))
    common, mine, places = np.intersect1d(before.rows, later.rows, assume_unique=True, return_indices=True)
    if not len(common):
        return replace(before, effects=effects)
    shift, turn, scale = before.translations.copy(), before.rotations.copy(), before.scales.copy()
    shift[mine] = (1.0 - share) * shift[mine] + share * later.translations[places]
    scale[mine] = (1.0 - share) * scale[mine] + share * later.scales[places]
    turn[mine] = _turned(turn[mine], later.rotations[places], share)
    t_ns = before.t_ns + round(share * (later.t_ns - before.t_ns))
    return replace(before, t_ns=t_ns, translations=shift, rotations=turn, scales=scale, effects=effects)


def _turned(one: NDArray[np.float32], other: NDArray[np.float32], share: float) -> NDArray[np.float32]:
    """Return rotations between two by the shortest way, normalised linear: a frame turns by few degrees."""
    sign = np.where((one * other).sum(axis=1, keepdims=True) < 0.0, -1.0, 1.0)
    mixed = (1.0 - share) * one + share * sign * other
    return (mixed / np.linalg.norm(mixed, axis=1, keepdims=True)).astype(np.float32)
