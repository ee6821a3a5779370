"""A scene played from Python: `mimics_app.open(SCENE)`, on the virtual clock as fast as the machine allows, or live."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack
from dataclasses import fields, replace
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, Self, get_args, get_origin, get_type_hints

import msgspec
import numpy as np
from numpy.typing import NDArray

from mimics_app.app.api.tables import haptic_table, journal_table
from mimics_app.app.api.unit_array import Quantity, Table
from mimics_app.app.play.result import summarise, summarise_play
from mimics_app.app.scenes.loading import check_scene
from mimics_app.app.scenes.scene_search import find_scene
from mimics_app.app.session.assembly import build_session, start_loop
from mimics_app.app.session.core import SessionCore, open_core
from mimics_app.app.session.frame import Frames
from mimics_app.app.session.memory_recorder import MemoryRecorder
from mimics_app.app.session.preparation import Given, prepare
from mimics_app.app.session.requested import read_requested
from mimics_app.app.session.session import Session
from mimics_app.app.session.switched_off import NullRecorder
from mimics_app.app.settings import RunSettings
from mimics_app.app.terminal.output import say
from mimics_app.contracts.clock import FRAMES_PER_SECOND, SECOND_NS, MonotonicClock
from mimics_app.contracts.commands.command_records import CommandSource
from mimics_app.contracts.commands.vocabulary import Command, Reset, SetParameter
from mimics_app.contracts.errors import UsageError, nearest
from mimics_app.contracts.loop.haptic import SafetyState
from mimics_app.contracts.loop.loop_fields import FURTHER, LOOP_FIELDS, Extent, HapticSnapshot, PointSnapshot
from mimics_app.contracts.messages.board import Board
from mimics_app.contracts.messages.stage_messages import TaskOrders
from mimics_app.contracts.shared_memory.command_ring import Answer, CommandSender
from mimics_app.recording.run_folder import private_files
from mimics_app.rendering.visual.figures.contrast import use_high_contrast
from mimics_app.world.content.world import World
from mimics_app.world.files.scene.edits import SceneEdits
from mimics_app.world.files.scene.scene import Scene, SceneEntity

if TYPE_CHECKING:
    from mimics_app.app.picture.picture import Picture
    from mimics_app.app.play.pace import LiveFrames

__all__ = ["Opened", "Record", "Sent", "open"]

Record = bool | Literal["memory"]
"""Where a session is recorded: in a run folder, not at all, or in memory."""

_LATCHED = (SafetyState.SAFE_STOP, SafetyState.E_STOP)
_NOT_HERE = {"scene", "headless", "journey", "video", "pictures", "recipe"}
"""Settings of a run that are arguments of methods here, or have no meaning."""
_OF_WINDOW = {"display", "size", "quality"}
_AS_OBJECTS = {"learn": "policy", "device": "device"}
"""Settings that may be objects instead of names, and what `Given` calls them."""
_MIXED_S = 60.0
"""Time of sound that is kept for `sound` [s]."""
_open: list[Path] = []
"""Scene that is open in this process; one at a time, since the loop's work is one per process."""

Trial = dict[str, Any]


class Sent:
    """A command that was given.

    Attributes:
        command: The command.
        answer: What became of it, with frame and tick; None until the next frame.
    """

    def __init__(self, command: Command) -> None:
        self.command = command
        self.answer: Answer | None = None

    @property
    def done(self) -> bool:
        """Whether it was carried out."""
        return self.answer is not None and self.answer.done

    @property
    def why(self) -> str:
        """Why it was refused, or a remark; "" for none."""
        return "" if self.answer is None else self.answer.why

    def __repr__(self) -> str:
        became = "waits" if self.answer is None else "done" if self.done else "refused"
        return f"<{self.command}: {became}{f', {self.why}' if self.why else ''}>"


