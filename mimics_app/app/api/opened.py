"""A scene played from Python: `mimics_app.open(SCENE)`, on the virtual clock, as fast as the machine allows."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import ExitStack
from dataclasses import fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self, get_type_hints

import numpy as np
from numpy.typing import NDArray

from mimics_app.app.api.unit_array import Quantity, Table
from mimics_app.app.play.result import summarise
from mimics_app.app.scenes.scene_search import find_scene
from mimics_app.app.session.assembly import build_session
from mimics_app.app.session.frame import Frames
from mimics_app.app.session.session import Session
from mimics_app.app.settings import RunSettings
from mimics_app.contracts.clock import FRAMES_PER_SECOND, SECOND_NS, MonotonicClock
from mimics_app.contracts.errors import UsageError, nearest
from mimics_app.contracts.loop.haptic import SafetyState
from mimics_app.contracts.loop.loop_fields import LOOP_FIELDS
from mimics_app.contracts.messages.stage_messages import HapticSnapshot
from mimics_app.recording.run_folder import private_files
from mimics_app.world.files.scene.scene import Scene

if TYPE_CHECKING:
    from mimics_app.app.picture.picture import Picture

__all__ = ["Opened", "open"]

_LATCHED = (SafetyState.SAFE_STOP, SafetyState.E_STOP)
_NOT_HERE = {"scene", "headless", "journey", "video", "pictures", "display", "recipe", "size", "quality", "opt"}
"""Settings of a run that have no meaning without a window, or are arguments of methods here."""
_open: list[Path] = []
"""Run folder of the scene that is open in this process; one at a time, since the loop's work is one per process."""

Trial = dict[str, Any]


class Opened:
    """One scene that is being played; a context, which closes the recording.

    Args:
        session: The session, not yet begun to play.
    """

    def __init__(self, session: Session) -> None:
        self._session = session
        self._frames = Frames(session)
        self._listeners: list[Callable[[Trial], None]] = []
        self._told = 0
        self._picture: Picture | None = None
        self._size = (0, 0)
        self._begun_ns = MonotonicClock().now_ns()
        self._result: dict[str, Any] = {}
        _open.append(session.folder)

    @property
    def scene(self) -> Scene:
        """The scene, as it was read and planned."""
        return self._session.scene

    @property
    def run_dir(self) -> Path:
        """Folder of the recording; `mimics_app.load` reads it."""
        return self._session.folder

    @property
    def time_s(self) -> float:
        """Simulated time since the start [s]."""
        return self._session.clock.now_ns() / SECOND_NS

    @property
    def done(self) -> bool:
        """Whether the task has ended, or a stop is latched, which no person is here to reset."""
        seen = self._frames.snapshot
        return self._session.tasks.done or (seen is not None and seen.state in _LATCHED)

    @property
    def state(self) -> Table:
        """Newest state of touch: the fields of the snapshot, each of shape [1] or [1, k], in SI units."""
        seen = self._frames.snapshot or self._session.haptics.snapshot()
        return Table({name: Quantity(values[np.newaxis], unit) for name, values, unit in _fields_of(seen)})

    @property
    def trials(self) -> list[Trial]:
        """Rows of the attempts at trials that have ended so far; columns of trials.csv."""
        return [dict(row) for row in self._session.tasks.rows]

    @property
    def result(self) -> dict[str, Any]:
        """The object of `mimics run --json` after `close`; {} before."""
        return self._result

    def step(self, seconds: float = 1.0 / FRAMES_PER_SECOND) -> None:
        """Play on for a simulated time [s], in whole frames, at least one; less where the task ends before.

        Raises:
            UsageError: `seconds` is not positive, or the scene is closed.
        """
        if not 0.0 < seconds < np.inf:
            raise UsageError(f"cannot play for {seconds} s", "give a positive number of seconds")
        self._session.require_open()
        for _ in range(max(1, round(seconds * FRAMES_PER_SECOND))):
            if self.done:
                return
            self._frames.advance_frame()
            self._tell()

    def run(self) -> dict[str, Any]:
        """Play until the task ends, or the scene's `seconds`; close, and return the result of `mimics run --json`."""
        limit_s = self._session.settings.seconds
        while not self.done and (limit_s is None or self.time_s < limit_s):
            self.step()
        self.close()
        return self._result

    def on_trial(self, listener: Callable[[Trial], None]) -> None:
        """Call a function with the row of each attempt at a trial when it has ended."""
        self._listeners.append(listener)

    def picture(self, width: int = 1280, height: int = 720) -> NDArray[np.uint8]:
        """Draw the scene as it is now, with its board: RGB display values, shape [height, width, 3].

        Raises:
            DeviceError: No OpenGL context is available.
            SceneError: The scene has no camera.
        """
        from mimics_app.rendering.visual.surfaces.headless import read_pixels

        if self._picture is None or self._size != (width, height):
            self._close_picture()
            self._picture, self._size = self._open_picture(width, height), (width, height)
        self._picture.draw(self._frames.board, self._session.clock.now_ns())
        return np.ascontiguousarray(read_pixels(self._picture.surface)[:, :, :3])

    def close(self) -> None:
        """End the session and close the recording; a second call does nothing."""
        if self._result:
            return
        self._close_picture()
        session = self._session
        sound = session.end_stages()
        summary = summarise(session, self._frames, sound, (MonotonicClock().now_ns() - self._begun_ns) * 1e-9)
        manifest = session.finish(summary)
        self._result = {**summary, "state_hash": manifest.state_hash}
        _open.remove(session.folder)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"<{self.scene.name} at {self.time_s:.1f} s, {'closed' if self._result else 'open'}>"

    def _tell(self) -> None:
        rows = self._session.tasks.rows
        for row in rows[self._told :]:
            for listener in self._listeners:
                listener(dict(row))
        self._told = len(rows)

    def _open_picture(self, width: int, height: int) -> Picture:
        from mimics_app.app.picture.picture import Picture, picture_quality
        from mimics_app.rendering.visual.surfaces.headless import open_offscreen

        surface = open_offscreen("auto", (width, height))
        quality = picture_quality(self.scene, self._session.settings.profile)
        return Picture(surface, self.scene, self._session.world, quality, sparse=True)

    def _close_picture(self) -> None:
        if self._picture is not None:
            self._picture.close()
            self._picture = None


