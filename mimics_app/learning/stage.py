"""The learning stage of a scene without adaptation, and the goal of the task itself."""

from __future__ import annotations

from mimics_app.contracts.messages import TaskAction, TrialResult, UserState

__all__ = ["NullLearning", "TaskGoal"]


class NullLearning:
    """Learning stage that never adapts the task."""

    def choose(
        self, state: UserState, result: TrialResult | None, reward: float | None, now_ns: int
    ) -> TaskAction | None:
        """Return None."""
        return None


class TaskGoal:
    """Goal: the task's own reward."""

    def reward(self, state: UserState, result: TrialResult | None) -> float | None:
        """Return the reward of a trial that ended; None after practice."""
        return None if result is None or result.practice else result.reward