class Opened:
    """One scene that is played; a context, which closes the recording.

    The session begins with the first step, picture or command: until then `scene` may be edited.

    Args:
        scene: The scene as it was read.
        settings: Settings of the run.
        given: Policy and device given as objects.
        window: Whether a person plays at a window, in real time.
        record: Whether, and where, it is recorded.

    Attributes:
        scene: Entities and components of the scene file.
    """

    def __init__(self, scene: Scene, settings: RunSettings, given: Given, *, window: bool, record: Record) -> None:
        self.scene = scene
        self._edits, self._settings, self._given = SceneEdits(scene), settings, given
        self._window, self._record = window, record
        self._session: SessionCore | None = None
        self._listeners: list[Callable[[Trial], None]] = []
        self._notices: list[str] = []
        self._reported, self._reset_at = 0, -1
        self._picture: Picture | None = None
        self._size = (0, 0)
        self._result: dict[str, Any] = {}
        self._waiting: dict[int, Sent] = {}
        self._mixed: deque[NDArray[np.float32]] = deque()
        self._live: LiveFrames | None = None
        self._closed = False
        _open.append(settings.scene)

    @property
    def run_dir(self) -> Path:
        """Folder of the recording; `mimics_app.load` reads it.

        Raises:
            UsageError: The scene was opened with `record=False` or `record="memory"`.
        """
        session = self._begun
        if not isinstance(session, Session):
            raise UsageError("this session has no run folder", f"leave out record={self._record!r}")
        return session.folder

    @property
    def time_s(self) -> float:
        """Time since the start [s]: simulated, in a window real."""
        return (self._begun.clock.now_ns() - self._start_ns) / SECOND_NS

    @property
    def done(self) -> bool:
        """Whether the session is over: its task, a command, the person, or a stop that no person is here to reset."""
        session = self._begun
        if self._live is not None:
            return self._live.over
        seen = self._frames.snapshot
        resets = session.timed_commands.waiting or self._frames.number == self._reset_at
        stopped = seen is not None and seen.state in _LATCHED and not resets
        return session.tasks.done or self._frames.desk.ended or stopped

    @property
    def state(self) -> Table:
        """Newest state of touch: the fields of the snapshot, each of shape [1] or [1, k], in SI units.

        Points of contact after the first are in fields as "point_1_hip_world".
        """
        session = self._begun
        seen = self._frames.snapshot or session.haptics.snapshot()
        return Table(_StateFields(seen, session.memory.capacities.extent))

    @property
    def haptic(self) -> Table:
        """Every tick so far, a row each millisecond: the columns of `Recording.haptic`, SI units.

        Raises:
            UsageError: The scene was opened without `record="memory"`.
        """
        rows = self._kept.rows
        extent = self._begun.memory.capacities.extent
        return haptic_table(extent, lambda chosen: rows[:, list(chosen)])

    @property
    def events(self) -> Table:
        """Lines of the journal so far, those of `Recording.events`: commands, states of trials, contacts, stops ...

        Raises:
            UsageError: The scene was opened without `record="memory"`.
        """
        return journal_table(self._kept.lines, self._start_ns)

    @property
    def world(self) -> World:
        """What moves: `world.find(ENTITY).world_matrix()` is the pose [4, 4] of an entity in the newest frame [m].

        `world.motion.happened` are the steps of its walkers in that frame. What a program adds to the world is seen,
        and neither felt nor recorded.
        """
        return self._begun.world

    @property
    def orders(self) -> TaskOrders:
        """What the task ordered of touch, picture, sound and vibrators in the newest frame, and its state, `view`."""
        return self._played.orders

    @property
    def board(self) -> Board:
        """Figures and the message over the picture in the newest frame."""
        return self._played.board

    @property
    def task(self) -> dict[str, Any]:
        """Result of the task so far: `task` in the object of `mimics run --json`."""
        return self._begun.tasks.result()

    @property
    def parameters(self) -> dict[str, float]:
        """Present values of the task's adaptable parameters."""
        return dict(self._begun.tasks.values)

    @property
    def trials(self) -> list[Trial]:
        """Rows of the attempts at trials that have ended so far; columns of trials.csv."""
        return [] if self._session is None else [dict(row) for row in self._session.tasks.rows]

    @property
    def notices(self) -> list[str]:
        """What the session said so far of devices, signals and stops, oldest first."""
        return list(self._notices)

    @property
    def result(self) -> dict[str, Any]:
        """The object of `mimics run --json` after `close`, {} before; unrecorded without what a recording has."""
        return self._result

    def step(self, seconds: float = 1.0 / FRAMES_PER_SECOND) -> None:
        """Play on for a time [s], in whole frames, at least one; less where the session ends before.

        Raises:
            UsageError: `seconds` is not positive, or the scene is closed.
        """
        if not 0.0 < seconds < np.inf:
            raise UsageError(f"cannot play for {seconds} s", "give a positive number of seconds")
        session = self._begun
        session.require_open()
        if self._live is not None:
            until = session.clock.now_ns() + round(seconds * SECOND_NS)
            self._live.run(self._frames, lambda _: self._tell(), lambda: session.clock.now_ns() >= until)
            return
        for _ in range(max(1, round(seconds * FRAMES_PER_SECOND))):
            if self._is_over():
                return
            self._frames.advance_frame()
            self._tell()

    def step_until(self, condition: Callable[[Opened], bool], seconds: float = 60.0) -> bool:
        """Play on, frame by frame, until `condition(session)` is true; return whether it is.

        Args:
            condition: Asked before each frame and after the last one.
            seconds: Longest time to play [s].

        Raises:
            UsageError: The scene is closed.
        """
        session = self._begun
        session.require_open()
        until = session.clock.now_ns() + round(seconds * SECOND_NS)
        if self._live is not None:
            self._live.run(
                self._frames, lambda _: self._tell(), lambda: condition(self) or session.clock.now_ns() >= until
            )
            return condition(self)
        while not (found := condition(self)) and session.clock.now_ns() < until and not self._is_over():
            self.step()
        return found

    def run(self) -> dict[str, Any]:
        """Play until the session is over, or for its `seconds`; close, and return the result of `mimics run --json`."""
        limit_s = self._settings.seconds
        while not self._is_over() and (limit_s is None or self.time_s < limit_s):
            self.step(1.0 if self._live is not None else 1.0 / FRAMES_PER_SECOND)
        self.close()
        return self._result

    def command(self, command: Command) -> Sent:
        """Give a command: it takes effect with the next frame, a `Stop` within two ticks.

        Returns:
            The command, and its answer after the next frame. What is refused raises nothing.

        Raises:
            UsageError: A value is outside what the command takes, or 64 commands wait for the next frame.
        """
        session = self._begun
        session.require_open()
        sent = Sent(command)
        self._waiting[self._sender.send(command, session.clock.now_ns())] = sent
        return sent

    def set(self, **values: float) -> list[Sent]:
        """Set adaptable parameters of the task by name, within the limits that a policy has.

        A trial's own value in the list of trials holds for that trial: the answer is a refusal where every trial to
        come has one, and says how many where some have.
        """
        return [self.command(SetParameter(name, float(value))) for name, value in values.items()]

    def edit(self, component: str, entity: str = "", **values: object) -> None:
        """Give fields of a component, or of the task, other values before the first step, as if the scene file did.

        Args:
            component: Name of its type, as "tunnel" or "patient"; "task" for the scene's task.
            entity: Id of its entity; "": the only one that has such a component.
            **values: Values by field, as the file would have them. They are checked as the session begins.

        Raises:
            UsageError: The session has begun, or the component is unknown, or the entity or field.
        """
        if self._session is not None or self._closed:
            raise UsageError("the session has begun", "edit the scene before the first step")
        of_scene = component in self.scene.sections and not entity
        parts = self.scene.sections if of_scene else self._owner(component, entity).components
        known = parts[component].__struct_fields__
        for name in values:
            if name not in known:
                raise UsageError(f'{component} has no field "{name}"', nearest(name, known))
        parts[component] = msgspec.structs.replace(parts[component], **values)

    def on_trial(self, listener: Callable[[Trial], None]) -> None:
        """Call a function with the row of each attempt at a trial when it has ended."""
        self._listeners.append(listener)

    def picture(self, width: int = 1280, height: int = 720, *, board: bool = True) -> NDArray[np.uint8]:
        """Draw the scene as it is now, with its board unless that is off: RGB values, shape [height, width, 3].

        Raises:
            DeviceError: No OpenGL context is available.
            SceneError: The scene has no camera.
        """
        from mimics_app.rendering.visual.surfaces.headless import read_pixels

        session = self._begun
        session.require_open()
        if self._picture is None or self._size != (width, height):
            self._close_picture()
            self._picture, self._size = self._open_picture(width, height), (width, height)
        if session.view:
            self._picture.show_view(session.view)
        self._picture.draw(self._frames.board if board else Board(), session.clock.now_ns())
        return np.ascontiguousarray(read_pixels(self._picture.surface)[:, :, :3])

    def sound(self) -> NDArray[np.float32]:
        """Return what was mixed since the last call, the last minute at most: 48 kHz, shape [samples, channels].

        Raises:
            UsageError: The scene is silent, its sound is off, or it plays in a window.
        """
        if not self._hears:
            raise UsageError("there is no sound to return", 'open the scene with sound="auto", without a window')
        blocks = list(self._mixed)
        self._mixed.clear()
        return np.concatenate(blocks) if blocks else np.zeros((0, 2), np.float32)

    def close(self) -> None:
        """End the session and close the recording; a second call does nothing."""
        if self._closed:
            return
        self._closed = True
        try:
            self._end()
        finally:
            _open.remove(self._settings.scene)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __repr__(self) -> str:
        state = "closed" if self._closed else "not begun" if self._session is None else f"at {self.time_s:.1f} s"
        return f"<{self.scene.name}, {state}>"

    @property
    def _kept(self) -> MemoryRecorder:
        recorder = self._begun.recorder
        if not isinstance(recorder, MemoryRecorder):
            raise UsageError(
                "this session is not kept in memory", 'write record="memory", or load its run folder after its end'
            )
        return recorder

    @property
    def _played(self) -> Frames:
        """Frames of the session, which begins now if it has not."""
        _ = self._begun
        return self._frames

    def _owner(self, component: str, entity: str) -> SceneEntity:
        """Return the entity whose component is edited."""
        found = [each for each in self.scene.entities if component in each.components and entity in ("", each.id)]
        if not found:
            names = sorted({name for each in self.scene.entities for name in each.components})
            of = f'the entity "{entity}"' if entity else "this scene"
            raise UsageError(f'{of} has no component "{component}"', nearest(component, names))
        if len(found) > 1:
            raise UsageError(
                f'{len(found)} entities have a component "{component}"',
                f"name one of {', '.join(each.id for each in found)}",
            )
        return found[0]

    @property
    def _begun(self) -> SessionCore:
        """The session, which begins now if it has not."""
        if self._session is None:
            if self._closed:
                raise UsageError("session is closed", "open another one")
            self._session = self._begin()
        return self._session

    def _begin(self) -> SessionCore:
        self._edits.apply()
        self._begun_ns = MonotonicClock().now_ns()
        with ExitStack() as stack:
            stack.enter_context(private_files())
            if self._settings.steer:
                raise UsageError("a program gives its commands itself", "leave out steer")
            use_high_contrast(self._settings.high_contrast)
            session = self._build()
            stack.callback(session.__exit__)
            if session.live and not self._window:
                raise UsageError("the device runs in real time", "open the scene with window=True")
            session.report = self._note
            self._frames = Frames(session)
            self._sender = CommandSender(session.memory, CommandSource.PYTHON, "python")
            self._hears = self._listen(session)
            if self._window and isinstance(session, Session):
                self._live = _open_window(session)
            self._start_ns = session.clock.now_ns()
            stack.pop_all()
        return session

    def _build(self) -> SessionCore:
        if self._record is True:
            return build_session(self._settings, live=self._window, read=self.scene, given=self._given)
        parts = prepare(self._settings, live=False, read=self.scene, given=self._given)
        return open_core(parts, MemoryRecorder if self._record == "memory" else NullRecorder)

    def _end(self) -> None:
        session = self._session
        if session is None:
            return
        self._close_picture()
        if self._live is not None:
            self._live.end()
        wall_s = (MonotonicClock().now_ns() - self._begun_ns) * 1e-9
        if not isinstance(session, Session):
            session.stop()
            self._result = summarise_play(session, self._frames, wall_s)
            return
        sound = session.end_stages()
        summary = summarise(session, self._frames, sound, wall_s)
        manifest = session.finish(summary)
        self._result = {**summary, "state_hash": manifest.state_hash}

    def _note(self, text: str) -> None:
        self._notices.append(text)
        say(text)

    def _is_over(self) -> bool:
        """Whether the session is over: a stop may still be left by a command that waits."""
        return self.done and not self._waiting

    def _tell(self) -> None:
        for answer in self._sender.answers():
            sent = self._waiting.pop(answer.sequence)
            sent.answer = answer
            if answer.done and isinstance(sent.command, Reset):
                self._reset_at = self._frames.number
        rows = self._begun.tasks.rows
        for row in rows[self._reported :]:
            for listener in self._listeners:
                listener(dict(row))
        self._reported = len(rows)

    def _listen(self, session: SessionCore) -> bool:
        """Keep what is mixed from now on; return whether anything is."""
        if session.live or self._settings.sound == "off":
            return False
        from mimics_app.app.cues.sound_stage import SoundStage
        from mimics_app.rendering.audio.offline import OfflineAudio

        output = session.sound.output if isinstance(session.sound, SoundStage) else None
        if not isinstance(output, OfflineAudio) or output.ready is None or not output.ready.rate:
            return False
        most = round(_MIXED_S * output.ready.rate)

        def keep(block: NDArray[np.float32]) -> None:
            self._mixed.append(block.copy())
            while sum(map(len, self._mixed)) > most:
                self._mixed.popleft()

        output.listener = keep
        return True

    def _open_picture(self, width: int, height: int) -> Picture:
        from mimics_app.app.picture.picture import Picture, picture_quality
        from mimics_app.rendering.visual.surfaces.headless import open_offscreen

        surface = open_offscreen("auto", (width, height))
        quality = picture_quality(self.scene, self._settings.profile)
        return Picture(surface, self.scene, self._begun.world, quality, sparse=True)

    def _close_picture(self) -> None:
        if self._picture is not None:
            self._picture.close()
            self._picture = None


