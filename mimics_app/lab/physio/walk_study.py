"""The guided walk with simulated walkers: share that reaches the goal within seven minutes, by condition."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mimics_app.learning.stepwise import StepValues, place_of
from mimics_app.tasks.kinds.guided_walk.kind import NEAREST
from mimics_app.tasks.kinds.guided_walk.walk_people import STEP_S, Alley, Deed, Guide, Walker

__all__ = ["WalkResult", "walk_study"]

_LIMIT_S = 420.0
_DEEDS = len(Deed)


@dataclass(frozen=True, slots=True)
class WalkResult:
    """Result of one condition.

    Attributes:
        condition: Name of the condition.
        people: Number of walkers.
        share: Share of them that reached the goal in time.
        low, high: 95 % interval of the share.
    """

    condition: str
    people: int
    share: float
    low: float
    high: float


def walk_study(condition: str, people: int = 300, seed: int = 1) -> WalkResult:
    """Simulate walkers with an untrained guide each; the walkers of a seed are the same in every condition."""
    times = np.array([_walk(condition, [seed, i]) for i in range(people)])
    came = np.isfinite(times)
    low, high = _wilson(int(came.sum()), people)
    return WalkResult(condition, people, float(came.mean()), low, high)


def _walk(condition: str, seed: list[int]) -> float:
    """Return the time to the goal [s], infinite where it was not reached."""
    rng, other = np.random.default_rng(seed).spawn(2)
    alley = Alley()
    walker, guide = Walker(rng, alley), Guide(alley, NEAREST[condition])
    table = StepValues(_DEEDS, other, learns=condition != "random")
    state = place_of({"gap": guide.x - walker.x, "left": alley.place - walker.x})
    for step in range(1, round(_LIMIT_S / STEP_S) + 1):
        deed, _ = table.choose(state)
        before = abs(alley.place - walker.x)
        guide.do(Deed(deed), walker.x)
        walker.answer(guide.x, Deed(deed))
        after = abs(alley.place - walker.x)
        if after <= alley.within:
            return step * STEP_S
        following = place_of({"gap": guide.x - walker.x, "left": alley.place - walker.x})
        table.learn(state, deed, before - after, following)
        state = following
    return float("inf")


def _wilson(hits: int, n: int, z: float = 1.96) -> tuple[float, float]:
    """Return the 95 % interval of a share (Wilson, J Am Stat Assoc 22, 1927)."""
    share = hits / n
    middle = (share + z * z / (2 * n)) / (1 + z * z / n)
    half = z / (1 + z * z / n) * float(np.sqrt(share * (1 - share) / n + z * z / (4 * n * n)))
    return middle - half, middle + half
