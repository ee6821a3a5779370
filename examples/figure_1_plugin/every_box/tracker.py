"""Tracker: a head that nods twice in three seconds."""

from __future__ import annotations

import math

from mimics_app.contracts.ports.tracker_port import TrackerSample
from mimics_app.inputs.trackers.polled_tracker import PolledTracker


class Nodding(PolledTracker):
    """A sensor that turns about the x axis by five degrees."""

    def __init__(self, request):
        super().__init__(request.spec.name)

    def _report(self, now_ns, sink):
        half = 0.5 * math.radians(5.0) * math.sin(2.0 * math.pi * now_ns * 1e-9 / 1.5)
        sink(TrackerSample("1", now_ns, (0.0, 0.0, 0.0), (math.sin(half), 0.0, 0.0, math.cos(half))))
