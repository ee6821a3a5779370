"""Job of a sweep worker: the same callable computes a chunk in this process, in another one and on another machine."""

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
    """A sweep as it is sent to a worker; a call computes a chunk of it.

    Attributes:
        text: Canonical text of the sweep.
        folder: Folder of the sweep file, to which its file names are relative.
        sources: Digest of the source code that planned the sweep.
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
            UsageError: The experiment is unknown.
            DeviceError: The sweep was planned by another version of the source code.
        """
        if source_digest() != self.sources:
            raise DeviceError("the worker runs another version of mimics_app", "install the same one everywhere")
        experiment = find_experiment(self.sweep.experiment)
        if experiment is None:
            raise UsageError(f'there is no experiment "{self.sweep.experiment}"')
        return experiment

    def __call__(self, chunk: Chunk) -> bytes:
        """Compute one chunk and return it packed."""
        values = points_between(self.sweep, self.experiment, *chunk)
        return pack(self.sweep, self.experiment, chunk, values, self.experiment.run(values, Path(self.folder)))

    def __getstate__(self) -> dict[str, str]:
        """Return the pickled state: the text, without the objects decoded from it."""
        return {"text": self.text, "folder": self.folder, "sources": self.sources}
