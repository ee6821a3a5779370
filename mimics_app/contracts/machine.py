"""The machine that figures were measured on, as a caption says it and as a file name keeps it apart from others."""

from __future__ import annotations

import hashlib
from dataclasses import asdict, dataclass
from typing import Any

__all__ = ["Machine", "describe_machine"]


@dataclass(frozen=True, slots=True)
class Machine:
    """What a measured figure depends on; nothing that names a person or a host.

    Attributes:
        processor: As the system calls it.
        cores: Logical ones.
        system: Kernel and its release.
        software: Versions of Python and of what compiles the kernels.
    """

    processor: str
    cores: int
    system: str
    software: str

    def __str__(self) -> str:
        return f"{self.processor}, {self.cores} cores, {self.system}, {self.software}"

    @property
    def key(self) -> str:
        """A short name of the hardware for files, the same after an update of the system."""
        return hashlib.sha256(f"{self.processor}/{self.cores}".encode()).hexdigest()[:12]

    def as_dict(self) -> dict[str, Any]:
        """Plain values for a file."""
        return asdict(self)


def describe_machine() -> Machine:
    """The machine this process runs on."""
    from mimics_app.contracts.environment import describe_environment

    environment = describe_environment()
    machine, versions = environment["machine"], environment["versions"]
    names = ("python", "numpy", "numba")
    return Machine(
        processor=str(machine["processor"]),
        cores=int(machine["cores"] or 1),
        system=str(machine["system"]),
        software=", ".join(f"{name} {versions[name]}" for name in names if name in versions),
    )
