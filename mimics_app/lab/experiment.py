"""Stability experiments and their outcomes."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Literal

import numpy as np

__all__ = ["Experiment", "Outcome", "Points", "Row", "curves_of", "largest_disagreement", "points_of"]

Points = list[tuple[float, float]]

Row = dict[str, Any]
"""Row of an experiment's table: values by name, with the unit in the name."""

_OF_ROWS = -math.inf
"""Disagreement that the rows or curves tell."""


@dataclass(frozen=True, slots=True)
class Outcome:
    """Outcome of one run of an experiment. All numbers are finite; None in `rows` where there is none.

    Attributes:
        rows: The table, one row per point of the grid, all with the same keys.
        simulated: (x, y) by simulation with the functions of the loop.
        exact: (x, y) by eigenvalues or a closed form, computed independently.
        rules: Simplified rules in common use, by name, for comparison.
        disagreement: Boundary: largest relative difference of simulated and exact; invariant: its error. Without a
            value the largest "difference" of the rows, or of the two curves where the rows have none.
        holds: Whether the other parts of the claim hold.
        note: One or two sentences for the caption.
        passed: It holds, and the disagreement is within the experiment's tolerance; set by `Experiment.run`.
    """

    rows: list[Row]
    simulated: Points
    exact: Points
    rules: dict[str, Points] = field(default_factory=dict)
    disagreement: float = _OF_ROWS
    holds: bool = True
    note: str = ""
    passed: bool = False

    def __post_init__(self) -> None:
        if self.disagreement == _OF_ROWS:
            by_row = [row["difference"] for row in self.rows if "difference" in row]
            found = float(np.max(by_row)) if by_row else largest_disagreement(self.simulated, self.exact)
            object.__setattr__(self, "disagreement", found)


@dataclass(frozen=True, slots=True)
class Experiment:
    """One mode of failure, swept over its parameters.

    Attributes:
        title: The failure in a few words.
        claim: One falsifiable sentence.
        x_label, y_label: Axes of the map, with units.
        kind: "boundary": simulated against exact stability limit; "invariant": an error that must remain small.
        simulate: Simulates its grid with a number of points along each axis.
        tolerance: Largest `Outcome.disagreement` that passes.
        log_x, log_y: Logarithmic axes.
        name: "S1" to "S18", with a letter for a further experiment; given by the catalogue, from the name of its file.
    """

    title: str
    claim: str
    x_label: str
    y_label: str
    kind: Literal["boundary", "invariant"]
    simulate: Callable[[int], Outcome]
    tolerance: float = 0.02
    log_x: bool = False
    log_y: bool = False
    name: str = ""

    def run(self, points: int) -> Outcome:
        """Simulate the grid and return the outcome with its verdict.

        Args:
            points: Number of points along each axis of the grid.
        """
        found = self.simulate(points)
        return replace(found, passed=found.holds and found.disagreement <= self.tolerance)


def points_of(rows: Iterable[Mapping[str, Any]], x: str, y: str, scale: float = 1.0) -> Points:
    """Return two columns of a table as points; `scale` multiplies y."""
    return [(row[x], scale * row[y]) for row in rows]


def curves_of(rows: Sequence[Mapping[str, Any]], x: str, simulated: str, exact: str) -> tuple[Points, Points]:
    """Return the columns `simulated` and `exact` of a table as points over its column `x`."""
    return points_of(rows, x, simulated), points_of(rows, x, exact)


def largest_disagreement(simulated: Points, exact: Points) -> float:
    """Return the largest relative difference in y of two boundaries given at the same x; NaN where one is none.

    Raises:
        ValueError: Different numbers of points, different x, or none.
    """
    if len(simulated) != len(exact) or not exact:
        raise ValueError(f"{len(simulated)} simulated against {len(exact)} exact points")
    if any(a[0] != b[0] for a, b in zip(simulated, exact, strict=True)):
        raise ValueError("simulated and exact points stand at different x")
    return float(np.max([abs(a[1] - b[1]) / max(abs(b[1]), 1e-300) for a, b in zip(simulated, exact, strict=True)]))
