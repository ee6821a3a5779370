"""Trackers without a thread, which report when the session polls them, once a frame: base class, and the headset."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable, Sequence

from mimics_app.contracts.ports.tracker_port import TrackerSample, TrackerSink, TrackerSource

__all__ = ["HeadsetTracker", "PolledTracker"]


class PolledTracker(TrackerSource):
    """A tracker that reports between `start` and `stop`, in the thread of the session.

    Args:
        name: Name in the scene.
    """

    def __init__(self, name: str) -> None:
        self.name, self.problem, self.rejected = name, "", 0
        self._sink: TrackerSink | None = None

    @abstractmethod
    def _report(self, now_ns: int, sink: TrackerSink) -> None:
        """Deliver the reports due at a session time [ns]."""

    def start(self, sink: TrackerSink) -> None:
        self._sink = sink

    def poll(self, now_ns: int) -> None:
        if self._sink is not None:
            self._report(now_ns, self._sink)

    def stop(self) -> None:
        self._sink = None


class HeadsetTracker(PolledTracker):
    """Tracker that polls the display of the session once a frame; a display without tracking reports nothing.

    Args:
        name: Name in the scene.
    """

    def __init__(self, name: str) -> None:
        super().__init__(name)
        self._reports: Callable[[], Sequence[TrackerSample]] = tuple
        self._newest_ns = -1

    def attach_display(self, reports: Callable[[], Sequence[TrackerSample]]) -> None:
        self._reports = reports

    def _report(self, now_ns: int, sink: TrackerSink) -> None:
        samples = [sample for sample in self._reports() if sample.t_ns > self._newest_ns]
        for sample in samples:
            sink(sample)
            self._newest_ns = max(self._newest_ns, sample.t_ns)
