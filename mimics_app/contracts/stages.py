"""The stages of D2.1 Figure 1 as the frame calls them, left to right; each may be replaced by its null form.

inputs -> dsp -> estimation -> learning -> tasks -> (haptic, visual, audio rendering)
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Protocol

from numpy.typing import NDArray

from mimics_app.contracts.messages import (
    FeatureFrame,
    HapticSnapshot,
    SignalBlock,
    TaskAction,
    TaskOrders,
    UserState,
    VRInput,
)

__all__ = ["Dsp", "Estimation", "InputStage", "Learning", "TaskStage"]


class InputStage(Protocol):
    """What comes in: body signals and the pointing device."""

    def poll(self, now_ns: int) -> VRInput:
        """Everything that arrived since the last frame."""
        ...


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


class TaskStage(Protocol):
    """The task manager: flow of the scenario, goals, score."""

    @property
    def done(self) -> bool:
        """True when the last trial is over."""
        ...

    def step(
        self,
        vr: VRInput,
        action: TaskAction | None,
        snapshot: HapticSnapshot,
        events: NDArray[Any],
        now_ns: int,
    ) -> TaskOrders:
        """One frame: `events` are the EVENT records since the last frame, shape [n]."""
        ...

    def result(self) -> Mapping[str, float]:
        """Totals so far under the keys of `mimics run --json`."""
        ...
