"""Clips: keyframes of nodes, packed into flat arrays for a compiled pass."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import IntEnum

import numpy as np

from mimics_app.contracts.arrays import F4, F8, I4

__all__ = ["Clip", "ClipEvent", "Interpolation", "MotionTrack", "TrackPath", "clip_of_poses", "pack_clip"]


class TrackPath(IntEnum):
    """Property of its target that a track animates."""

    TRANSLATION = 0
    ROTATION = 1
    SCALE = 2
    WEIGHTS = 3


class Interpolation(IntEnum):
    """Interpolation between keys (glTF 2.0 3.11)."""

    STEP = 0
    LINEAR = 1
    CUBIC = 2


@dataclass(frozen=True, slots=True)
class ClipEvent:
    """An event at a time of a clip, such as a foot that touches the ground.

    Attributes:
        at: Time in the clip [s].
        kind: Kind of event: "step", or any trigger of a scene.
        node: Name of the node where it happens; "": the model itself.
        material: Material of the ground; "": that of the scene.
        strength: Strength, 1 by default.
    """

    at: float
    kind: str
    node: str = ""
    material: str = ""
    strength: float = 1.0


@dataclass(frozen=True, eq=False)
class MotionTrack:
    """Keys of one property of one target.

    Attributes:
        target: Index of the target: a node of the file, later a slot of a pose.
        path: Property that it animates.
        interpolation: Interpolation between keys.
        times: Increasing times [s], float32 [keys].
        values: Three parts for a cubic (tangent in, value, tangent out), else one; float32 [keys, parts, width].
    """

    target: int
    path: TrackPath
    interpolation: Interpolation
    times: F4
    values: F4


@dataclass(frozen=True, eq=False)
class Clip:
    """A clip.

    Attributes:
        name: Name, usually unique in its model.
        duration: Duration of its longest track [s].
        tracks: Rows of target, path, interpolation, first key, keys, first value, width; int32 [tracks, 7].
        times: Times of all keys [s], float32 [keys].
        values: Values of all keys, float32 [values].
        events: Events, sorted by time.
    """

    name: str
    duration: float
    tracks: I4
    times: F4
    values: F4
    events: tuple[ClipEvent, ...] = ()

    def aimed(self, slot_of: I4) -> Clip:
        """Return the clip with its targets renumbered; tracks of targets without a number (-1) are left out.

        Args:
            slot_of: New number of each target, int32 [targets].
        """
        slots = slot_of[self.tracks[:, 0]]
        tracks = self.tracks[slots >= 0].copy()
        tracks[:, 0] = slots[slots >= 0]
        return replace(self, tracks=tracks)


def pack_clip(name: str, tracks: Sequence[MotionTrack], events: tuple[ClipEvent, ...] = ()) -> Clip:
    """Pack at least one track into a clip."""
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
    """Pack a pose per frame into a clip.

    Args:
        name: Name of the clip.
        seconds: Duration of a frame [s].
        rotations: Local rotations xyzw, [frames, slots, 4].
        places: Local translations of the slot `root` [m], [frames, 3].
        moved: Slots with animated rotation.
        root: Slot with animated translation.
    """
    times = (seconds * np.arange(len(rotations))).astype(np.float32)

    def track(slot: int, path: TrackPath, values: F8) -> MotionTrack:
        return MotionTrack(slot, path, Interpolation.LINEAR, times, values.astype(np.float32)[:, None, :])

    tracks = [track(slot, TrackPath.ROTATION, rotations[:, slot]) for slot in moved]
    return pack_clip(name, [*tracks, track(root, TrackPath.TRANSLATION, places)])
