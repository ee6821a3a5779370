"""Settings of one run, from the command line or the launcher, and the values that they can take."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

__all__ = [
    "DIFFICULTIES",
    "NOT_FITTED",
    "OPERATOR_LOST",
    "PATIENTS",
    "PICTURE_SIZE",
    "PROFILES",
    "QUALITIES",
    "RECIPES",
    "SIDES",
    "SOUNDS",
    "Difficulty",
    "OperatorLost",
    "Profile",
    "Quality",
    "RunSettings",
    "Side",
    "SoundChoice",
]

Profile = Literal["draft", "training", "study"]
SoundChoice = Literal["auto", "device", "file", "off"]
Quality = Literal["auto", "full"]
Difficulty = Literal["easier", "usual", "harder"]
Side = Literal["left", "right"]
OperatorLost = Literal["continue", "pause", "stop"]

NOT_FITTED = Path("none")
"""Value of `RunSettings.fit` for a scene as it is, whatever is kept with the participant."""
PROFILES: tuple[Profile, ...] = ("draft", "training", "study")
OPERATOR_LOST: tuple[OperatorLost, ...] = ("continue", "pause", "stop")
QUALITIES: tuple[Quality, ...] = ("auto", "full")
SIDES: tuple[Side, ...] = ("left", "right")
DIFFICULTIES: tuple[Difficulty, ...] = ("easier", "usual", "harder")
SOUNDS: tuple[SoundChoice, ...] = ("auto", "device", "file", "off")
PATIENTS = ("healthy", "moderate", "severe")
"""Presets of the simulated patient, by impairment."""
PICTURE_SIZE = (1280, 720)
"""Usual size of a picture without a window [px]."""
RECIPES = ("auto", "fifo", "ordinary", "plain")
"""Recipes of `rendering.haptic.scheduler`, repeated so that --help imports no haptic code (a test compares them)."""


PICTURE_OPTIONS = ("nosoftware",)
"""Options of the renderer for comparisons: drawing in software as a graphics card is given it."""


@dataclass(frozen=True, slots=True)
class RunSettings:
    """Settings of one run.

    Attributes:
        scene: Scene file.
        headless: True: no window, virtual clock, simulated patient, as fast as the machine allows.
        seconds: Simulated time after which the run ends [s]; None: when the task is done.
        seed: Seed of trial order, patient and sensor noise.
        profile: Accuracy of physics and picture, by the tolerances of the planner.
        quality: "auto": quality of a live picture as far as its frame time allows; "full": as the scene requests.
        device: Device instead of the scene's; "" keeps it (in a window "pointer").
        recording: Run folder whose samples the device "replay" plays, or None.
        patient: Preset instead of the scene's; "" keeps it.
        sound: "device": sound output; "file": sound.wav in the run folder; "off": none; "auto": the device when live,
            else off.
        size: Size of the picture [px]; None: 1280x720, of a window as suits the person and the monitor.
        display: Display, KIND or KIND:FILE; "" keeps the scene's.
        pictures: Number of frames that a headless run draws and keeps.
        video: File of a video, or folder for every frame as PNG, or None.
        action: File of task actions to replay, or None.
        commands: File of commands, each given at its time, or None.
        physio: Source of body signals, e.g. "sim" or "lsl:NAME"; "": none.
        learn: Policy that adapts the task; "": the task's own, if any.
        goal: Goal of the policy, see `learning.goals.build_goal`; "": the task's.
        estimator: Estimator of the person's state, one of `estimation.registry.BUILT_IN`; "": the task's.
        baseline_s: Length of the baseline measured at rest before the first trial [s].
        runs: Parent of the run folder.
        recipe: Scheduling of the live haptic loop, one of RECIPES.
        from_trial: First trial, 1 first, to continue a session that was broken off.
        difficulty: "easier" and "harder" move the adaptable parameters half-way to their easiest or hardest value.
        trials: Number of trials that count, the scene's list repeated where it is shorter; 0: as in the scene.
        participant: Code of the person, for results over time; "": none.
        language: Language of the texts that the person sees, one of `contracts.system.language.LANGUAGES`; "": English.
        fit: Run folder of a calibration, or file of a fit, to which the task is fitted; NOT_FITTED or None: to nothing.
        side: Side of the person that plays; "left" mirrors the scene.
        avatar: Model that is the person's own body, where the scene shows one; None: as the scene has it.
        larger_text: Whether all that is over the picture is enlarged.
        high_contrast: Whether texts, panels, targets, paths and the hand's marker have colours of high contrast.
        opt: One of PICTURE_OPTIONS, or "".
        steer: Program of an installed package that gives commands; "": none.
        markers: Stream of markers of the lab streaming layer that may give notes, marks and stops; "": none.
        lsl: Whether poses, forces, features, state and markers are sent as streams of the lab streaming layer.
        console: Port of the operator's page, which makes the session run by the wall clock; None: no page is started.
        operator_lost: What a lost operator leads to.
        despite: Checks of the operator's page that were not green when it started the session all the same.
        journey: File for reports to the process that started the run, see `play.journey_log`; or None.
    """

    scene: Path
    headless: bool = False
    seconds: float | None = None
    seed: int = 1
    profile: Profile = "training"
    quality: Quality = "auto"
    device: str = ""
    recording: Path | None = None
    patient: str = ""
    sound: SoundChoice = "auto"
    size: tuple[int, int] | None = None
    display: str = ""
    pictures: int = 4
    video: Path | None = None
    action: Path | None = None
    commands: Path | None = None
    physio: str = ""
    learn: str = ""
    goal: str = ""
    estimator: str = ""
    baseline_s: float = 60.0
    runs: Path = field(default_factory=lambda: Path("runs"))
    recipe: str = "auto"
    from_trial: int = 1
    difficulty: Difficulty = "usual"
    trials: int = 0
    participant: str = ""
    language: str = ""
    fit: Path | None = None
    side: Side = "right"
    avatar: Path | None = None
    larger_text: bool = False
    high_contrast: bool = False
    opt: str = ""
    steer: str = ""
    markers: str = ""
    lsl: bool = False
    console: int | None = None
    operator_lost: OperatorLost = "pause"
    despite: str = ""
    journey: Path | None = None

    @property
    def picture_size(self) -> tuple[int, int]:
        """Size of a picture without a window [px]."""
        return self.size or PICTURE_SIZE
