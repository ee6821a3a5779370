"""What the live stability monitor saw in a run."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["StabilityReport", "stability_of"]


@dataclass(frozen=True, slots=True)
class StabilityReport:
    """The worst of all contacts of a run.

    Attributes:
        margin: Smallest stability margin of the worst direction while anything was touched [-]; None where nothing was.
        stiffness_limit: Smallest stable stiffness meanwhile [N/m]; of now where nothing was touched.
        energy: Least energy any contact stood at [J]: 0 while every one was passive, below 0 what one gave away.
        stiffness_share: Least share of its authored stiffness a contact was rendered with [-]; below 1 the cap acted.
        passivity_ticks: Ticks in which the passivity controller took force away.
        tank: Least level of the energy tank [J].
        wall: Least margin of the tunnel's wall along its normal [-]; None where it was not touched.
        shapes: Likewise of each shape that was touched, by its row.
    """

    margin: float | None
    stiffness_limit: float
    energy: float
    stiffness_share: float
    passivity_ticks: int
    tank: float
    wall: float | None
    shapes: dict[int, float]

    def contacts(self, entities: Sequence[str]) -> dict[str, float]:
        """Least margin of each contact [-], by the entity of its shape's row; the tunnel's wall as "tunnel"."""
        least: dict[str, float] = {} if self.wall is None else {"tunnel": self.wall}
        for row, margin in self.shapes.items():
            name = entities[row]
            least[name] = min(margin, least.get(name, margin))
        return least

    def as_dict(self) -> dict[str, float]:
        """Under the keys of `mimics run --json`; what is about contacts is left out where there was none."""
        of_contacts = {}
        if self.margin is not None:
            of_contacts = {
                "margin_min": self.margin,
                "stiffness_limit_n_per_m": self.stiffness_limit,
                "energy_j": self.energy,
                "stiffness_share_min": self.stiffness_share,
            }
        return {**of_contacts, "passivity_ticks": self.passivity_ticks, "tank_min_j": self.tank}


def stability_of(states: NDArray[Any], margins: NDArray[np.float64]) -> StabilityReport:
    """Read it from the loop's records; exact once the loop has stopped.

    Args:
        states: STATE records of the points of contact, shape [points].
        margins: Least margin of each shape, inf where it was not touched, shape [shapes].
    """
    record, acting = states[0], states["acting"]
    met = states[states["touched"] == 1]
    touched = len(met) > 0
    limit = float(met["least_limit"].min() if touched else record["stiffness_limit"])
    return StabilityReport(
        margin=float(met["least_margin"].min()) if touched else None,
        stiffness_limit=limit if np.isfinite(limit) else 0.0,
        energy=float(states["least_energy"].min()),
        stiffness_share=float(met["acting"]["least_share"].min()) if touched else 1.0,
        passivity_ticks=int(acting["passivity_ticks"].sum()),
        tank=float(record["acting"]["least_tank"]),
        wall=float(record["least_wall_margin"]) if record["wall_touched"] else None,
        shapes={int(row): float(margins[row]) for row in np.flatnonzero(np.isfinite(margins))},
    )
