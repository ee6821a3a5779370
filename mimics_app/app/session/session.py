"""Everything one run owns, and the order in which it ends."""

from __future__ import annotations

from contextlib import ExitStack
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any

from mimics_app.app.session.core import SessionCore
from mimics_app.app.session.preparation import Preparation
from mimics_app.app.session.switched_off import SoundPort
from mimics_app.app.settings import RunSettings
from mimics_app.app.terminal.output import say
from mimics_app.contracts.audio_port import AudioReport
from mimics_app.contracts.session_memory import SessionMemory
from mimics_app.recording.manifest import Manifest
from mimics_app.recording.recorder import Recorder

if TYPE_CHECKING:  # a session that draws nothing loads nothing of a picture
    from mimics_app.app.picture.governor import FrameGovernor
    from mimics_app.app.picture.picture import Picture
    from mimics_app.rendering.visual.surfaces.surface import Surface

__all__ = ["Session"]


class Session(SessionCore):
    """One run: its scene, its stages, its shared memory, its record.

    Args:
        parts: What it is made of.
        memory: Shared with recorder and sound.
        recorder: Its process is on its way up.
        sound: Opening.

    Attributes:
        folder: Of the run.
        picture: None while nothing is drawn.
        governor: None while no frame has to keep time.
        film: Where its film goes, None while there is none.
        window: What was drawn on, kept open for what comes after the session; None: it closes with the picture.
        trouble: Why it ends before its time though nobody requested it, "" while it does not.
        on_close: What must be released if the run ends before `finish`.
    """

    recorder: Recorder

    def __init__(self, parts: Preparation, memory: SessionMemory, recorder: Recorder, sound: SoundPort) -> None:
        super().__init__(parts, memory, recorder, sound, recorder.folder)
        self.report = say
        self.settings: RunSettings = parts.settings
        self.folder: Path = recorder.folder
        self.picture: Picture | None = None
        self.governor: FrameGovernor | None = None
        self.film: Path | None = None
        self.window: Surface | None = None
        self.trouble = ""
        self.on_close = ExitStack()

    def show(self, picture: Picture) -> None:
        """Take a picture to draw from now on, into a film where one is wanted."""
        self.picture = picture
        self.shown_by(picture.presenter)
        if self.settings.video is not None:
            self.on_close.callback(picture.start_film(self.settings.video, live=self.live).finish)

    def end_stages(self) -> AudioReport | None:
        """Stop touch, picture and sound, in that order; the recorder still runs."""
        self.stop()
        if self.picture is not None:
            self.film = None if self.picture.film is None else self.picture.film.place
            self.picture.close(keep_surface=self.window is not None)
            self.picture = None
        report = self.sound.stop()
        if report is None:
            return None
        status = report.status
        self.recorder.journal("audio", {"device": status.device, "sink": status.sink, "hrtf": status.hrtf})
        for row in report.rows:
            heard = {"sample": row.onset_sample, "latency_ms": row.latency_ms}
            self.recorder.journal("sound", {"sound": row.sound, "tick": row.tick, "t_ns": row.t_ns, **heard})
        return report

    def finish(self, summary: dict[str, Any]) -> Manifest:
        """Close the recording with the result of the run."""
        manifest = self.recorder.close(summary)
        self.on_close.pop_all()
        return manifest

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Release whatever `finish` did not: a run that failed leaves no process and no moving robot behind."""
        self.on_close.close()
