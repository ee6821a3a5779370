"""The guided walk with simulated walkers: share that reaches the goal within seven minutes, by condition and guide.

Guides that learn nothing are the controls: one that was never taught, and one for each action, done all the
time. A guide whose actions are permuted learns as well as any, unless the order of the actions helps.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from mimics_app.learning.stepwise import StepMethod, StepValues, place_of
from mimics_app.tasks.kinds.guided_walk.kind import NEAREST
from mimics_app.tasks.kinds.guided_walk.walk_people import STEP_S, Alley, Deed, Guide, Walker

__all__ = ["CONTROLS", "WalkResult", "walk_study"]

Lesson = Literal["taught", "permuted", "never taught"]
CONTROLS: tuple[Lesson | Deed, ...] = ("permuted", "never taught", *Deed)
"""Guides beside the one that learns."""

_LIMIT_S = 420.0


@dataclass(frozen=True, slots=True)
class WalkResult:
    """Result of one condition.

    Attributes:
        condition: Name of the condition.
        guide: "taught", "permuted", "never taught", or the action that is done all the time.
        people: Number of walkers.
        share: Share of them that reached the goal in time.
        low, high: 95 % interval of the share.
        median_s: Median of the time to the goal, infinite where fewer than half reached it [s].
    """

    condition: str
    guide: str
    people: int
    share: float
    low: float
    high: float
    median_s: float


def walk_study(condition: str, people: int = 300, seed: int = 1, guide: Lesson | Deed = "taught") -> WalkResult:
    """Simulate walkers with a new guide each; walkers and beginnings of a seed are the same for all guides."""
    times = np.array([_walk(condition, [seed, i], guide) for i in range(people)])
    came = np.isfinite(times)
    low, high = _wilson(int(came.sum()), people)
    name = guide.name.lower() if isinstance(guide, Deed) else guide
    return WalkResult(condition, name, people, float(came.mean()), low, high, float(np.median(times)))


def _walk(condition: str, seed: list[int], lesson: Lesson | Deed) -> float:
    """Return the time to the goal [s], infinite where it was not reached."""
    begins, steps, rng = np.random.default_rng(seed).spawn(3)
    alley = Alley()
    walker, guide = Walker(steps, alley), Guide(begins, alley, NEAREST[condition])
    always = int(lesson) if isinstance(lesson, Deed) else 0
    method: StepMethod = "fixed" if isinstance(lesson, Deed) else "random" if condition == "random" else "q"
    table = StepValues(len(Deed), rng, method, always)
    deeds = rng.permutation(len(Deed)) if lesson == "permuted" else np.arange(len(Deed))
    left, state = alley.left(walker.at), place_of(alley.observe(walker.at, guide.at))
    for step in range(1, round(_LIMIT_S / STEP_S) + 1):
        chosen, _ = table.choose(state)
        deed = Deed(int(deeds[chosen]))
        guide.do(deed, walker.at)
        walker.answer(guide.at, deed)
        before, left = left, alley.left(walker.at)
        if left <= alley.within:
            return step * STEP_S
        before_state, state = state, place_of(alley.observe(walker.at, guide.at))
        if lesson != "never taught":
            table.learn(before_state, chosen, before - left, state)
    return float("inf")


def _wilson(hits: int, n: int, z: float = 1.96) -> tuple[float, float]:
    """Return the 95 % interval of a share (Wilson, J Am Stat Assoc 22, 1927)."""
    share = hits / n
    middle = (share + z * z / (2 * n)) / (1 + z * z / n)
    half = z / (1 + z * z / n) * float(np.sqrt(share * (1 - share) / n + z * z / (4 * n * n)))
    return middle - half, middle + half
