"""Replay of a recorded session: the haptic loop from the inputs of each tick, the task from those of each frame."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from numpy.typing import NDArray

from mimics_app.contracts.commands.vocabulary import Command, Reply
from mimics_app.contracts.errors import PartialDataError
from mimics_app.contracts.loop.device_descriptor import Kinematics
from mimics_app.contracts.messages.head_place import HeadPlace
from mimics_app.contracts.messages.orders import Feature
from mimics_app.contracts.messages.stage_messages import HapticSnapshot, TaskAction, TaskOrders, VRInput
from mimics_app.contracts.messages.trial_state import TaskView
from mimics_app.contracts.ports.display_port import FrameTiming
from mimics_app.contracts.ports.scenario_port import TaskContext
from mimics_app.inputs.commands.keys import command_of_key
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
from mimics_app.tasks.steering import TASK_COMMANDS
from mimics_app.tasks.task import TaskSpec
from mimics_app.tasks.task_manager import TaskManager
from mimics_app.tasks.task_record import task_of_record

__all__ = [
    "PlayedAgain",
    "RecordedTask",
    "TaskFrame",
    "TaskReplay",
    "play_again",
    "play_loop",
    "play_task",
    "recorded_task",
    "task_frames",
]


@dataclass(frozen=True, slots=True)
class TaskFrame:
    """Inputs of the task manager in one frame; see `TaskManager.step`.

    Commands are None in a recording of before there were any: the keys gave them.
    """

    pressed: tuple[str, ...]
    commands: tuple[Command, ...] | None
    action: TaskAction | None
    snapshot: HapticSnapshot
    events: NDArray[Any]
    now_ns: int
    timing: FrameTiming | None = None
    head: HeadPlace | None = None


@dataclass(frozen=True, slots=True)
class RecordedTask:
    """The task of a recording.

    Attributes:
        spec: The task.
        context: Its context.
        seed: Seed of the session.
        first_trial: First trial, 0 first.
    """

    spec: TaskSpec
    context: TaskContext
    seed: int
    first_trial: int = 0


@dataclass(frozen=True, slots=True)
class PlayedAgain:
    """Output of a task: (kind, data) of each line of the journal, the rows of its attempts, replies to commands."""

    lines: list[tuple[str, dict[str, object]]] = field(default_factory=list)
    rows: list[Row] = field(default_factory=list)
    replies: list[Reply] = field(default_factory=list)


def play_loop(run: Run, data: ReplayData) -> Replayed:
    """Simulate every tick again; the result has the snapshots that the frames read.

    Raises:
        PartialDataError: The static data of the loop are damaged.
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
    """Return the kinematics of the recorded device; runs without its name are of a HapticMaster.

    Raises:
        DeviceError: The plug-in of the device is not installed.
    """
    moved_by = session.get("moved_by")
    name = moved_by.get("kind") or moved_by.get("device") if isinstance(moved_by, dict) else None
    return descriptor_of(str(name or SIMULATED)).kinematics


def play_task(run: Run, snapshots: Mapping[int, HapticSnapshot]) -> tuple[dict[str, int] | None, TaskDifference | None]:
    """Do the task again with the snapshots of the replayed loop, and compare its output.

    Returns:
        Numbers of the compared "events" and "rows", and the first difference. None and None for a recording without the
        inputs of its task, as those of earlier versions.

    Raises:
        PartialDataError: The record of the task or of a frame is missing or damaged.
    """
    if "task" not in run.session:
        return None, None
    task = recorded_task(run)
    journalled = {*TASK_KINDS, *(kind for each in task_kinds() for kind in each.journals)}
    recorded = gather_task(run, journalled)
    again = play_again(task, task_frames(run, recorded.frames, snapshots), recorded.end_ns)
    difference = compare_lines(recorded.lines, [line for line in again.lines if line[0] in journalled])
    difference = difference or _compare_replies(recorded.frames, again.replies)
    difference = difference or compare_rows(recorded.rows, again.rows, whole=recorded.whole)
    return {"events": len(recorded.lines), "rows": min(len(recorded.rows), len(again.rows))}, difference


