"""Recording of the person in each frame: signals, features, state, results and choices."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Protocol

import msgspec

from mimics_app.contracts.messages.stage_messages import FeatureFrame, SignalBlock, TaskAction, TrialResult, UserState
from mimics_app.recording.signal_rows import SignalRow

__all__ = ["SignalRecorder", "SignalSink"]

_FRAMES = 30
"""Number of frames of signals sent as one message: half a second, as a message costs more than its samples."""


class SignalSink(Protocol):
    """Recorder as a signal recorder needs it."""

    def journal(self, kind: str, data: Mapping[str, object]) -> None:
        """Write a line of the journal."""
        ...

    def signals(self, rows: Sequence[SignalRow]) -> None:
        """Write blocks of signals."""
        ...


class SignalRecorder:
    """Sends new data of the person to the recorder.

    Args:
        recorder: Recorder of the session.
    """

    def __init__(self, recorder: SignalSink) -> None:
        self._recorder = recorder
        self._rows: list[SignalRow] = []
        self._features_ns = self._state_ns = -1

    def step(self, frame: int, signals: Sequence[SignalBlock], features: FeatureFrame, state: UserState) -> None:
        """Record what is new in a frame."""
        self._rows += [SignalRow(frame, block) for block in signals]
        if self._rows and frame % _FRAMES == _FRAMES - 1:
            self.flush()
        if features.values and features.t_ns != self._features_ns:
            self._features_ns = features.t_ns
            self._recorder.journal("features", _features_line(frame, features))
        if state.quality > 0.0 and state.t_ns != self._state_ns:
            self._state_ns = state.t_ns
            self._recorder.journal("person", _person_line(frame, state))

    def choice(self, frame: int, result: TrialResult | None, reward: float | None, action: TaskAction | None) -> None:
        """Record the result given to the learning system and its choice, where there is one."""
        if result is not None:
            self._recorder.journal("result", _result_line(frame, result))
        if action is not None:
            self._recorder.journal("choice", _choice_line(frame, reward, action))

    def flush(self) -> None:
        """Send the signals that are buffered."""
        if self._rows:
            self._recorder.signals(self._rows)
            self._rows = []


def _features_line(frame: int, features: FeatureFrame) -> Mapping[str, object]:
    """Return features as a line of events.jsonl."""
    return {"frame": frame, "t_ns": features.t_ns, "values": dict(features.values), "quality": dict(features.quality)}


def _person_line(frame: int, state: UserState) -> Mapping[str, object]:
    """Return a state as a line of events.jsonl: [mean, variance] of each known quantity."""
    estimates = {name: getattr(state, name) for name in ("arousal", "valence", "effort")}
    known = {name: [e.mean, e.variance] for name, e in estimates.items() if e is not None}
    load = {} if state.load is None else {"load": list(state.load)}
    return {"frame": frame, "t_ns": state.t_ns, **known, **load, "quality": state.quality}


def _result_line(frame: int, result: TrialResult) -> Mapping[str, object]:
    """Return a result as a line of events.jsonl; `TrialResult(**line)` without the frame restores it."""
    return {"frame": frame, **msgspec.to_builtins(result)}


def _choice_line(frame: int, reward: float | None, action: TaskAction) -> Mapping[str, object]:
    """Return a choice as a line of events.jsonl, with the reward of the frame."""
    return {
        "frame": frame,
        "values": dict(action.values),
        "at_trial": action.at_trial,
        "propensity": action.propensity,
        "reward": reward,
    }
