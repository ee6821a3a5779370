"""`mimics replay RUN`: simulate a recorded run again from its inputs and compare every output, bit for bit."""

from __future__ import annotations

import argparse
from pathlib import Path

from mimics_app.app.terminal.output import answer
from mimics_app.contracts.errors import counted

__all__ = ["add_arguments", "run"]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of `mimics replay`."""
    parser.add_argument("run_folder", type=Path, metavar="RUN", help="run folder")


def run(args: argparse.Namespace) -> int:
    """Replay and compare: first the haptic loop, then the task on the snapshots of the loop.

    Raises:
        PartialDataError: A tick or the task differs, or the run misses ticks, parameters or frames.
    """
    from mimics_app.app.terminal.first_start import say_if_cold
    from mimics_app.recording.run import Run

    recorded = Run.open(args.run_folder)
    say_if_cold()
    from mimics_app.app.session.replay import play_loop, play_task
    from mimics_app.contracts.errors import PartialDataError
    from mimics_app.recording.replay import compare, compare_events, gather

    data, end = gather(recorded), recorded.comparable_end
    replayed = play_loop(recorded, data)
    difference = compare(data.samples, replayed.samples, recorded.layout.absent)
    difference = difference or compare_events(recorded.events, replayed.events, end)
    task, task_difference = (None, None) if difference else play_task(recorded, replayed.snapshots)
    if difference or task_difference:
        raise PartialDataError(
            f"{args.run_folder} replays differently: {difference or task_difference}",
            "its inputs were changed, or another version or machine recorded it",
        )
    from mimics_app.app.session.body_replay import replay_body

    body = replay_body(recorded)
    if body is not None and body.difference:
        raise PartialDataError(
            f"{args.run_folder} replays differently: {body.difference}",
            "its signals were changed, or another version or machine recorded it",
        )
    ticks, events = len(data.samples), int((recorded.events["tick"] < end).sum())
    left = len(recorded.events) - events
    counts = {"ticks": ticks, "events": events, "events_not_compared": left, "task": task, "equal": True}
    lines = [
        f"{ticks} ticks replayed, every output and {counted(events, 'events')} equal bit for bit{_left_out(left, end)}"
    ]
    lines.append(_task_line(task))
    if body is not None:
        counts |= {"features": body.features, "states": body.states, "choices": body.choices}
        lines.append(f"{body.features} frames of features, {body.states} states and {body.choices} choices equal")
    answer(args, {"run_dir": args.run_folder, **counts}, lines)
    return 0


def _task_line(task: dict[str, int] | None) -> str:
    """Return what was compared of the task."""
    if task is None:
        return "its task is not compared: the recording does not hold the inputs of the task"
    return f"its task: {counted(task['events'], 'events')} and {counted(task['rows'], 'rows')} of trials.csv equal"


def _left_out(events: int, end: int) -> str:
    """Return what is not compared of a run that was cut off."""
    return f"; the run was cut off: not compared: {counted(events, 'events')} from tick {end} on" if events else ""