def recorded_task(run: Run) -> RecordedTask:
    """Return the task of a recording that has one.

    Raises:
        PartialDataError: Its record cannot be used.
    """
    try:
        spec, context = task_of_record(run.session["task"])
    except ValueError as error:
        fix = "install the kinds of task that it was recorded with"
        raise PartialDataError(f"{run.folder}: session.json#/task cannot be used: {error}", fix) from error
    return RecordedTask(spec, context, int(run.session.get("seed", 0)), _first_trial(run.session))


def _compare_replies(frames: Sequence[FrameLine], replayed: Sequence[Reply]) -> TaskDifference | None:
    """Return the first command that became something else; None without one, or without recorded commands."""
    recorded = [(line, Reply(line.done, line.why)) for frame in frames for line in frame.commands]
    for (line, one), other in zip(recorded, replayed, strict=False):
        if one != other:
            return TaskDifference(f"reply to {line.command}", one, other)
    return None


def _first_trial(session: Mapping[str, Any]) -> int:
    """Return the first trial of the session, 0 first."""
    settings = session.get("settings")
    first = settings.get("from_trial", 1) if isinstance(settings, dict) else 1
    return max(0, first - 1) if isinstance(first, int) else 0


class TaskReplay:
    """A recorded task that is done again, frame by frame.

    Args:
        task: The task.
        features: What the scenario that is looked at can show; none where nothing is drawn.

    Attributes:
        again: What it has given so far.
    """

    def __init__(self, task: RecordedTask, features: Iterable[Feature[Any]] = ()) -> None:
        again = self.again = PlayedAgain()
        self._manager = TaskManager(
            task.spec,
            task.context,
            task.seed,
            again.rows.append,
            lambda kind, data: again.lines.append((kind, dict(data))),
            task.first_trial,
            features,
        )
        self._view = TaskView()

    def step(self, frame: TaskFrame) -> TaskOrders:
        """Do the next frame, and return the orders of the task."""
        commands = _commands_of_keys(frame.pressed, self._view) if frame.commands is None else frame.commands
        vr = VRInput(pressed=frame.pressed, commands=commands, head=frame.head)
        orders = self._manager.step(vr, frame.action, frame.snapshot, frame.events, frame.now_ns, frame.timing)
        self.again.replies.extend(orders.replies)
        self._view = orders.view
        return orders

    def end(self, end_ns: int) -> None:
        """End the session, at a time [ns]."""
        self._manager.end_session(end_ns)


def play_again(task: RecordedTask, frames: Iterable[TaskFrame], end_ns: int | None) -> PlayedAgain:
    """Do a task again with its recorded frames.

    Args:
        task: The task.
        frames: All frames in order.
        end_ns: Time at which the session was ended [ns]; None where it was not.
    """
    replay = TaskReplay(task)
    for frame in frames:
        replay.step(frame)
    if end_ns is not None:
        replay.end(end_ns)
    return replay.again


def _commands_of_keys(pressed: Sequence[str], view: TaskView) -> tuple[Command, ...]:
    found = (command_of_key(name, view) for name in pressed)
    return tuple(command for command in found if isinstance(command, TASK_COMMANDS))


def task_frames(run: Run, lines: list[FrameLine], snapshots: Mapping[int, HapticSnapshot]) -> Iterator[TaskFrame]:
    """Yield the inputs of the task in each frame.

    Raises:
        PartialDataError: The tick that a frame saw is missing.
    """
    first, commanded = 0, "commands" in run.session.get("settings", ())
    for line in lines:
        if line.tick not in snapshots:
            raise PartialDataError(f"{run.folder}: frame {line.frame} read tick {line.tick}, which is missing")
        events = run.events[first : first + line.events]
        first += line.events
        commands = tuple(each.given for each in line.commands) if commanded else None
        timing = None if line.shown_ns is None else FrameTiming(line.shown_ns, line.period_ns)
        snapshot = snapshots[line.tick]
        yield TaskFrame(line.pressed, commands, line.chosen, snapshot, events, line.t_ns, timing, line.head)
