"""Layer: one playing clip, blended over the layers below."""

from __future__ import annotations

import math

import numpy as np

from mimics_app.contracts.arrays import F8, I4
from mimics_app.world.content.motion.clip import Clip, ClipEvent
from mimics_app.world.content.motion.kernels.sample import ClipKeys, blend_pose, sample_clip
from mimics_app.world.content.motion.pose import Pose

__all__ = ["Layer"]


_MOST_COMPONENTS = 256
"""Maximum number of components of a key: the morph targets of a mesh."""

_MAX_REPEATS = 1000
"""Repeats of a loop in one step whose events are returned: a file may have clips of a femtosecond."""


class Layer:
    """One playing clip.

    Args:
        clip: The clip, whose targets are slots of `rest`.
        rest: Rest pose, the reference of an additive clip for slots without a key in its first frame.
        morph_first: First morph weight of each slot, int32 [slots + 1].
        speed: Seconds of the clip per second; negative: backwards.
        loop: Repeats from its start; False holds its last frame.
        weight: Blend weight, 0 to 1.
        mask: Factor on the weight for each slot, [slots]; None: 1 everywhere.
        additive: The clip's difference from its own first frame is added to the layers below.

    Attributes:
        at: Time in the clip [s].
        weight: Blend weight, 0 to 1; may be set, or changed gradually by `fade`.
        speed: See above; may be set.
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
        self._keys = ClipKeys(clip.tracks, clip.times, clip.values)
        self._cursors = np.zeros(len(clip.tracks), np.int32)
        self._touched = np.zeros((len(rest.translations), 4), np.uint8)
        self._scratch = np.zeros(_MOST_COMPONENTS)
        self._sampled = rest.copy()
        self._reference = rest.copy()
        self.sample(0.0, self._reference)

    @property
    def ended(self) -> bool:
        """True when a clip that does not loop has reached its end."""
        return not self.loop and not 0.0 < self.at < self.clip.duration and (self.at > 0.0 or self.speed < 0.0)

    @property
    def gone(self) -> bool:
        """True when it is faded out or retired and can be removed."""
        return (self._goal <= 0.0 and self.weight <= 0.0) or self._left <= 0.0

    def fade(self, weight: float, seconds: float) -> None:
        """Change the weight linearly to another within a time [s]."""
        self._goal = weight
        self._rate = abs(weight - self.weight) / seconds if seconds > 0.0 else math.inf

    def retire(self, seconds: float) -> None:
        """End the layer after a time [s], when another has covered it."""
        self._left = min(self._left, seconds)

    def step(self, seconds: float) -> list[ClipEvent]:
        """Advance the time and return the events passed."""
        self._left -= abs(seconds)
        change = self._goal - self.weight
        if change:
            reach = self._rate * abs(seconds)
            self.weight = self._goal if abs(change) <= reach else self.weight + math.copysign(reach, change)
        before = self.at
        self._way = (before, before)
        after, duration = before + seconds * self.speed, self.clip.duration
        if after == before:
            return []  # paused, possibly at the very end
        self._way = (before, after)
        if self.loop and duration > 0.0:
            self.at = after % duration
        else:
            self.at = min(max(after, 0.0), duration)
        return self._passed(before, after)

    def sample(self, at: float, out: Pose) -> None:
        """Write the clip's pose at a time [s] into the slots it animates."""
        sample_clip(self._keys, at, self._cursors, self._morph_first, self._scratch, out, self._touched)

    def moves(self, slot: int) -> bool:
        """True when the clip animates the translation of a slot."""
        return bool(self._touched[slot, 0])

    def travel(self, slot: int, scratch: Pose) -> F8:
        """Return the displacement of a slot in the last step, continuous over loops [m], [3].

        Args:
            slot: A slot that it animates.
            scratch: Work space, overwritten.
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
        """Blend the layer over a pose."""
        if self.weight <= 0.0:
            return
        self.sample(self.at, self._sampled)
        how = (self.weight, self.additive, self.mask, self._touched, self._morph_first)
        blend_pose(*how, self._sampled, self._reference, pose)

    def _passed(self, before: float, after: float) -> list[ClipEvent]:
        """Return events in (before, after], over repeats of a loop; none for a clip that plays backwards."""
        duration, events = self.clip.duration, self.clip.events
        if not events or after <= before or self.weight <= 0.0:
            return []
        repeats = min(math.floor(after / duration), _MAX_REPEATS) if self.loop and duration > 0.0 else 0
        starts = [k * duration for k in range(repeats + 1)]
        return [event for start in starts for event in events if before < event.at + start <= after]
