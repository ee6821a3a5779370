"""Results of the live stability monitor over a run."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["StabilityReport", "stability_of"]


@dataclass(frozen=True, slots=True)
class StabilityReport:
    """Worst values over all contacts of a run.

    Attributes:
        margin: Smallest stability margin in the worst direction of any contact [-]; None without a contact.
        stiffness_limit: Smallest stiffness limit during contacts [N/m]; without a contact the present one.
        energy: Smallest energy taken by a contact [J]: 0 while all were passive, negative: energy that one generated.
        stiffness_share: Smallest share of the authored stiffness that was rendered [-]; below 1 the cap acted.
        oscillations: Times that the virtual force fed an oscillation and faded.
        calm: Smallest share of the virtual force that was left then [-].
        passivity_ticks: Ticks in which the passivity controller reduced the force.
        tank: Lowest level of the energy tank [J].
        wall: Smallest margin of the tunnel's wall along its normal [-]; None where it was not touched.
        shapes: Smallest margin of each touched shape [-], by row.
    """

    margin: float | None
    stiffness_limit: float
    energy: float
    stiffness_share: float
    oscillations: int
    calm: float
    passivity_ticks: int
    tank: float
    wall: float | None
    shapes: dict[int, float]

    def contacts(self, entities: Sequence[str]) -> dict[str, float]:
        """Return the smallest margin of each contact [-] by the entity of its shape; the tunnel's wall as "tunnel"."""
        least: dict[str, float] = {} if self.wall is None else {"tunnel": self.wall}
        for row, margin in self.shapes.items():
            name = entities[row]
            least[name] = min(margin, least.get(name, margin))
        return least

    def as_dict(self) -> dict[str, float]:
        """Return the values under the keys of `mimics run --json`; without a contact those of contacts are left out."""
        of_contacts = {}
        if self.margin is not None:
            of_contacts = {
                "margin_min": self.margin,
                "stiffness_limit_n_per_m": self.stiffness_limit,
                "energy_j": self.energy,
                "stiffness_share_min": self.stiffness_share,
            }
        fading = {"oscillations": self.oscillations, "calm_min": self.calm} if self.oscillations else {}
        return {**of_contacts, **fading, "passivity_ticks": self.passivity_ticks, "tank_min_j": self.tank}


def stability_of(states: NDArray[Any], margins: NDArray[np.float64]) -> StabilityReport:
    """Read the report from the loop's records; exact once the loop has stopped.

    Args:
        states: STATE records of the points of contact, shape [points].
        margins: Smallest margin of each shape, inf where it was not touched, shape [shapes].
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
        oscillations=int(states["swing"]["count"].sum()),
        calm=float(states["swing"]["least_calm"][states["swing"]["begun"] == 1].min(initial=1.0)),
        passivity_ticks=int(acting["passivity_ticks"].sum()),
        tank=float(record["acting"]["least_tank"]),
        wall=float(record["least_wall_margin"]) if record["wall_touched"] else None,
        shapes={int(row): float(margins[row]) for row in np.flatnonzero(np.isfinite(margins))},
    )
