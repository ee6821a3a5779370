"""Session of one run: its core with recorder, sound and picture, and the order in which they end."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mimics_app.app.session.core import SessionCore
from mimics_app.app.session.preparation import SessionParts
from mimics_app.app.session.switched_off import SoundPort
from mimics_app.app.settings import RunSettings
from mimics_app.app.terminal.output import say
from mimics_app.contracts.commands.vocabulary import Reply
from mimics_app.contracts.ports.audio_port import AudioReport
from mimics_app.contracts.shared_memory.session_memory import SessionMemory
from mimics_app.recording.manifest import Manifest
from mimics_app.recording.recorder import Recorder

if TYPE_CHECKING:  # a session that draws nothing loads nothing of a picture
    from mimics_app.app.picture.governor import FrameGovernor
    from mimics_app.app.picture.picture import Picture

__all__ = ["Session"]


class Session(SessionCore):
    """One run.

    Args:
        parts: Parts of the session.
        memory: Memory shared with recorder and sound.
        recorder: The recorder; its process is starting.
        sound: The sound, starting.

    Attributes:
        folder: Run folder.
        picture: The picture; None while nothing is drawn.
        governor: Governor of the frame time; None where the frame time is free.
        film: File of the video; None without one.
        before_dark: Called after the robot was stopped, before the picture closes.
        trouble: Reason of an unrequested early end; "" for none.
        on_close: Cleanup of a run that ends before `finish`.
    """

    recorder: Recorder

    def __init__(self, parts: SessionParts, memory: SessionMemory, recorder: Recorder, sound: SoundPort) -> None:
        super().__init__(parts, memory, recorder, sound, recorder.folder)
        self.report = say
        self.settings: RunSettings = parts.settings
        self.folder: Path = recorder.folder
        self.picture: Picture | None = None
        self.governor: FrameGovernor | None = None
        self.film: Path | None = None
        self.before_dark: Callable[[], None] = lambda: None
        self.trouble = ""
        self.on_close = ExitStack()

    def show(self, picture: Picture) -> None:
        """Draw on a picture from now on, with a video where one is requested."""
        self.picture = picture
        self.shown_by(picture.presenter)
        if self.settings.video is not None:
            self.on_close.callback(picture.start_film(self.settings.video, live=self.live).finish)

    def show_view(self, name: str) -> Reply:
        """Show the view of an entity's camera from the next frame on."""
        reply = super().show_view(name)
        if reply.done and self.picture is not None:
            self.picture.show_view(name)
        return reply

    def end_stages(self) -> AudioReport | None:
        """Stop the haptic loop, the picture and the sound, in this order; the recorder still runs."""
        self.stop()
        if self.picture is not None:
            self.film = None if self.picture.film is None else self.picture.film.place
            self.before_dark()
            self.picture.close()
            self.picture = None
        report = self.sound.stop()
        if report is None:
            return None
        status = report.status
        self.recorder.journal("audio", {"device": status.device, "sink": status.sink, "hrtf": status.hrtf})
        for row in report.rows:
            played = {"sample": row.onset_sample, "latency_ms": row.latency_ms}
            self.recorder.journal("sound", {"sound": row.sound, "tick": row.tick, "t_ns": row.t_ns, **played})
        return report

    def finish(self, summary: dict[str, Any]) -> Manifest:
        """Close the recording with the result of the run."""
        manifest = self.recorder.close(summary)
        self.on_close.pop_all()
        return manifest

    def __exit__(self, *_: object) -> None:
        """Stop the processes and the robot of a run that failed before `finish`."""
        self.on_close.close()