def open(scene: Path | str, **settings: object) -> Opened:
    """Open a scene for playing by the simulated person, without a window; every run is recorded.

    Args:
        scene: Scene file, or the name of a shipped scene.
        **settings: Options of `mimics run` by their names: `seed`, `patient`, `physio`, `learn`, `goal`, `profile`,
            `device`, `difficulty`, `trials`, `seconds` [s], `sound` ("file" or "off"), `runs`, `participant` ...

    Returns:
        The scene, at time 0.

    Raises:
        SceneError: The scene is faulty.
        UsageError: A setting is unknown, or another scene is open in this process.
        DeviceError: The device is not available, or is not a simulated one.
    """
    if _open:
        raise UsageError(f"another scene is open in this process ({_open[0]})", "close it first, or use a process each")
    chosen = _settings(find_scene(Path(scene)), settings)
    with ExitStack() as stack:
        stack.enter_context(private_files())
        session = build_session(chosen, live=False)
        if session.live:
            session.__exit__()
            what = f'the device "{chosen.device or "of the scene"}" runs in real time'
            raise UsageError(what, "play it with mimics run, or give device= a simulated one")
        return Opened(session)


def _settings(scene: Path, given: Mapping[str, object]) -> RunSettings:
    """Return the settings of a run.

    Raises:
        UsageError: One is unknown, or of another type.
    """
    known = {field.name for field in fields(RunSettings)} - _NOT_HERE
    for name in given:
        if name not in known:
            raise UsageError(f'there is no setting "{name}"', nearest(name, known))
    paths = {name for name, hint in get_type_hints(RunSettings).items() if "Path" in str(hint)}
    plain: dict[str, Any] = {
        name: Path(str(value)) if name in paths and value is not None else value for name, value in given.items()
    }
    return replace(RunSettings(scene, headless=True, pictures=0, sound="off"), **plain)


def _fields_of(snapshot: HapticSnapshot) -> list[tuple[str, NDArray[Any], str]]:
    """Return name, value and unit of every field of a snapshot."""
    units = {field.name: ", ".join(dict.fromkeys(field.units)) for field in LOOP_FIELDS}
    names = [field.name for field in fields(HapticSnapshot)]
    return [(name, np.array(getattr(snapshot, name)), units.get(name, "1")) for name in names]
