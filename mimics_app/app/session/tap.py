"""What the recording keeps of the person, in the frame it arose: signals, features, state, results and choices."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Protocol

import msgspec

from mimics_app.contracts.messages import FeatureFrame, SignalBlock, TaskAction, TrialResult, UserState
from mimics_app.recording.signal_rows import SignalRow

__all__ = ["Keeper", "Tap", "choice_line", "features_line", "person_line", "result_line"]

_FRAMES = 30
"""Signals are handed over in pieces of half a second: one message costs more than its samples."""


class Keeper(Protocol):
    """What a tap needs of a recorder."""

    def journal(self, kind: str, data: Mapping[str, object]) -> None:
        """Keep a line."""
        ...

    def signals(self, rows: Sequence[SignalRow]) -> None:
        """Keep blocks of signals."""
        ...


class Tap:
    """Hands on to the recorder what is new.

    Args:
        recorder: Of the session.
    """

    def __init__(self, recorder: Keeper) -> None:
        self._recorder = recorder
        self._rows: list[SignalRow] = []
        self._features_ns = self._state_ns = -1

    def step(self, frame: int, signals: Sequence[SignalBlock], features: FeatureFrame, state: UserState) -> None:
        """One frame."""
        self._rows += [SignalRow(frame, block) for block in signals]
        if self._rows and frame % _FRAMES == _FRAMES - 1:
            self.flush()
        if features.values and features.t_ns != self._features_ns:
            self._features_ns = features.t_ns
            self._recorder.journal("features", features_line(frame, features))
        if state.quality > 0.0 and state.t_ns != self._state_ns:
            self._state_ns = state.t_ns
            self._recorder.journal("person", person_line(frame, state))

    def choice(self, frame: int, result: TrialResult | None, reward: float | None, action: TaskAction | None) -> None:
        """What the learning system was given and what it chose, where there was something of either."""
        if result is not None:
            self._recorder.journal("result", result_line(frame, result))
        if action is not None:
            self._recorder.journal("choice", choice_line(frame, reward, action))

    def flush(self) -> None:
        """Hand over what waits; the session ends."""
        if self._rows:
            self._recorder.signals(self._rows)
            self._rows = []


def features_line(frame: int, features: FeatureFrame) -> Mapping[str, object]:
    """Features as they stand in events.jsonl."""
    return {"frame": frame, "t_ns": features.t_ns, "values": dict(features.values), "quality": dict(features.quality)}


def person_line(frame: int, state: UserState) -> Mapping[str, object]:
    """A state as it stands in events.jsonl: [mean, variance] of each quantity that is known."""
    estimates = {name: getattr(state, name) for name in ("arousal", "valence", "effort")}
    known = {name: [e.mean, e.variance] for name, e in estimates.items() if e is not None}
    load = {} if state.load is None else {"load": list(state.load)}
    return {"frame": frame, "t_ns": state.t_ns, **known, **load, "quality": state.quality}


def result_line(frame: int, result: TrialResult) -> Mapping[str, object]:
    """A result as it stands in events.jsonl; `TrialResult(**line)` gives it back, the frame aside."""
    return {"frame": frame, **msgspec.to_builtins(result)}


def choice_line(frame: int, reward: float | None, action: TaskAction) -> Mapping[str, object]:
    """A choice as it stands in events.jsonl, with what the frame was worth."""
    return {
        "frame": frame,
        "values": dict(action.values),
        "at_trial": action.at_trial,
        "propensity": action.propensity,
        "reward": reward,
    }
