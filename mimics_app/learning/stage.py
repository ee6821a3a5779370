"""The learning stage of a scene that is not adapted."""

from __future__ import annotations

from mimics_app.contracts.messages import TaskAction, TrialResult, UserState

__all__ = ["NullLearning", "TaskGoal"]


class NullLearning:
    """Leaves the task as it is."""

    def choose(
        self, state: UserState, result: TrialResult | None, reward: float | None, now_ns: int
    ) -> TaskAction | None:
        """No adaptation."""
        return None


class TaskGoal:
    """What the task itself finds good."""

    def reward(self, state: UserState, result: TrialResult | None) -> float | None:
        """The reward of a trial that ended; practice is worth nothing."""
        return None if result is None or result.practice else result.reward
