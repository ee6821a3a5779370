"""Poses by the lab streaming layer (extra `lsl`): a stream of seven numbers a sensor, x y z qx qy qz qw."""

from __future__ import annotations

import math
import threading
from typing import Any

from mimics_app.contracts.clock import Clock, MonotonicClock
from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.tracker_port import TrackerSample, TrackerSink, TrackerSource
from mimics_app.inputs.trackers.plausibility import Plausibility

__all__ = ["LslTracker"]

_PATIENCE_S = 5.0
_LOOK_S = 0.05
_NUMBERS = 7


class LslTracker(TrackerSource):
    """One stream; its sensors are called "1", "2" and so on, seven channels each.

    Args:
        name: As the scene calls it.
        address: Name of the stream.
        clock: The session's.
    """

    def __init__(self, name: str, address: str, clock: Clock | None = None) -> None:
        self.name, self.problem, self.rejected = name, "", 0
        self._stream, self._clock = address, clock or MonotonicClock()
        self._believed: dict[str, Plausibility] = {}
        self._stopping = threading.Event()
        self._thread: threading.Thread | None = None

    def start(self, sink: TrackerSink) -> None:
        try:
            import pylsl
        except (ImportError, RuntimeError) as error:  # RuntimeError: the package without its library
            what = "pylsl is not installed" if isinstance(error, ImportError) else f"liblsl: {error}"
            raise DeviceError(what, "pip install mimics_app[lsl]") from None
        found = pylsl.resolve_byprop("name", self._stream, timeout=_PATIENCE_S)
        if not found or found[0].channel_count() % _NUMBERS:
            what = f'no LSL stream "{self._stream}" of seven numbers a sensor'
            raise DeviceError(what, "start the sender, or correct the tracker's address")
        self._inlet = pylsl.StreamInlet(found[0])
        self._inlet.open_stream(_PATIENCE_S)
        self._thread = threading.Thread(target=self._read, args=(sink,), name=f"tracker {self.name}", daemon=True)
        self._thread.start()

    def poll(self, now_ns: int) -> None:
        """It has a thread."""

    def stop(self) -> None:
        self._stopping.set()
        if self._thread is not None:
            self._thread.join()
            self._inlet.close_stream()

    def _read(self, sink: TrackerSink) -> None:
        while not self._stopping.is_set():
            try:
                values, stamp = self._inlet.pull_sample(_LOOK_S)
            except Exception as error:  # noqa: BLE001  pylsl's own errors, of a stream that is lost
                self.problem = f"the stream is lost: {error}"
                return
            if values is not None:
                self._take(values, stamp, sink)

    def _take(self, values: list[Any], stamp: float, sink: TrackerSink) -> None:
        t_ns = self._clock.now_ns()
        for first in range(0, len(values), _NUMBERS):
            x, y, z, qx, qy, qz, qw = map(float, values[first : first + _NUMBERS])
            length = math.sqrt(qx * qx + qy * qy + qz * qz + qw * qw)
            sensor = str(first // _NUMBERS + 1)
            if not 0.9 < length < 1.1:
                self.rejected += 1
                continue
            rotation = (qx / length, qy / length, qz / length, qw / length)
            sample = TrackerSample(sensor, t_ns, (x, y, z), rotation, round(stamp * 1e9))
            if self._believed.setdefault(sensor, Plausibility()).admits(sample):
                sink(sample)
            else:
                self.rejected += 1
