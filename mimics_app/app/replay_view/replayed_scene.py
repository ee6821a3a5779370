"""The world of a recorded run at any of its frames: computed again from the recorded inputs."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import msgspec
import numpy as np
from numpy.typing import NDArray

from mimics_app.app.picture.loop_cards import loop_cards
from mimics_app.app.planner.plan import apply_plan
from mimics_app.app.scenes.loading import load_checked_scene
from mimics_app.app.scenes.person_edit import PersonEdit, edit_of_plain
from mimics_app.app.scenes.scenario_choice import features_of, open_scenario
from mimics_app.app.session.replay import RecordedTask, TaskFrame, TaskReplay, play_loop, recorded_task, task_frames
from mimics_app.app.session.trackers import replayed_hub
from mimics_app.app.session.visible_scene import VisibleScene
from mimics_app.app.settings import PROFILES, Profile
from mimics_app.contracts.arrays import F8, Records
from mimics_app.contracts.clock import MonotonicClock, VirtualClock
from mimics_app.contracts.errors import PartialDataError, counted
from mimics_app.contracts.messages.board import Board
from mimics_app.contracts.messages.stage_messages import TaskOrders
from mimics_app.contracts.ports.display_port import FrameTiming
from mimics_app.inputs.trackers.hub import TrackerHub
from mimics_app.recording.replay import compare, gather
from mimics_app.recording.report_values import mapping
from mimics_app.recording.run import Run
from mimics_app.recording.task_lines import gather_task
from mimics_app.world.content.world import World
from mimics_app.world.files.scene.file import build_world
from mimics_app.world.files.scene.scene import Scene

__all__ = ["ReplayedScene", "open_replay"]


@dataclass(frozen=True, slots=True, eq=False)
class _Recorded:
    """What does not change while a run is looked at: see `ReplayedScene`."""

    run: Run
    task: RecordedTask
    frames: Sequence[TaskFrame]
    forces: Records
    scene: Scene
    notes: tuple[str, ...]


class ReplayedScene:
    """A recorded run whose world can be brought to any frame.

    Frames are done in order, as the session did them: task, scenario, models and effects have state of their own, which
    a kept copy of the poses would not hold. An earlier frame is therefore computed from the first frame on, in a new
    world.

    Attributes:
        run: The recording.
        scene: Its scene.
        forces: CONTACT_FORCE records of the contacts that the sound follows, shape [n], in order; tick 0 is at time 0.
        times_ns: Session time of each frame, from that of the first on [ns], int64 [n].
        notes: What differs from the session, one sentence each.
        world: The world, as after the newest frame.
        number: Number of frames done, at least 1.
        board: The board of the newest frame.
        begun_ns: Session time of the first frame [ns].
        listener: Called with each frame that is done, its orders and the world; None: nobody listens.
    """

    world: World
    listener: Callable[[TaskFrame, TaskOrders, World], None] | None = None

    def __init__(self, recorded: _Recorded) -> None:
        self.run, self.scene, self.notes = recorded.run, recorded.scene, recorded.notes
        self._task, self._frames, self.forces = recorded.task, recorded.frames, recorded.forces
        times = np.array([frame.now_ns for frame in self._frames], np.int64)
        self.begun_ns = int(times[0])
        self.times_ns: NDArray[np.int64] = times - times[0]
        self._restart()

    @property
    def count(self) -> int:
        """Number of frames of the run."""
        return len(self._frames)

    @property
    def profile(self) -> Profile:
        """Profile of the session."""
        return _profile_of(self.run)

    @property
    def now_ns(self) -> int:
        """Session time of the newest frame, from that of the first on [ns]."""
        return int(self.times_ns[self.number - 1])

    @property
    def hand(self) -> F8:
        """Position of the hand in the newest frame, world [m], float64 [3]."""
        return self._frames[self.number - 1].snapshot.hip_world

    def number_at(self, time_ns: float) -> int:
        """Return the number of frames done at a time from the first frame on [ns], 1 to `count`."""
        return min(max(1, int(np.searchsorted(self.times_ns, time_ns, side="right"))), self.count)

    def recent(self, span_ns: int) -> Iterator[TaskFrame]:
        """Yield the newest frame, and before it those with events of the loop in a time before it [ns], in order."""
        newest = self._frames[self.number - 1]
        first = int(np.searchsorted(self.times_ns, self.now_ns - span_ns))
        yield from (frame for frame in self._frames[first : self.number - 1] if len(frame.events))
        yield newest

    def to(self, number: int, limit_ns: int = 1 << 62) -> bool:
        """Bring the world to where `number` frames are done, and return whether it is there.

        Args:
            number: Number of frames, 1 to `count`.
            limit_ns: Time after which the call returns, to be called again [ns].
        """
        clock = MonotonicClock()
        until = clock.now_ns() + limit_ns
        if number < self.number:
            self._restart()
        while self.number < number and clock.now_ns() < until:
            self._step()
        return self.number == number

    def _restart(self) -> None:
        """Begin again in a new world, and do the first frame."""
        self.world = build_world(self.scene)
        self.world.effects.seed = self._task.seed
        self._scenario = open_scenario(self.scene, self.world)
        self._clock = VirtualClock()
        self._hub = _trackers_of(self.run, self.scene, self._clock, self._task.seed)[0]
        self._visible, self._replay = (
            VisibleScene(self.scene, self.world),
            TaskReplay(self._task, features_of(self.scene)),
        )
        self.number = 0
        self.board = Board()
        self._step()

    def _step(self) -> None:
        """Do the next frame as `Frames.step` did it."""
        frame = self._frames[self.number]
        now_ns = frame.now_ns
        shown_ns = (frame.timing or FrameTiming.expected(now_ns)).display_ns
        orders = self._replay.step(frame)
        self._clock.sleep_until_ns(now_ns)
        self._hub.poll(now_ns)
        self._visible.play(self._scenario, self._part_of_body, orders, frame.snapshot, shown_ns)
        self._visible.update(orders, frame.events, now_ns)
        self._visible.light(orders, frame.events, shown_ns)
        if self.listener is not None:
            self.listener(frame, orders, self.world)
        self.number += 1
        self.board = orders.board.with_cards(loop_cards(frame.snapshot))

    def _part_of_body(self, role: str, at_ns: int) -> F8 | None:
        found = self._hub.pose(role, at_ns)
        return None if found is None else found.pose


def open_replay(run: Run, scene: Path | None = None) -> ReplayedScene:
    """Read the scene of a recording, and compute its haptic loop again.

    Args:
        run: The recording.
        scene: Scene file; None: as the recording names it.

    Raises:
        SceneError: The scene is not there any more, or faulty.
        PartialDataError: Ticks, parameters or frames are missing, or it has no inputs of its task.
    """
    if "task" not in run.session:
        raise PartialDataError(f"{run.folder} does not hold the inputs of its task", "it is too old to be looked at")
    task = recorded_task(run)
    checked = load_checked_scene(scene or _file_of(run), edit=_edit_of(run))
    apply_plan(checked, _profile_of(run))
    data = gather(run)
    replayed = play_loop(run, data)
    lines = gather_task(run).frames
    if not lines:
        raise PartialDataError(f"{run.folder} has no frame", "there is nothing to look at")
    frames = list(task_frames(run, lines, replayed.snapshots))
    difference = compare(data.samples, replayed.samples, run.layout.uncompared)
    notes = [] if difference is None else [f"the touch differs from the recording: {difference}"]
    notes += _notes_on(run, checked, task.seed)
    return ReplayedScene(_Recorded(run, task, frames, replayed.forces, checked, tuple(notes)))


def _edit_of(run: Run) -> PersonEdit | None:
    """Return the change of the scene for the person who played; None: none.

    Raises:
        PartialDataError: It is damaged.
    """
    try:
        edit = edit_of_plain(mapping(run.session.get("edit")))
    except msgspec.ValidationError as error:
        raise PartialDataError(f"{run.folder}: the change of its scene is damaged", str(error)) from error
    if edit is not None and edit.avatar and not Path(edit.avatar).is_file():
        return msgspec.structs.replace(edit, avatar="")  # the scene's own body does the same, and a note says so
    return edit


def _file_of(run: Run) -> Path:
    """Return the scene file of a recording; where it is not there, the name of the scene."""
    recorded = run.session.get("scene")
    recorded = recorded if isinstance(recorded, dict) else {}
    file = Path(str(recorded.get("file", "")))
    return file if file.is_file() else Path(str(recorded.get("name") or file))


def _profile_of(run: Run) -> Profile:
    """Return the profile of a recording; of one without, the usual one."""
    return next((profile for profile in PROFILES if profile == run.session.get("profile")), "training")


def _notes_on(run: Run, scene: Scene, seed: int) -> list[str]:
    """Return what a replay shows otherwise than the session did."""
    recorded = run.session.get("scene")
    notes = []
    avatar = mapping(run.session.get("edit")).get("avatar")
    if avatar and not Path(str(avatar)).is_file():
        notes.append(f"the participant's own body, {avatar}, is not there any more: the scene's is shown")
    if isinstance(recorded, dict) and recorded.get("hash") != scene.hash:
        notes.append("the files of the scene were changed since: it is shown as it is now")
    reloads = sum(bool(line.get("taken")) for line in run.lines_of("app", "reload"))
    if reloads:
        notes.append(f"the scene was reloaded {counted(reloads, 'times')} in the session: it is shown as it is now")
    if not run.session.get("live"):
        return notes
    silent = _trackers_of(run, scene, VirtualClock(), seed)[1]
    return [*notes, *(f"what the tracker {name} reported was not recorded, and is not shown" for name in silent)]


def _trackers_of(run: Run, scene: Scene, clock: VirtualClock, seed: int) -> tuple[TrackerHub, list[str]]:
    hub, left_out = replayed_hub(scene, clock, seed, run.folder)
    hub.start()
    return hub, left_out
