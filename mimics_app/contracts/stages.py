"""The stages of D2.1 Figure 1 that have a null form, as the frame calls them, left to right.

inputs -> dsp -> estimation -> learning -> tasks -> (haptic, visual, audio rendering)
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

from mimics_app.contracts.messages import FeatureFrame, SignalBlock, TaskAction, UserState

__all__ = ["Dsp", "Estimation", "Learning"]


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


class Learning(Protocol):
    """State of the person -> adaptation of the task."""

    def choose(self, state: UserState, now_ns: int) -> TaskAction | None:
        """The next adaptation, or None to leave the task as it is."""
        ...
