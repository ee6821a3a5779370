"""Description of the machine of a measurement, for captions and file names."""

from __future__ import annotations

import hashlib
from dataclasses import asdict, dataclass
from typing import Any

__all__ = ["Machine", "describe_machine"]


@dataclass(frozen=True, slots=True)
class Machine:
    """Machine of a measurement, without names of persons or hosts.

    Attributes:
        processor: Name of the processor in the system.
        cores: Number of logical cores.
        system: Kernel and its release.
        software: Versions of Python, numpy and numba.
    """

    processor: str
    cores: int
    system: str
    software: str

    def __str__(self) -> str:
        return f"{self.processor}, {self.cores} cores, {self.system}, {self.software}"

    @property
    def key(self) -> str:
        """Short name of the hardware for files, unchanged by an update of the system."""
        return hashlib.sha256(f"{self.processor}/{self.cores}".encode()).hexdigest()[:12]

    def as_dict(self) -> dict[str, Any]:
        """Return plain values for a file."""
        return asdict(self)


def describe_machine() -> Machine:
    """Return the machine of this process."""
    from mimics_app.contracts.run_environment import describe_environment

    environment = describe_environment()
    machine, versions = environment["machine"], environment["versions"]
    names = ("python", "numpy", "numba")
    return Machine(
        processor=str(machine["processor"]),
        cores=int(machine["cores"] or 1),
        system=str(machine["system"]),
        software=", ".join(f"{name} {versions[name]}" for name in names if name in versions),
    )
