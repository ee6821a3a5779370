"""Base class of trackers without a thread: they report when the session polls them, once a frame."""

from __future__ import annotations

from abc import abstractmethod

from mimics_app.contracts.ports.tracker_port import TrackerSink, TrackerSource

__all__ = ["PolledTracker"]


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
