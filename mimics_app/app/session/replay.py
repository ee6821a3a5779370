"""A recorded session simulated again: its loop from the inputs of every tick, its task from the frames it was given."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from mimics_app.contracts.errors import PartialDataError
from mimics_app.contracts.messages import HapticSnapshot
from mimics_app.recording.replay import ReplayData
from mimics_app.recording.run import Run
from mimics_app.recording.task_lines import FrameLine, TaskDifference, compare_lines, compare_rows, gather_task
from mimics_app.rendering.haptic.object_statics import ObjectStatics
from mimics_app.rendering.haptic.replay import Replayed, replay_run
from mimics_app.tasks.replay import TaskFrame, play_again, task_of_record

__all__ = ["play_loop", "play_task"]


def play_loop(run: Run, data: ReplayData) -> Replayed:
    """Every tick again, with what each frame saw of it."""
    kept = data.statics
    statics = None if kept is None else ObjectStatics.from_arrays(kept.arrays, kept.fields)
    seen = [line["tick"] for line in run.lines_of("app", "frame") if isinstance(line.get("tick"), int)]
    return replay_run(data.samples, data.blocks, data.rows, statics, seen=seen)


def play_task(run: Run, snapshots: Mapping[int, HapticSnapshot]) -> tuple[dict[str, int] | None, TaskDifference | None]:
    """The task again, on what the replayed loop showed its frames.

    Returns:
        How many "events" and "rows" were compared, and the first that differs. None and None for a recording that does
        not say what its task was given, as those of earlier versions.

    Raises:
        PartialDataError: What it says of its task or of a frame is missing or damaged.
    """
    if "task" not in run.session:
        return None, None
    try:
        spec, context = task_of_record(run.session["task"])
    except ValueError as error:
        fix = "install the kinds of task that it was recorded with"
        raise PartialDataError(f"{run.folder}: session.json#/task cannot be used: {error}", fix) from error
    recorded = gather_task(run)
    frames = _frames(run, recorded.frames, snapshots)
    again = play_again(spec, context, int(run.session.get("seed", 0)), frames, recorded.end_ns)
    difference = compare_lines(recorded.lines, again.lines)
    difference = difference or compare_rows(recorded.rows, again.rows, whole=recorded.whole)
    return {"events": len(recorded.lines), "rows": min(len(recorded.rows), len(again.rows))}, difference


def _frames(run: Run, lines: list[FrameLine], snapshots: Mapping[int, HapticSnapshot]) -> Iterator[TaskFrame]:
    first = 0
    for line in lines:
        if line.tick not in snapshots:
            raise PartialDataError(f"{run.folder}: frame {line.frame} saw tick {line.tick}, which is not there")
        events = run.events[first : first + line.events]
        first += line.events
        yield TaskFrame(line.pressed, line.chosen, snapshots[line.tick], events, line.t_ns)
