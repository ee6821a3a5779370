"""What a stability experiment is and what comes out of one."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, Literal

__all__ = ["Experiment", "Outcome", "Points", "largest_disagreement"]

Points = list[tuple[float, float]]


@dataclass(frozen=True, slots=True)
class Outcome:
    """What one run of an experiment found. All numbers finite, or None in `rows` where there is none.

    Attributes:
        rows: The table: one flat row per point of the grid, keys the same in all, units in the keys' names.
        simulated: (x, y) by simulation with the functions the loop runs.
        exact: (x, y) by eigenvalues or a closed form, computed independently.
        rules: Simplified rules that people use, by name, to be drawn beside.
        disagreement: Boundary: largest relative difference of simulated and exact; invariant: its error.
        passed: Within the experiment's tolerance.
        note: One or two sentences for the caption: what is to be seen.
    """

    rows: list[dict[str, Any]]
    simulated: Points
    exact: Points
    rules: dict[str, Points] = field(default_factory=dict)
    disagreement: float = 0.0
    passed: bool = False
    note: str = ""


@dataclass(frozen=True, slots=True)
class Experiment:
    """One way of failing, swept over its parameters.

    Attributes:
        name: "S1" to "S16".
        title: What fails, in a few words.
        claim: One sentence that can be wrong.
        x_label, y_label: Of the map, with units.
        kind: "boundary" where simulation meets an exact stability limit, "invariant" where an error is to stay small.
        run: Runs it; the argument is how fine the grid is (tests use a small number).
        tolerance: Largest `Outcome.disagreement` that passes.
        log_x, log_y: Axes drawn by powers of ten.
    """

    name: str
    title: str
    claim: str
    x_label: str
    y_label: str
    kind: Literal["boundary", "invariant"]
    run: Callable[[int], Outcome]
    tolerance: float
    log_x: bool = False
    log_y: bool = False


def largest_disagreement(simulated: Points, exact: Points) -> float:
    """Largest relative difference of two boundaries given at the same x, by y.

    Raises:
        ValueError: Different numbers of points, different x, or none.
    """
    if len(simulated) != len(exact) or not exact:
        raise ValueError(f"{len(simulated)} simulated against {len(exact)} exact points")
    if any(a[0] != b[0] for a, b in zip(simulated, exact, strict=True)):
        raise ValueError("simulated and exact points stand at different x")
    return max(abs(a[1] - b[1]) / max(abs(b[1]), 1e-300) for a, b in zip(simulated, exact, strict=True))
