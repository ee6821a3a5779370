"""Goals of a task: a trial is finished when all are met at once, each for its hold time."""

from __future__ import annotations

import math
from collections.abc import Sequence

from mimics_app.tasks.kinds.kind import KindPlay
from mimics_app.tasks.observation import Observation
from mimics_app.tasks.task import DurationGoal, GoalSpec, PointGoal

__all__ = ["Goals"]


class Goals:
    """The goals of a task, and the time since which each holds.

    Args:
        specs: The goals.
        plays: Kind of task of each goal; None for the task's own.
    """

    def __init__(self, specs: Sequence[GoalSpec], plays: Sequence[KindPlay | None]) -> None:
        self._specs = tuple(specs)
        self._plays = tuple(plays)
        self._since_ns: list[int | None] = [None] * len(self._specs)

    def restart(self) -> None:
        """Reset at the beginning of a travel."""
        self._since_ns = [None] * len(self._specs)

    def way(self, seen: Observation) -> float:
        """Return the longest of the shortest ways of the hand to each goal, at the beginning of a travel [m]."""
        return max(self._way(i, goal, seen) for i, goal in enumerate(self._specs))

    def met(self, seen: Observation, travelled_s: float) -> bool:
        """Whether all goals are met in this frame, `travelled_s` [s] after the travel began. Call once per frame."""
        done = [self._is_met(i, goal, seen, travelled_s) for i, goal in enumerate(self._specs)]
        return all(done)

    def _way(self, i: int, goal: GoalSpec, seen: Observation) -> float:
        if isinstance(goal, PointGoal):
            return max(0.0, math.dist(seen.hip_world, goal.position_world) - goal.within)
        play = self._plays[i]
        return 0.0 if play is None else play.way(goal, seen)

    def _is_met(self, i: int, goal: GoalSpec, seen: Observation, travelled_s: float) -> bool:
        if not self._holds(i, goal, seen, travelled_s):
            self._since_ns[i] = None
            return False
        since = self._since_ns[i]
        if since is None:
            since = self._since_ns[i] = seen.now_ns
        return (seen.now_ns - since) / 1e9 >= getattr(goal, "hold_s", 0.0)

    def _holds(self, i: int, goal: GoalSpec, seen: Observation, travelled_s: float) -> bool:
        """Whether a goal's condition holds in this frame, its hold time aside; exactly at the limit it does."""
        if isinstance(goal, DurationGoal):
            return travelled_s >= goal.seconds
        if isinstance(goal, PointGoal):
            return math.dist(seen.hip_world, goal.position_world) <= goal.within
        play = self._plays[i]
        return play is not None and play.holds(goal, seen)
