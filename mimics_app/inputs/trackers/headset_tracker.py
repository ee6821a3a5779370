"""Head and hands as tracked by a headset: sensors `head`, `hand_left` and `hand_right`, in the room's frame."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from mimics_app.contracts.ports.tracker_port import TrackerSample, TrackerSink
from mimics_app.inputs.trackers.polled_tracker import PolledTracker

__all__ = ["HeadsetTracker"]


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
