"""Poses by the lab streaming layer (extra `lsl`): a stream of seven channels per sensor, x y z qx qy qz qw."""

from __future__ import annotations

from typing import Any

from mimics_app.contracts.clock import Clock
from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.ports.tracker_port import TrackerSink
from mimics_app.inputs.trackers.threaded_tracker import POSE_NUMBERS, ThreadedTracker

__all__ = ["LslTracker"]

_PATIENCE_S = 5.0
_POLL_S = 0.05
_SILENCE_NS = 1_000_000_000
"""Time without a sample after which a stream counts as lost [ns]; the library waits for its sender for ever."""


class LslTracker(ThreadedTracker):
    """Tracker of one stream; its sensors are called "1", "2" and so on, seven channels each.

    Args:
        name: Name in the scene.
        address: Name of the stream.
        clock: The session's clock.
    """

    def __init__(self, name: str, address: str, clock: Clock | None = None) -> None:
        super().__init__(name, clock)
        self._stream = address

    def _open(self) -> None:
        try:
            import pylsl
        except (ImportError, RuntimeError) as error:  # RuntimeError: the package without its library
            what = "pylsl is not installed" if isinstance(error, ImportError) else f"liblsl: {error}"
            raise DeviceError(what, "pip install mimics_app[lsl]") from None
        found = pylsl.resolve_byprop("name", self._stream, timeout=_PATIENCE_S)
        if not found or found[0].channel_count() % POSE_NUMBERS:
            what = f'no LSL stream "{self._stream}" of seven numbers a sensor'
            raise DeviceError(what, "start the sender, or correct the tracker's address")
        self._inlet = pylsl.StreamInlet(found[0])
        self._inlet.open_stream(_PATIENCE_S)

    def _close(self) -> None:
        self._inlet.close_stream()

    def _read(self, sink: TrackerSink) -> None:
        received_ns = self._clock.now_ns()
        while not self._stopping.is_set():
            try:
                values, stamp = self._inlet.pull_sample(_POLL_S)
            except Exception as error:  # noqa: BLE001  pylsl's own errors, of a stream that is lost
                self.problem = f"the stream is lost: {error}"
                return
            now_ns = self._clock.now_ns()
            if values is not None:
                received_ns, self.problem = now_ns, ""
                self._take(values, stamp, sink)
            elif now_ns - received_ns > _SILENCE_NS:
                self.problem = f'no data of the stream "{self._stream}" for more than {_SILENCE_NS * 1e-9:g} s'

    def _take(self, values: list[Any], stamp: float, sink: TrackerSink) -> None:
        t_ns = self._clock.now_ns()
        for first in range(0, len(values), POSE_NUMBERS):
            pose = [float(value) for value in values[first : first + POSE_NUMBERS]]
            self._deliver_pose(str(first // POSE_NUMBERS + 1), pose, t_ns, sink, round(stamp * 1e9))
