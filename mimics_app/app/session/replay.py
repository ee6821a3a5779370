"""Replay of a recorded session: the loop from the inputs of every tick, the task from the inputs of every frame."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from numpy.typing import NDArray

from mimics_app.contracts.device_descriptor import Kinematics
from mimics_app.contracts.errors import PartialDataError
from mimics_app.contracts.messages import HapticSnapshot, TaskAction, VRInput
from mimics_app.contracts.scenario_port import TaskContext
from mimics_app.recording.replay import ReplayData
from mimics_app.recording.run import Run
from mimics_app.recording.run_folder import FILES
from mimics_app.recording.task_lines import (
    TASK_KINDS,
    FrameLine,
    TaskDifference,
    compare_lines,
    compare_rows,
    gather_task,
)
from mimics_app.rendering.haptic.devices.described import descriptor_of
from mimics_app.rendering.haptic.devices.device_names import SIMULATED
from mimics_app.rendering.haptic.object_statics import ObjectStatics
from mimics_app.rendering.haptic.replay import Replayed, replay_run
from mimics_app.tasks.attempts import Row
from mimics_app.tasks.kinds.registry import task_kinds
from mimics_app.tasks.task import TaskSpec
from mimics_app.tasks.task_manager import TaskManager
from mimics_app.tasks.task_record import task_of_record

__all__ = ["PlayedAgain", "TaskFrame", "play_again", "play_loop", "play_task"]


@dataclass(frozen=True, slots=True)
class TaskFrame:
    """Inputs of the task manager in one frame; see `TaskManager.step`."""

    pressed: tuple[str, ...]
    action: TaskAction | None
    snapshot: HapticSnapshot
    events: NDArray[Any]
    now_ns: int


@dataclass(frozen=True, slots=True)
class PlayedAgain:
    """Output of a task: (kind, data) of each line of the journal, and the rows of its attempts."""

    lines: list[tuple[str, dict[str, object]]] = field(default_factory=list)
    rows: list[Row] = field(default_factory=list)


def play_loop(run: Run, data: ReplayData) -> Replayed:
    """Every tick again, with what each frame saw of it.

    Raises:
        PartialDataError: What the loop was given once is not whole.
    """
    statics = _statics(data)
    seen = [line["tick"] for line in run.lines_of("app", "frame") if isinstance(line.get("tick"), int)]
    kinematics = _kinematics(run.session)
    return replay_run(data.samples, data.blocks, data.rows, statics, kinematics=kinematics, seen=seen)


def _statics(data: ReplayData) -> ObjectStatics | None:
    if data.statics is None:
        return None
    try:
        return ObjectStatics.from_arrays(data.statics.arrays, data.statics.fields)
    except ValueError as error:
        raise PartialDataError(f"{FILES['statics']}: {error}", "the run cannot be replayed without it") from error


def _kinematics(session: Mapping[str, Any]) -> Kinematics:
    """Of the device that was recorded; runs that name none are of a HapticMaster's kind.

    Raises:
        DeviceError: Its plug-in is not installed here.
    """
    moved_by = session.get("moved_by")
    name = moved_by.get("kind") or moved_by.get("device") if isinstance(moved_by, dict) else None
    return descriptor_of(str(name or SIMULATED)).kinematics


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
    journalled = {*TASK_KINDS, *(kind for each in task_kinds() for kind in each.journals)}
    recorded = gather_task(run, journalled)
    frames = _frames(run, recorded.frames, snapshots)
    seed, first = int(run.session.get("seed", 0)), _first_trial(run.session)
    again = play_again(spec, context, seed, frames, recorded.end_ns, first)
    difference = compare_lines(recorded.lines, [line for line in again.lines if line[0] in journalled])
    difference = difference or compare_rows(recorded.rows, again.rows, whole=recorded.whole)
    return {"events": len(recorded.lines), "rows": min(len(recorded.rows), len(again.rows))}, difference


def _first_trial(session: Mapping[str, Any]) -> int:
    """Trial that the session began with, 0 first."""
    settings = session.get("settings")
    first = settings.get("from_trial", 1) if isinstance(settings, dict) else 1
    return max(0, first - 1) if isinstance(first, int) else 0


def play_again(
    spec: TaskSpec,
    context: TaskContext,
    seed: int,
    frames: Iterable[TaskFrame],
    end_ns: int | None,
    first_trial: int = 0,
) -> PlayedAgain:
    """Give a task the frames it had.

    Args:
        spec: The task.
        context: What it knew of its scene.
        seed: Of the session.
        frames: From the first on.
        end_ns: When the session was ended; None where it never was.
        first_trial: It began with, 0 first.
    """
    again = PlayedAgain()
    manager = TaskManager(
        spec, context, seed, again.rows.append, lambda kind, data: again.lines.append((kind, dict(data))), first_trial
    )
    for frame in frames:
        manager.step(VRInput(pressed=frame.pressed), frame.action, frame.snapshot, frame.events, frame.now_ns)
    if end_ns is not None:
        manager.end_session(end_ns)
    return again


def _frames(run: Run, lines: list[FrameLine], snapshots: Mapping[int, HapticSnapshot]) -> Iterator[TaskFrame]:
    first = 0
    for line in lines:
        if line.tick not in snapshots:
            raise PartialDataError(f"{run.folder}: frame {line.frame} saw tick {line.tick}, which is not there")
        events = run.events[first : first + line.events]
        first += line.events
        yield TaskFrame(line.pressed, line.chosen, snapshots[line.tick], events, line.t_ns)
