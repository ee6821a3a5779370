"""Job of a sweep worker: the same function computes a chunk here, in a process and on another machine."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import msgspec

from mimics_app.app.sweep.experiments import find_experiment
from mimics_app.contracts.errors import DeviceError, UsageError
from mimics_app.lab.sweep.points import points_between
from mimics_app.lab.sweep.quantity import SweepExperiment
from mimics_app.lab.sweep.spec import Sweep
from mimics_app.lab.sweep.store import Chunk, pack, source_digest

__all__ = ["SweepJob"]


@dataclass(frozen=True)
class SweepJob:
    """A sweep as it travels to a worker; calling it with a chunk computes that chunk.

    Attributes:
        text: The sweep, canonical.
        folder: Of the sweep file: what names in it are relative to.
        sources: Digest of the program that planned it.
    """

    text: str
    folder: str
    sources: str

    @cached_property
    def sweep(self) -> Sweep:
        """The sweep."""
        return msgspec.json.decode(self.text, type=Sweep)

    @cached_property
    def experiment(self) -> SweepExperiment:
        """Its experiment.

        Raises:
            UsageError: This program has no such experiment.
            DeviceError: This program has another version than the one that planned the sweep.
        """
        if source_digest() != self.sources:
            raise DeviceError("the worker runs another version of mimics_app", "install the same one everywhere")
        experiment = find_experiment(self.sweep.experiment)
        if experiment is None:
            raise UsageError(f'there is no experiment "{self.sweep.experiment}"')
        return experiment

    def __call__(self, chunk: Chunk) -> bytes:
        """Compute one chunk."""
        values = points_between(self.sweep, self.experiment, *chunk)
        return pack(self.sweep, self.experiment, chunk, values, self.experiment.run(values, Path(self.folder)))

    def __getstate__(self) -> dict[str, str]:
        """Return what is pickled: the text, not the objects decoded from it."""
        return {"text": self.text, "folder": self.folder, "sources": self.sources}
