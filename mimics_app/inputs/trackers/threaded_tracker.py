"""Base class of trackers with a connection of their own: reading thread, plausibility check, orderly end."""

from __future__ import annotations

import math
import threading
from abc import abstractmethod
from collections.abc import Sequence

from mimics_app.contracts.clock import Clock, MonotonicClock
from mimics_app.contracts.ports.plugins import raised
from mimics_app.contracts.ports.tracker_port import TrackerSample, TrackerSink, TrackerSource
from mimics_app.inputs.trackers.plausibility import BelievedSensors

__all__ = ["POSE_NUMBERS", "ThreadedTracker"]

POSE_NUMBERS = 7
"""x, y, z [m], and a quaternion x, y, z, w."""

_SHORTEST, _LONGEST = 0.9, 1.1
"""Range of a received unit quaternion's length."""
_PATIENCE_S = 0.8
"""Time that `stop` waits for the thread [s]; one that hangs in a driver is left behind, and ends with the process."""


class ThreadedTracker(TrackerSource):
    """A tracker that is opened, read by a thread until it is stopped, and closed.

    Args:
        name: Name in the scene.
        clock: The session's clock.
    """

    def __init__(self, name: str, clock: Clock | None = None) -> None:
        self.name, self.problem, self.rejected = name, "", 0
        self._clock = clock or MonotonicClock()
        self._believed = BelievedSensors()
        self._stopping = threading.Event()
        self._thread: threading.Thread | None = None

    @abstractmethod
    def _open(self) -> None:
        """Open the connection.

        Raises:
            DeviceError: It is not available.
        """

    @abstractmethod
    def _read(self, sink: TrackerSink) -> None:
        """Deliver reports until `_stopping` is set or the connection is lost; the latter sets `problem`."""

    @abstractmethod
    def _close(self) -> None:
        """Close the connection, after the thread has ended."""

    def start(self, sink: TrackerSink) -> None:
        self._open()
        self._thread = threading.Thread(target=self._run, args=(sink,), name=f"tracker {self.name}", daemon=True)
        self._thread.start()

    def _run(self, sink: TrackerSink) -> None:
        """Read until the end; an error that ends the thread is the tracker's problem."""
        try:
            self._read(sink)
        except Exception as error:  # noqa: BLE001  of a library: an ended thread must not pass for a person at rest
            self.problem = f"it is lost: it {raised(error)}"

    def poll(self, now_ns: int) -> None:
        """Do nothing: the thread reads."""

    def stop(self) -> None:
        self._stopping.set()
        if self._thread is None:
            return
        self._thread.join(_PATIENCE_S)
        if self._thread.is_alive():
            self.problem = "it does not answer, and is left behind"
            return
        self._close()

    def _deliver(self, sample: TrackerSample, sink: TrackerSink) -> None:
        """Pass a plausible report to the sink; count any other."""
        if self._believed.admits(sample):
            sink(sample)
        else:
            self.rejected += 1

    def _deliver_pose(
        self, sensor: str, pose: Sequence[float], t_ns: int, sink: TrackerSink, device_ns: int | None = None
    ) -> None:
        """Deliver a pose of `POSE_NUMBERS` numbers with its quaternion normalised; count one that is none."""
        x, y, z, qx, qy, qz, qw = pose
        length = math.sqrt(qx * qx + qy * qy + qz * qz + qw * qw)
        if not _SHORTEST < length < _LONGEST:
            self.rejected += 1
            return
        rotation = (qx / length, qy / length, qz / length, qw / length)
        self._deliver(TrackerSample(sensor, t_ns, (x, y, z), rotation, device_ns), sink)
