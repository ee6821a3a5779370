"""Replay of the left half of D2.1 Figure 1: stages process recorded signals and results again; outputs are compared."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import msgspec

from mimics_app.app.session.body import make_stages
from mimics_app.app.session.signal_recorder import SignalRecorder
from mimics_app.contracts.errors import PartialDataError
from mimics_app.contracts.messages.stage_messages import SignalBlock, TrialResult
from mimics_app.recording.event_log import encode_line
from mimics_app.recording.run import Run
from mimics_app.recording.signal_rows import SignalRow

__all__ = ["BodyReplay", "replay_body"]

_COMPARED = ("features", "person", "choice")


@dataclass(frozen=True, slots=True)
class BodyReplay:
    """Result of the comparison.

    Attributes:
        features, states, choices: Number of each that was compared.
        difference: The first difference, in words; "" where all are equal.
    """

    features: int
    states: int
    choices: int
    difference: str = ""


class _Lines:
    """Substitute for the recorder that keeps the lines of events.jsonl in memory."""

    def __init__(self) -> None:
        self.kept: dict[str, list[dict[str, Any]]] = defaultdict(list)

    def journal(self, kind: str, data: Mapping[str, object]) -> None:
        """Keep a line as it is read from its text."""
        self.kept[kind].append(msgspec.json.decode(encode_line("app", kind, data)))

    def signals(self, rows: Sequence[SignalRow]) -> None:
        """Do nothing: signals are the input of the replay."""


def replay_body(run: Run) -> BodyReplay | None:
    """Replay and compare; None where the run neither measured nor adapted.

    Raises:
        PartialDataError: Frames or signals are missing.
    """
    header = run.session.get("body")
    if not isinstance(header, dict):
        return None
    stages, lines = make_stages(header), _Lines()
    recorder = SignalRecorder(lines)
    results = {line["frame"]: _result(line) for line in run.lines_of("app", "result")}
    commands = run.lines_of("app", "command")
    recalibrated = {line["frame"] for line in commands if line.get("command") == "recalibrate" and line["done"]}
    for number, now_ns, blocks in _frames(run):
        features = stages.dsp.process(blocks, now_ns)
        state = stages.estimation.update(features)
        if number in recalibrated:
            stages.estimation.recalibrate()
        result = results.get(number)
        for ended in (None, result) if number == 0 else (result,):
            state = state if ended is None else stages.estimation.update_from_result(ended)
            reward = stages.goal.reward(state, ended)
            recorder.choice(number, ended, reward, stages.learning.choose(state, ended, reward, now_ns))
        recorder.step(number, (), features, state)
    compared = [kind for kind in _COMPARED if kind != "choice" or header.get("learn")]
    recorded = {kind: run.lines_of("app", kind) for kind in compared}
    difference = next((d for kind in compared if (d := _difference(kind, recorded[kind], lines.kept[kind]))), "")
    counts = {kind: len(recorded.get(kind, ())) for kind in _COMPARED}
    return BodyReplay(counts["features"], counts["person"], counts["choice"], difference)


def _frames(run: Run) -> Iterator[tuple[int, int, list[SignalBlock]]]:
    """Yield number, time [ns] and signal blocks of each frame.

    Raises:
        PartialDataError: A frame is missing.
    """
    blocks: dict[int, list[SignalBlock]] = defaultdict(list)
    for row in run.signals:
        blocks[row.frame].append(row.block)
    for wanted, line in enumerate(run.lines_of("app", "frame")):
        if line["frame"] != wanted:
            raise PartialDataError(f"{run.folder}: frame {wanted} is missing", "its signals cannot be replayed")
        yield wanted, int(line["t_ns"]), blocks.get(wanted, [])


def _result(line: Mapping[str, Any]) -> TrialResult:
    return msgspec.convert({name: line[name] for name in line if name not in ("source", "kind", "frame")}, TrialResult)


def _difference(kind: str, recorded: Sequence[Mapping[str, Any]], replayed: Sequence[Mapping[str, Any]]) -> str:
    for one, other in zip(recorded, replayed, strict=False):
        if one != other:
            names = [name for name in one.keys() | other.keys() if one.get(name) != other.get(name)]
            return f"{kind} of frame {one.get('frame')}: {', '.join(sorted(names))} differ"
    if len(recorded) != len(replayed):
        return f"{len(recorded)} lines of {kind} recorded, {len(replayed)} replayed"
    return ""
