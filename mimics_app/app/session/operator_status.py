"""State of a session for its operator, twenty times a second: what a person reads, in plain values."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from mimics_app.contracts.loop.haptic import SafetyState, TripCause
from mimics_app.contracts.messages.stage_messages import TaskAction

if TYPE_CHECKING:
    from mimics_app.app.session.frame import Frames
    from mimics_app.app.session.session import Session

__all__ = ["status_of", "trial_line"]

_OF_TRIAL = ("trial", "attempt", "block", "label", "practice", "outcome", "cause", "score", "happened")
_CHOSEN = ("values", "at_trial", "propensity", "reward")


def trial_line(row: Mapping[str, object]) -> dict[str, object]:
    """Return what the operator's list of trials shows of a row."""
    begin, end = row.get("begin_ns"), row.get("end_ns")
    line = {name: row.get(name) for name in _OF_TRIAL}
    if isinstance(begin, int) and isinstance(end, int):
        line["seconds"] = (end - begin) / 1e9
    return line


def status_of(session: Session, frames: Frames, newest: Mapping[str, Mapping[str, object]]) -> dict[str, Any]:
    """Return the state after a frame.

    Args:
        session: The session.
        frames: Its frames.
        newest: Newest lines of the journal by kind: features, person, choice, result.
    """
    view, snapshot, board = frames.orders.view, frames.snapshot, frames.board
    late, plugin = session.haptics.histogram(), session.haptics.plugin
    return {
        "frame": frames.number,
        "now_ns": session.clock.now_ns(),
        "task": {
            "state": view.state.value,
            "trial": view.trial,
            "trials": view.trials,
            "elapsed_s": view.elapsed_s,
            "progress": view.progress,
            "paused": view.paused,
            "acts": frames.orders.person_may_act,
            "done": session.tasks.done,
        },
        "board": {
            "message": board.message,
            "alarm": board.alarm,
            "cards": [{"label": card.label, "text": card.text, "tone": card.tone} for card in board.cards.values()],
        },
        "safety": {
            "state": "" if snapshot is None else SafetyState(snapshot.state).name,
            "cause": "" if snapshot is None or not snapshot.cause else TripCause(snapshot.cause).name,
            "stop": None
            if frames.safety.stop is None
            else {"what": frames.safety.stop.what, "advice": frames.safety.stop.advice},
        },
        "loop": {
            "p50_us": late.p50,
            "p99_us": late.p99,
            "max_us": late.max,
            "recipe": late.recipe,
            "running": session.haptics.running,
        },
        "values": session.tasks.values,
        "policy": {
            "mode": frames.desk.gate.mode,
            "proposal": _action(frames.desk.gate.proposal),
            "choice": {name: newest["choice"].get(name) for name in _CHOSEN} if "choice" in newest else None,
        },
        "person": newest.get("person"),
        "features": newest.get("features"),
        "view": session.view,
        "volume": session.sound.volume,
        "signals_lost": [source.lost for source in session.inputs.signals if source.lost],
        "device": plugin.trouble(),
        "recorder": {
            "problem": session.recorder.problem,
            "restarts": session.recorder.restarts,
            "dropped": session.recorder.dropped,
        },
    }


def _action(action: TaskAction | None) -> dict[str, object] | None:
    return None if action is None else {"values": dict(action.values), "at_trial": action.at_trial}
