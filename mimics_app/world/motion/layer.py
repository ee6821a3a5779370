"""A layer of an animation: a clip at a time, laid over what is below it."""

from __future__ import annotations

import math

import numpy as np

from mimics_app.contracts.arrays import F8, I4
from mimics_app.world.motion.clip import Clip, ClipEvent
from mimics_app.world.motion.kernels.sample import blend_pose, sample_clip
from mimics_app.world.motion.pose import Pose

__all__ = ["WIDEST", "Layer"]


WIDEST = 256
"""Numbers of one key at most: morph targets of a mesh."""


class Layer:
    """One clip that plays.

    Args:
        clip: Its targets are slots of `rest`.
        rest: The model at rest, which an additive clip's slots are compared to where its first frame says nothing.
        morph_first: First morph weight of each slot, int32 [slots + 1].
        speed: Seconds of the clip in a second; negative: backwards.
        loop: Begins again at its end; False holds its last frame.
        weight: 0 to 1.
        mask: Share of the weight for each slot, [slots]; None: all of it everywhere.
        additive: What the clip differs from its own first frame is added to what is below.

    Attributes:
        at: Time in the clip [s].
        weight: 0 to 1; change it as you like, or have it go somewhere by `fade`.
        speed: See above; likewise.
    """

    def __init__(
        self,
        clip: Clip,
        rest: Pose,
        morph_first: I4,
        *,
        speed: float = 1.0,
        loop: bool = True,
        weight: float = 1.0,
        mask: F8 | None = None,
        additive: bool = False,
    ) -> None:
        self.clip = clip
        self.speed, self.loop, self.weight, self.additive = speed, loop, weight, additive
        self.mask: F8 = np.ones(len(rest.translations)) if mask is None else mask
        self.at = 0.0
        self._goal, self._rate = weight, 0.0
        self._left = math.inf
        self._way = (0.0, 0.0)
        self._morph_first = morph_first
        self._cursors = np.zeros(len(clip.tracks), np.int32)
        self._touched = np.zeros((len(rest.translations), 4), np.uint8)
        self._scratch = np.zeros(WIDEST)
        self._sampled = rest.copy()
        self._reference = rest.copy()
        self.sample(0.0, self._reference)

    @property
    def ended(self) -> bool:
        """Whether a clip that does not loop has come to its end."""
        return not self.loop and not 0.0 < self.at < self.clip.duration and (self.at > 0.0 or self.speed < 0.0)

    @property
    def gone(self) -> bool:
        """Whether it was faded out and has nothing to say any more."""
        return (self._goal <= 0.0 and self.weight <= 0.0) or self._left <= 0.0

    def fade(self, weight: float, seconds: float) -> None:
        """Let the weight go to another within a time [s]."""
        self._goal = weight
        self._rate = abs(weight - self.weight) / seconds if seconds > 0.0 else math.inf

    def retire(self, seconds: float) -> None:
        """Leave when another layer has come up over this one, in so many seconds."""
        self._left = min(self._left, seconds)

    def step(self, seconds: float) -> list[ClipEvent]:
        """Let time go by; returns the events of the clip that were passed."""
        self._left -= abs(seconds)
        change = self._goal - self.weight
        if change:
            reach = self._rate * abs(seconds)
            self.weight = self._goal if abs(change) <= reach else self.weight + math.copysign(reach, change)
        before = self.at
        self._way = (before, before)
        after, duration = before + seconds * self.speed, self.clip.duration
        if after == before:
            return []  # held where it is, be it at the very end
        self._way = (before, after)
        if self.loop and duration > 0.0:
            self.at = after % duration
        else:
            self.at = min(max(after, 0.0), duration)
        return self._passed(before, after)

    def sample(self, at: float, out: Pose) -> None:
        """Write what the clip says at a time [s] into a pose, where it says something."""
        clip = self.clip
        given = (clip.tracks, clip.times, clip.values, at, self._cursors, self._morph_first, self._scratch)
        sample_clip(*given, *out.arrays, self._touched)

    def moves(self, slot: int) -> bool:
        """Whether the clip says where a slot is."""
        return bool(self._touched[slot, 0])

    def travel(self, slot: int, scratch: Pose) -> F8:
        """How far the clip carried a slot in the last step, ends of a loop joined [m], [3].

        Args:
            slot: One that it moves.
            scratch: Is overwritten.
        """
        before, after = self._way
        duration = self.clip.duration
        turns = math.floor(after / duration) - math.floor(before / duration) if self.loop and duration > 0.0 else 0
        reached = after % duration if turns else min(max(after, 0.0), duration)
        change = self._place(slot, reached, scratch) - self._place(slot, before, scratch)
        if turns:
            change += turns * (self._place(slot, duration, scratch) - self._place(slot, 0.0, scratch))
        return change

    def _place(self, slot: int, at: float, scratch: Pose) -> F8:
        self.sample(at, scratch)
        return scratch.translations[slot].copy()

    def apply(self, pose: Pose) -> None:
        """Lay it over a pose."""
        if self.weight <= 0.0:
            return
        self.sample(self.at, self._sampled)
        how = (self.weight, self.additive, self.mask, self._touched, self._morph_first)
        blend_pose(*how, *self._sampled.arrays, *self._reference.arrays, *pose.arrays)

    def _passed(self, before: float, after: float) -> list[ClipEvent]:
        """Events in (before, after], the clip repeated where it loops; none of a clip that plays backwards."""
        duration, events = self.clip.duration, self.clip.events
        if not events or after <= before or self.weight <= 0.0:
            return []
        turns = [0.0] if not self.loop or duration <= 0.0 else np.arange(0, math.floor(after / duration) + 1) * duration
        return [event for turn in turns for event in events if before < event.at + turn <= after]
