"""Head and hands as tracked by a headset: sensors `head`, `hand_left` and `hand_right`, in the room's frame."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from mimics_app.contracts.tracker_port import TrackerSample, TrackerSink, TrackerSource

__all__ = ["HeadsetTracker"]


class HeadsetTracker(TrackerSource):
    """Tracker that polls the display of the session once a frame; a display without tracking reports nothing.

    Args:
        name: Name in the scene.
    """

    def __init__(self, name: str) -> None:
        self.name, self.problem, self.rejected = name, "", 0
        self._sink: TrackerSink | None = None
        self._ask: Callable[[], Sequence[TrackerSample]] = tuple
        self._newest_ns = -1

    def listen_to(self, ask: Callable[[], Sequence[TrackerSample]]) -> None:
        """Set the function that returns the display's reports, each with the time its pose is predicted for."""
        self._ask = ask

    def start(self, sink: TrackerSink) -> None:
        self._sink = sink

    def poll(self, now_ns: int) -> None:
        if self._sink is None:
            return
        samples = [sample for sample in self._ask() if sample.t_ns > self._newest_ns]
        for sample in samples:
            self._sink(sample)
            self._newest_ns = max(self._newest_ns, sample.t_ns)

    def stop(self) -> None:
        self._sink = None
