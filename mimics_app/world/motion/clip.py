"""Clips: keys over time that move nodes, all of one clip in a few flat arrays that a compiled pass reads."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import IntEnum

import numpy as np

from mimics_app.contracts.arrays import F4, F8, I4

__all__ = ["Clip", "ClipEvent", "Interpolation", "Track", "TrackPath", "clip_of_poses", "pack_clip"]


class TrackPath(IntEnum):
    """What of its target a track moves."""

    TRANSLATION = 0
    ROTATION = 1
    SCALE = 2
    WEIGHTS = 3


class Interpolation(IntEnum):
    """How a track goes from key to key (glTF 2.0 3.11)."""

    STEP = 0
    LINEAR = 1
    CUBIC = 2


@dataclass(frozen=True, slots=True)
class ClipEvent:
    """Something that happens at a time of a clip, such as a foot that touches the ground.

    Attributes:
        at: Time in the clip [s].
        kind: What: "step", or whatever a scene listens for.
        node: Name of the node where it happens; "": at the model's own.
        material: Of what is touched, where the clip knows it; "": the scene says.
        strength: 1 as usual.
    """

    at: float
    kind: str
    node: str = ""
    material: str = ""
    strength: float = 1.0


@dataclass(frozen=True, eq=False)
class Track:
    """Keys of one thing.

    Attributes:
        target: Number of what is moved: a node of the file, later a slot of a pose.
        path: What of it.
        interpolation: From key to key.
        times: Rising [s], float32 [keys].
        values: Three parts for a cubic (tangent in, value, tangent out), else one; float32 [keys, parts, width].
    """

    target: int
    path: TrackPath
    interpolation: Interpolation
    times: F4
    values: F4


@dataclass(frozen=True, eq=False)
class Clip:
    """A motion.

    Attributes:
        name: Unique in its model, or nearly.
        duration: Of its longest track [s].
        tracks: One line for each: target, path, interpolation, first key, keys, first value, width; int32 [tracks, 7].
        times: Of all keys [s], float32 [keys].
        values: Of all keys, float32 [values].
        events: By time.
    """

    name: str
    duration: float
    tracks: I4
    times: F4
    values: F4
    events: tuple[ClipEvent, ...] = ()

    def aimed(self, slot_of: I4) -> Clip:
        """The clip with its targets renumbered; tracks of targets without a number (-1) are left out.

        Args:
            slot_of: New number of each target, int32 [targets].
        """
        slots = slot_of[self.tracks[:, 0]]
        tracks = self.tracks[slots >= 0].copy()
        tracks[:, 0] = slots[slots >= 0]
        return replace(self, tracks=tracks)


def pack_clip(name: str, tracks: Sequence[Track], events: tuple[ClipEvent, ...] = ()) -> Clip:
    """A clip out of at least one track."""
    lines, key, value = [], 0, 0
    for track in tracks:
        keys, width = len(track.times), track.values.shape[2]
        lines.append((track.target, track.path, track.interpolation, key, keys, value, width))
        key, value = key + keys, value + track.values.size
    return Clip(
        name,
        float(max(track.times[-1] for track in tracks)),
        np.array(lines, np.int32).reshape(-1, 7),
        np.concatenate([track.times for track in tracks]).astype(np.float32),
        np.concatenate([track.values.ravel() for track in tracks]).astype(np.float32),
        events,
    )


def clip_of_poses(name: str, seconds: float, rotations: F8, places: F8, moved: Sequence[int], root: int) -> Clip:
    """A clip out of a pose for each frame.

    Args:
        name: Of the clip.
        seconds: Of a frame [s].
        rotations: Local, xyzw, [frames, slots, 4].
        places: Local, of the slot `root` [m], [frames, 3].
        moved: Slots that are turned.
        root: The slot that is also moved.
    """
    times = (seconds * np.arange(len(rotations))).astype(np.float32)

    def track(slot: int, path: TrackPath, values: F8) -> Track:
        return Track(slot, path, Interpolation.LINEAR, times, values.astype(np.float32)[:, None, :])

    tracks = [track(slot, TrackPath.ROTATION, rotations[:, slot]) for slot in moved]
    return pack_clip(name, [*tracks, track(root, TrackPath.TRANSLATION, places)])
