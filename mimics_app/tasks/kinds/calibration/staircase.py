"""A staircase: each right answer makes the next question harder, any other one easier; the threshold is in between.

One up, one down (Levitt, J Acoust Soc Am 49(2B), 1971): it converges to what is answered half of the time. The steps
become smaller at each of the first reversals; the threshold is the mean of the later ones.
"""

from __future__ import annotations

from collections.abc import Sequence
from statistics import fmean

__all__ = ["Staircase"]


class Staircase:
    """One staircase.

    Args:
        first: Level of the first question.
        easiest, hardest: Limits of the level; the smaller number is the harder one.
        steps: Step between two levels, up to each of the first reversals; the last one stays.
        counting: Number of reversals of that last step that make the threshold.

    Attributes:
        level: Level of the next question.
        reversals: Levels at which the direction changed, of the smallest step.
        done: Whether the threshold is known.
    """

    def __init__(self, first: float, easiest: float, hardest: float, steps: Sequence[float], counting: int) -> None:
        self.level = first
        self.reversals: list[float] = []
        self._easiest, self._hardest = easiest, hardest
        self._steps, self._counting = list(steps), counting
        self._was_right: bool | None = None
        self.done = False

    def answer(self, right: bool) -> None:
        """Take an answer to a question of the present level."""
        turned = self._was_right is not None and right is not self._was_right
        self._was_right = right
        if turned and len(self._steps) > 1:
            self._steps.pop(0)
        elif turned or self._at_end(right):
            self.reversals.append(self.level)
        step = -self._steps[0] if right else self._steps[0]
        self.level = min(max(self.level + step, self._hardest), self._easiest)
        self.done = len(self.reversals) >= self._counting

    @property
    def threshold(self) -> float:
        """Level between what is answered and what is not, after the end."""
        return fmean(self.reversals)

    def _at_end(self, right: bool) -> bool:
        """Whether the level can go no farther."""
        return self.level <= self._hardest if right else self.level >= self._easiest
