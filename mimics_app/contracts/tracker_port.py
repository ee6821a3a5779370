"""What a tracker is: poses with the time they arrived at, one sensor after another.

Positions and rotations are the device's own until the hub has brought them into the room: metres, +y up.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

__all__ = ["STALE_NS", "TrackedPose", "TrackerSample", "TrackerSink", "TrackerSource"]

STALE_NS = 100_000_000
"""A sensor that has reported nothing for so long [ns] is stale."""


@dataclass(frozen=True, slots=True)
class TrackerSample:
    """One report of one sensor.

    Attributes:
        sensor: Its name, e.g. "1" or "person/wrist_left".
        t_ns: When it arrived, on the session's clock [ns].
        position: x, y, z [m].
        rotation: Unit quaternion x, y, z, w.
        device_ns: When it was measured, on the device's clock [ns]; None where it does not say.
    """

    sensor: str
    t_ns: int
    position: tuple[float, float, float]
    rotation: tuple[float, float, float, float]
    device_ns: int | None = None


@dataclass(frozen=True, slots=True, eq=False)
class TrackedPose:
    """Where a sensor is at a time.

    Attributes:
        pose: float64 [4, 4], rigid.
        age_ns: From its newest report to the time requested [ns]; negative where it lies between two.
        stale: True where nothing has been heard of it for `STALE_NS`: the pose is its last one.
        capped: True where it would have had to be predicted farther than is allowed.
    """

    pose: NDArray[np.float64]
    age_ns: int
    stale: bool
    capped: bool


TrackerSink = Callable[[TrackerSample], None]
"""Takes each sample; called in the source's own thread."""


class TrackerSource(Protocol):
    """One device. It has a thread of its own, or none where it is asked (`poll`).

    Attributes:
        name: As the scene calls it.
        problem: What is wrong with it now, "" while all is well.
        rejected: Reports that were not whole or not possible.
    """

    name: str
    problem: str
    rejected: int

    def start(self, sink: TrackerSink) -> None:
        """Begin to report.

        Raises:
            DeviceError: it cannot be had.
        """
        ...

    def poll(self, now_ns: int) -> None:
        """Once a frame, for sources without a thread."""
        ...

    def stop(self) -> None:
        """End, and free the device."""
        ...
