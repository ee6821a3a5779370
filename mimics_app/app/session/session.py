"""Everything one run owns, and the order in which it ends."""

from __future__ import annotations

from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mimics_app.app.cues.sound_stage import SoundStage
from mimics_app.app.picture.governor import FrameGovernor
from mimics_app.app.settings import RunSettings
from mimics_app.app.touch.haptic_side import HapticSide
from mimics_app.app.touch.parameter_desk import ParameterDesk
from mimics_app.contracts.audio_port import AudioReport
from mimics_app.contracts.clock import Clock
from mimics_app.contracts.scenario_port import Scenario
from mimics_app.contracts.session_memory import SessionMemory
from mimics_app.contracts.stages import Dsp, Estimation, Learning
from mimics_app.inputs.stage import Inputs
from mimics_app.recording.manifest import Manifest
from mimics_app.recording.recorder import Recorder
from mimics_app.rendering.haptic.engine import HapticEngine
from mimics_app.tasks.task_manager import TaskManager
from mimics_app.world.scene.scene import Scene
from mimics_app.world.world import World

if TYPE_CHECKING:
    from mimics_app.app.picture.picture import Picture  # a session that draws nothing loads nothing of it

__all__ = ["Session"]


@dataclass(slots=True)
class Session:
    """One run: its scene, its stages, its shared memory, its record.

    Attributes:
        side: What of the scene can be touched, as it was when the loop was built.
        live: True when the haptic loop runs in real time; False on the virtual clock.
        picture: None while nothing is drawn.
        sound: None in a scene without sound.
        governor: None while no frame has to keep time.
        film: Where its film goes, None while there is none.
        trouble: Why it ends before its time though nobody asked for it, "" while it does not.
        on_close: What must be released if the run ends before `finish`.
    """

    settings: RunSettings
    live: bool
    scene: Scene
    world: World
    scenario: Scenario
    side: HapticSide
    memory: SessionMemory
    clock: Clock
    desk: ParameterDesk
    haptics: HapticEngine
    tasks: TaskManager
    inputs: Inputs
    dsp: Dsp
    estimation: Estimation
    learning: Learning
    recorder: Recorder
    folder: Path
    sound: SoundStage | None = None
    picture: Picture | None = None
    governor: FrameGovernor | None = None
    film: Path | None = None
    trouble: str = ""
    on_close: ExitStack = field(default_factory=ExitStack)

    def show(self, picture: Picture) -> None:
        """Take a picture to draw from now on, into a film where one is wanted."""
        self.picture = picture
        if self.settings.video is not None:
            self.on_close.callback(picture.start_film(self.settings.video, live=self.live).finish)

    def end_stages(self) -> AudioReport | None:
        """Stop touch, picture and sound, in that order; the recorder still runs."""
        self.tasks.end_session(self.clock.now_ns())
        self.haptics.stop()
        if self.picture is not None:
            self.film = None if self.picture.film is None else self.picture.film.place
            self.picture.close()
            self.picture = None
        if self.sound is None:
            return None
        report = self.sound.stop()
        status = report.status
        self.recorder.journal("audio", {"device": status.device, "sink": status.sink, "hrtf": status.hrtf})
        for row in report.rows:
            heard = {"sample": row.onset_sample, "latency_ms": row.latency_ms}
            self.recorder.journal("sound", {"sound": row.sound, "tick": row.tick, "t_ns": row.t_ns, **heard})
        return report

    def finish(self, summary: dict[str, Any]) -> Manifest:
        """Seal the recording with what the run came to."""
        manifest = self.recorder.close(summary)
        self.on_close.pop_all()
        return manifest

    def __enter__(self) -> Session:
        return self

    def __exit__(self, *exception: object) -> None:
        """Release whatever `finish` did not: a run that failed leaves no process and no moving robot behind."""
        self.on_close.close()
