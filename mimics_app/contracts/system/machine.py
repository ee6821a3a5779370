"""Description of the machine of a measurement, for captions and file names."""

from __future__ import annotations

import hashlib
from dataclasses import asdict, dataclass
from typing import Any

__all__ = ["Machine", "describe_machine", "machine_key"]


@dataclass(frozen=True, slots=True)
class Machine:
    """Machine of a measurement: what its figures depend on, without names of persons, hosts or products.

    Attributes:
        cores: Number of logical cores.
        architecture: Instruction set of the processor, as "x86_64".
        software: Versions of Python and numba, and of Mesa where pictures were drawn.
    """

    cores: int
    architecture: str
    software: str

    def __str__(self) -> str:
        return f"{self.cores} cores, {self.architecture}, {self.software}"

    def as_dict(self) -> dict[str, Any]:
        """Return plain values for a file."""
        return asdict(self)


def describe_machine(mesa: str = "") -> Machine:
    """Return the machine of this process.

    Args:
        mesa: Version of Mesa that drew what was measured, "" where nothing was drawn by it.
    """
    from mimics_app.contracts.system.run_environment import describe_environment

    environment = describe_environment()
    machine, versions = environment["machine"], {**environment["versions"], **({"Mesa": mesa} if mesa else {})}
    return Machine(
        cores=int(machine["cores"] or 1),
        architecture=str(machine["architecture"]),
        software=", ".join(f"{name} {versions[name]}" for name in ("python", "numba", "Mesa") if name in versions),
    )


def machine_key() -> str:
    """Return a short name of the hardware for files, unchanged by an update of the system."""
    from mimics_app.contracts.system.run_environment import describe_environment

    machine = describe_environment()["machine"]
    return hashlib.sha256(f"{machine['processor']}/{machine['cores']}".encode()).hexdigest()[:12]