def _open_window(session: Session) -> LiveFrames:
    from mimics_app.app.play.pace import LiveFrames
    from mimics_app.app.play.play import open_live_window

    start_loop(session)
    open_live_window(session)
    return LiveFrames(session)


def open(scene: Path | str, *, window: bool = False, record: Record = True, **settings: object) -> Opened:
    """Open a scene for playing.

    Args:
        scene: Scene file, or the name of a shipped scene.
        window: True: a person plays at a window in real time; else the simulated person, as fast as possible.
        record: False: without a run folder, sound and processes of its own, which is the quickest to begin and end;
            "memory": likewise, with `haptic` and `events` kept in memory, 40 MB a minute.
        **settings: Options of `mimics run` by their names: `seed`, `patient`, `physio`, `learn`, `goal`, `profile`,
            `device`, `difficulty`, `trials`, `seconds` [s], `sound` ("auto", "file" or "off"), `commands`, `runs` ...
            `learn` may be a policy itself, an object as `mimics_app.learning.policy.Policy`, and `device` a function
            of a `DeviceRequest` that makes a `DevicePlugin` of the shape that the scene is made for.

    Returns:
        The scene, at time 0; its `scene` may be edited before the first step.

    Raises:
        SceneError: The scene is faulty.
        UsageError: A setting is unknown, or needs a recording; or another scene is open in this process.
        DeviceError: The device is not available.
    """
    if _open:
        raise UsageError(f"another scene is open in this process ({_open[0]})", "close it first, or use a process each")
    if not (isinstance(record, bool) or record == "memory"):
        raise UsageError(f"record: there is no {record!r}", 'known: True, False, "memory"')
    objects = {name for name in _AS_OBJECTS if settings.get(name) is not None and not isinstance(settings[name], str)}
    given = Given(**{_AS_OBJECTS[name]: settings[name] for name in objects})  # type: ignore[arg-type]
    named = {name: value for name, value in settings.items() if name not in objects}
    chosen = _settings(find_scene(Path(scene)), named, window=window)
    if record is not True and (window or chosen.sound != "off"):
        raise UsageError("a window and sound need a recorded session", f"leave out record={record!r}")
    if chosen.device:
        from mimics_app.rendering.haptic.devices.device_names import check_device_name

        check_device_name(chosen.device)
    return Opened(check_scene(read_requested(chosen)), chosen, given, window=window, record=record)


