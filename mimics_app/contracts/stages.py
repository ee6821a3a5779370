"""The stages of D2.1 Figure 1 that have a null form, as the frame calls them, left to right.

inputs -> dsp -> estimation -> learning -> tasks -> (haptic, visual, audio rendering)
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

from mimics_app.contracts.messages import FeatureFrame, SignalBlock, TaskAction, TrialResult, UserState

__all__ = ["Dsp", "Estimation", "Goal", "Learning"]


class Dsp(Protocol):
    """Signals -> features."""

    def process(self, signals: Sequence[SignalBlock], now_ns: int) -> FeatureFrame:
        """Features as they stand at now_ns, computed from all blocks so far."""
        ...


class Estimation(Protocol):
    """Features -> state of the person."""

    def update(self, features: FeatureFrame) -> UserState:
        """The state as it stands at the features' time; None where nothing is known."""
        ...

    def judge(self, result: TrialResult) -> UserState:
        """The state with what a trial that ended says of it, before the learning system is asked."""
        ...


class Goal(Protocol):
    """What the learning system is to bring about."""

    def reward(self, state: UserState, result: TrialResult | None) -> float | None:
        """What this frame is worth; None where there is nothing to judge, which is in most frames."""
        ...


class Learning(Protocol):
    """State of the person, result and reward -> adaptation of the task."""

    def choose(
        self, state: UserState, result: TrialResult | None, reward: float | None, now_ns: int
    ) -> TaskAction | None:
        """The next adaptation, or None to leave the task as it is. Called once a frame, after the task.

        Args:
            state: Of the person.
            result: Of the trial that ended in this frame.
            reward: What the goal finds this frame worth.
            now_ns: Of the frame.
        """
        ...
