"""What the live stability monitor saw in a run."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["StabilityReport", "stability_of"]


@dataclass(frozen=True, slots=True)
class StabilityReport:
    """The worst of all contacts of a run.

    Attributes:
        margin: Smallest stability margin while a wall was touched [-]; None where nothing was.
        stiffness_limit: Smallest stable stiffness meanwhile [N/m]; of now where nothing was touched.
        energy: Least energy any contact stood at [J]: 0 while every one was passive, below 0 what one gave away.
    """

    margin: float | None
    stiffness_limit: float
    energy: float

    def as_dict(self) -> dict[str, float | None]:
        """Under the keys of `mimics run --json`."""
        return {
            "margin_min": self.margin,
            "stiffness_limit_n_per_m": self.stiffness_limit,
            "energy_j": self.energy,
        }


def stability_of(state: NDArray[Any]) -> StabilityReport:
    """Read it from the loop's STATE record, shape [1]; exact once the loop has stopped."""
    record = state[0]
    touched = bool(record["touched"])
    limit = float(record["least_limit"] if touched else record["stiffness_limit"])
    return StabilityReport(
        margin=float(record["least_margin"]) if touched else None,
        stiffness_limit=limit if np.isfinite(limit) else 0.0,
        energy=float(record["least_energy"]),
    )
