"""Builds a session: processes first, then the haptic loop, then the picture.

Spawned children inherit the niceness of the moment, and a software renderer's workers that of the thread that makes the
GL context; so the order here is what keeps the haptic loop in time.
"""

from __future__ import annotations

from contextlib import ExitStack
from pathlib import Path

from mimics_app.app.session.header import describe_session
from mimics_app.app.session.preparation import Preparation, prepare
from mimics_app.app.session.session import Session
from mimics_app.app.session.sound import open_sound
from mimics_app.app.settings import RunSettings
from mimics_app.app.touch.device_fit import device_values
from mimics_app.contracts.session_memory import SessionMemory
from mimics_app.recording.recorder import Recorder
from mimics_app.recording.run_folder import create_run_folder
from mimics_app.recording.statics import write_statics
from mimics_app.rendering.haptic import scheduler
from mimics_app.world.scene.scene import Scene

__all__ = ["build_session", "start_loop"]


def build_session(settings: RunSettings, *, live: bool, read: Scene | None = None) -> Session:
    """Load the scene, build the loop and the stages, start the recorder and the sound. Nothing moves yet.

    A device with a time of its own makes the session live, whatever was requested.

    What can be wrong with files and devices is found before the first process starts and the run folder is made.

    Args:
        settings: What was asked for.
        live: Whether the haptic loop is to run in real time.
        read: The scene, where it was read before; see `prepare`.

    Raises:
        SceneError: the scene or the action file is wrong.
        DeviceError: the robot cannot be had.
        UsageError: no room for the recording.
    """
    parts = prepare(settings, live=live, read=read)
    with ExitStack() as stack:
        stack.callback(parts.plugin.close)
        parts.parameter_store.fit(device_values(parts.plugin, parts.scene))
        session = _assemble(parts, stack)
        if session.live:  # the virtual clock waits for room in the rings, and begins meanwhile
            session.recorder.wait_until_ready()
        session.trackers.start()
        session.on_close = stack.pop_all()
    session.begin()
    return session


def _assemble(parts: Preparation, stack: ExitStack) -> Session:
    """Start recorder and sound; the stack releases them after a failure."""
    memory = parts.side.memory(parts.plugin)
    folder = create_run_folder(parts.settings.runs, parts.settings.seconds or 0.0)
    recorder = _start_recorder(parts, memory, folder)
    stack.callback(recorder.abandon)
    sound = open_sound(parts, memory, folder)
    stack.callback(sound.stop)
    session = Session(parts, memory, recorder, sound)
    stack.callback(session.haptics.stop)
    return session


def _start_recorder(parts: Preparation, memory: SessionMemory, folder: Path) -> Recorder:
    recorder = Recorder(memory, folder, describe_session(parts))
    write_statics(folder, parts.side.statics)
    recorder.start(wait=False)
    return recorder


def start_loop(session: Session) -> str:
    """Start the live haptic loop and make way for it; the recipe granted, in words."""
    granted = session.haptics.start()
    if granted.lower_main:
        scheduler.lower_this_thread()
    session.recorder.journal("scheduler", {"recipe": granted.recipe})
    return granted.recipe
