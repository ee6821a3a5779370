"""Sound of a scene as a wave file: the scene is played on the virtual clock, without recorder and picture."""

from __future__ import annotations

from pathlib import Path

from mimics_app.app.session.core import open_core
from mimics_app.app.session.frame import Frames
from mimics_app.app.session.preparation import prepare
from mimics_app.app.session.sound import open_sound
from mimics_app.app.settings import RunSettings
from mimics_app.contracts.clock import FRAMES_PER_SECOND
from mimics_app.contracts.errors import Issue, OutputError, SceneError
from mimics_app.contracts.ports.audio_port import AudioReport
from mimics_app.world.files.scene.scene import Scene

__all__ = ["write_sound"]


def write_sound(settings: RunSettings, file: Path, seconds: float, read: Scene | None = None) -> AudioReport:
    """Play a scene and write its sound from the beginning on; the bytes are reproducible.

    Args:
        settings: Scene, seed and profile; the rest is not used.
        file: Wave file.
        seconds: Time for which the simulated patient plays, from the frame in which it may act in the first trial [s].
        read: The scene, where it was read before; see `prepare`.

    Raises:
        SceneError: The scene is faulty, or has no sound.
        OutputError: The file cannot be written.
    """
    _check_place(file)
    parts = prepare(settings, live=False, read=read)
    with open_core(parts) as core:
        core.sound = open_sound(parts.scene, settings.sound, core.memory, file.parent, file, live=False)
        frames = Frames(core)
        frames.play_to_start()
        for _ in range(round(seconds * FRAMES_PER_SECOND)):
            frames.advance_frame()
        report = core.sound.stop()
    if report is None:
        raise SceneError(Issue(str(parts.scene.path), "", "no entity has a sound", "add a `sound` component"))
    if not report.file:
        raise OutputError(file, report.status.notice)
    return report


def _check_place(file: Path) -> None:
    """Check before the play that the file can be written; none is left behind."""
    is_new = not file.exists()
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        with file.open("ab"):
            pass
        if is_new:
            file.unlink()
    except OSError as error:
        raise OutputError(file, f"cannot be written: {error.strerror}", "name another file") from error
