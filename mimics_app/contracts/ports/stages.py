"""Ports of the stages of D2.1 Figure 1 that have a null form, in the order of the frame.

inputs -> dsp -> estimation -> learning -> tasks -> (haptic, visual, audio rendering)
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

from mimics_app.contracts.messages.stage_messages import FeatureFrame, SignalBlock, TaskAction, TrialResult, UserState

__all__ = ["Dsp", "Estimation", "Goal", "Learning"]


class Dsp(Protocol):
    """Signals -> features."""

    def process(self, signals: Sequence[SignalBlock], now_ns: int) -> FeatureFrame:
        """Return the features at now_ns, computed from all blocks so far."""
        ...


class Estimation(Protocol):
    """Features -> state of the person."""

    def update(self, features: FeatureFrame) -> UserState:
        """Return the state at the features' time, with None for unknown quantities."""
        ...

    def update_from_result(self, result: TrialResult) -> UserState:
        """Return the state updated with the result of a trial, before the learning system is called."""
        ...

    def recalibrate(self) -> None:
        """Measure the person's baseline anew from the next features on."""
        ...


class Goal(Protocol):
    """Goal of the learning system."""

    def reward(self, state: UserState, result: TrialResult | None) -> float | None:
        """Return the reward of this frame; None in frames without one, which are most."""
        ...


class Learning(Protocol):
    """State of the person, result and reward -> adaptation of the task."""

    def choose(
        self, state: UserState, result: TrialResult | None, reward: float | None, now_ns: int
    ) -> TaskAction | None:
        """Return the next adaptation, or None to leave the task unchanged. Called once per frame, after the task.

        Args:
            state: State of the person.
            result: Result of a trial that ended in this frame.
            reward: Reward of this frame by the goal.
            now_ns: Time of the frame.
        """
        ...
