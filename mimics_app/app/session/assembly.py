"""Construction of a session: processes first, then the haptic loop, then the picture.

The order keeps the haptic loop in time: child processes inherit the priority of the thread that starts them, and the
workers of a software renderer that of the thread that creates the OpenGL context, and `start_loop` lowers it.
"""

from __future__ import annotations

from contextlib import ExitStack
from pathlib import Path

from mimics_app.app.scenes.fitted_scene import FITTED
from mimics_app.app.session.header import describe_session
from mimics_app.app.session.preparation import Given, SessionParts, prepare
from mimics_app.app.session.session import Session
from mimics_app.app.session.sound import open_sound
from mimics_app.app.settings import RunSettings
from mimics_app.app.touch.device_fit import device_values
from mimics_app.contracts.shared_memory.session_memory import SessionMemory
from mimics_app.recording.recorder import Recorder
from mimics_app.recording.run_folder import create_run_folder
from mimics_app.recording.statics import write_statics
from mimics_app.rendering.haptic import scheduler
from mimics_app.world.files.scene.scene import Scene

__all__ = ["build_session", "start_loop"]


def build_session(
    settings: RunSettings, *, live: bool, read: Scene | None = None, given: Given | None = None
) -> Session:
    """Load the scene, build the loop and the stages, start the recorder and the sound. Nothing moves yet.

    A device that runs in real time makes the session live, even where `live` is False. Faults of files and devices are
    found before the first process starts and the run folder is created.

    Args:
        settings: Settings of the run.
        live: Whether the haptic loop is to run in real time.
        read: The scene, where it was read before; see `prepare`.
        given: Parts that a program gives as objects.

    Raises:
        SceneError: The scene or the action file is faulty.
        DeviceError: The robot is not available.
        OutputError: The disk has no room for the recording.
    """
    parts = prepare(settings, live=live, read=read, given=given)
    with ExitStack() as stack:
        stack.callback(parts.plugin.close)
        parts.parameter_store.fit(device_values(parts.plugin, parts.scene, parts.parameter_store.block))
        session = _assemble(parts, stack)
        if session.live:  # on the virtual clock the loop waits for room in the buffers instead
            session.recorder.wait_until_ready()
            session.recorder.keep_standby()
        session.trackers.start()
        session.on_close = stack.pop_all()
    session.begin()
    _fit(session, parts)
    return session


def _fit(session: Session, parts: SessionParts) -> None:
    """Set the volume that fits the person, and journal all that was fitted, each with its source."""
    for change in parts.scene.document.get(FITTED, ()):
        if change["name"] == "volume":
            session.sound.set_volume(change["value"])
        session.recorder.journal("fitted", {**change, "calibration": parts.fit.source})


def _assemble(parts: SessionParts, stack: ExitStack) -> Session:
    """Start the recorder and the sound; the stack stops them after a failure."""
    memory = parts.side.memory(parts.plugin)
    folder = create_run_folder(parts.settings.runs, parts.settings.seconds or 0.0)
    recorder = _start_recorder(parts, memory, folder)
    stack.callback(recorder.abandon)
    sound = open_sound(parts.scene, parts.settings.sound, memory, folder, live=parts.live)
    stack.callback(sound.stop)
    session = Session(parts, memory, recorder, sound)
    stack.callback(session.haptics.stop)
    return session


def _start_recorder(parts: SessionParts, memory: SessionMemory, folder: Path) -> Recorder:
    recorder = Recorder(memory, folder, describe_session(parts))
    write_statics(folder, parts.side.statics)
    recorder.start(wait=False)
    return recorder


def start_loop(session: Session) -> str:
    """Start the live haptic loop, lower the priority of this thread, and return the scheduling that was granted."""
    granted = session.haptics.start()
    if granted.lower_main:
        scheduler.lower_this_thread()
    session.recorder.journal("scheduler", {"recipe": granted.recipe})
    return granted.recipe
