"""Port of trackers: poses of sensors with their time of arrival.

Positions and rotations are in the device's frame until the hub converts them to the room: metres, +y up.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.ports.input_port import WindowFrame
from mimics_app.contracts.ports.plugins import PluginGroup, fault_of_builder

__all__ = [
    "PLUGINS",
    "STALE_NS",
    "TRACKER_KINDS",
    "TrackedPose",
    "TrackerSample",
    "TrackerSink",
    "TrackerSource",
    "tracker_names",
]

TRACKER_KINDS = ("fastrak", "flock", "vrpn", "osc", "lsl", "scripted", "pointer", "headset", "tape")
"""Built-in kinds of trackers."""

STALE_NS = 100_000_000
"""Time without a report after which a sensor is stale [ns]."""


@dataclass(frozen=True, slots=True)
class TrackerSample:
    """One report of one sensor.

    Attributes:
        sensor: Name of the sensor, e.g. "1" or "person/wrist_left".
        t_ns: Time of arrival, on the session's clock [ns].
        position: x, y, z [m].
        rotation: Unit quaternion x, y, z, w.
        device_ns: Time of measurement, on the device's clock [ns]; None if not reported.
    """

    sensor: str
    t_ns: int
    position: tuple[float, float, float]
    rotation: tuple[float, float, float, float]
    device_ns: int | None = None


@dataclass(frozen=True, slots=True, eq=False)
class TrackedPose:
    """Pose of a sensor at a requested time.

    Attributes:
        pose: Rigid pose, float64 [4, 4].
        age_ns: Requested time minus that of the newest report [ns]; negative between two reports.
        stale: True after `STALE_NS` without a report: the pose is the last one.
        capped: True if the prediction was limited to the longest one allowed.
    """

    pose: NDArray[np.float64]
    age_ns: int
    stale: bool
    capped: bool


TrackerSink = Callable[[TrackerSample], None]
"""Receiver of samples; called in the source's own thread."""


class TrackerSource(Protocol):
    """One tracking device, with a thread of its own, or polled (`poll`).

    Attributes:
        name: Name in the scene.
        problem: Present fault, "" for none.
        rejected: Reports that were incomplete or invalid.
        simulated: True for a person who exists only while no other tracker has reported: it does not continue the
            motion of a person whose tracking is lost.
    """

    name: str
    problem: str
    rejected: int
    simulated: bool = False

    def start(self, sink: TrackerSink) -> None:
        """Begin to report.

        Raises:
            DeviceError: The device is not available.
        """
        ...

    def poll(self, now_ns: int) -> None:
        """Read the device once per frame, for sources without a thread."""
        ...

    def take_window(self, frame: WindowFrame) -> None:
        """Take the window's events of a frame, for sources that follow mouse or gamepad."""
        return

    def attach_display(self, reports: Callable[[], Sequence[TrackerSample]]) -> None:
        """Take the function that returns the display's own reports of head and hands, for sources that pass them on."""
        return

    def stop(self) -> None:
        """Stop, and release the device."""
        ...


PLUGINS = PluginGroup("mimics_app.trackers", fault_of_builder(TrackerSource))
"""Trackers of installed packages."""


def tracker_names() -> list[str]:
    """Return the kinds of all trackers: built-in first, then installed plug-ins."""
    return [*TRACKER_KINDS, *(name for name in PLUGINS.names() if name not in TRACKER_KINDS)]
