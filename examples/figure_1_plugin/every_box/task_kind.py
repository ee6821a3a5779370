"""Kind of task: time spent slowly counts, a measure of its own beside those of the tunnel."""

from __future__ import annotations

from typing import Annotated

from msgspec import Meta

from mimics_app.tasks.kinds.kind import KindPlay, Measure, TaskKind
from mimics_app.world.components.registry import Component


class LingeringSpec(Component, frozen=True):
    """Count the time in which the hand is slow."""

    slower_than: Annotated[float, Meta(gt=0.0, le=1.0, description="Speed below which the hand lingers [m/s]")] = 0.03


class LingeringPlay(KindPlay):
    """The time so far."""

    def __init__(self, spec):
        self._spec = spec
        self.begin_attempt()

    def begin_attempt(self):
        """Begin with nothing."""
        self._slow_s = 0.0

    @property
    def measures(self):
        """Columns of the trial table."""
        return {"lingering_s": self._slow_s}

    def travel(self, seen, seconds):
        """Take a frame of the travel."""
        if seen.speed < self._spec.slower_than:
            self._slow_s += seconds


class LingeringKind(TaskKind):
    """The kind, as the registry finds it."""

    name, section, label = "lingering", LingeringSpec, "Lingering"
    measures = (Measure.totalled("lingering_s", "lingering_s", "Time in which the hand was slow [s].", 1, 5),)

    def open(self, spec, context, seed):
        """Open the play of a session."""
        return LingeringPlay(spec.find(LingeringSpec))


KIND = LingeringKind()