def _settings(scene: Path, given: Mapping[str, object], *, window: bool) -> RunSettings:
    """Return the settings of a run.

    Raises:
        UsageError: One is unknown, or is none of the words that it takes.
    """
    known = {field.name for field in fields(RunSettings)} - _NOT_HERE - (set() if window else _OF_WINDOW)
    for name in given:
        if name not in known:
            raise UsageError(f'there is no setting "{name}"', nearest(name, known))
    hints = get_type_hints(RunSettings)
    for name in given:
        words = get_args(hints[name])
        if get_origin(hints[name]) is Literal and given[name] not in words:
            raise UsageError(f'{name}: there is no "{given[name]}"', nearest(str(given[name]), words))
    paths = {name for name, hint in hints.items() if "Path" in str(hint)}
    plain: dict[str, Any] = {
        name: Path(str(value)) if name in paths and value is not None else value for name, value in given.items()
    }
    return replace(RunSettings(scene, headless=not window, pictures=0, sound="auto" if window else "off"), **plain)


@cache
def _fields_of(extent: Extent) -> list[tuple[str, int | None, str, str]]:
    """Return name, further point of contact (None: none), field and unit of all that a device's snapshot has."""
    units = {field.name: ", ".join(dict.fromkeys(field.present(extent) or field.units)) for field in LOOP_FIELDS}
    found: list[tuple[str, int | None, str]] = [
        (field.name, None, field.name) for field in fields(HapticSnapshot) if field.name != FURTHER
    ]
    for number in range(extent.contacts - 1):
        found += [(f"point_{number + 1}_{field.name}", number, field.name) for field in fields(PointSnapshot)]
    return [(name, point, field, units.get(field, "1")) for name, point, field in found]


class _StateFields(Mapping[str, Quantity]):
    """Fields of a snapshot by name, each made an array when it is asked for.

    Args:
        snapshot: The snapshot.
        extent: What the device fills.
    """

    def __init__(self, snapshot: HapticSnapshot, extent: Extent) -> None:
        self._snapshot = snapshot
        self._places = {name: (point, field, unit) for name, point, field, unit in _fields_of(extent)}

    def __getitem__(self, name: str) -> Quantity:
        point, field, unit = self._places[name]
        owner = self._snapshot if point is None else self._snapshot.further[point]
        return Quantity(np.array(getattr(owner, field))[np.newaxis], unit)

    def __contains__(self, name: object) -> bool:
        return name in self._places

    def __iter__(self) -> Iterator[str]:
        return iter(self._places)

    def __len__(self) -> int:
        return len(self._places)
