"""Settings of one run, from the command line or the launcher."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

__all__ = [
    "DIFFICULTIES",
    "PATIENTS",
    "PROFILES",
    "QUALITIES",
    "RECIPES",
    "SOUNDS",
    "Difficulty",
    "Profile",
    "Quality",
    "RunSettings",
    "SoundChoice",
]

Profile = Literal["draft", "training", "study"]
SoundChoice = Literal["auto", "device", "file", "off"]
Quality = Literal["auto", "full"]
Difficulty = Literal["easier", "usual", "harder"]

PROFILES: tuple[Profile, ...] = ("draft", "training", "study")
QUALITIES: tuple[Quality, ...] = ("auto", "full")
DIFFICULTIES: tuple[Difficulty, ...] = ("easier", "usual", "harder")
SOUNDS: tuple[SoundChoice, ...] = ("auto", "device", "file", "off")
PATIENTS = ("healthy", "moderate", "severe")
"""Presets of the simulated patient, by impairment."""
RECIPES = ("auto", "fifo", "ordinary", "plain")
"""Recipes of `rendering.haptic.scheduler`, repeated here so that --help imports no haptics (a test compares them)."""


@dataclass(frozen=True, slots=True)
class RunSettings:
    """One run.

    Attributes:
        scene: Scene file.
        headless: No window: virtual clock, simulated patient, as fast as the machine allows.
        seconds: Simulated time after which the run ends [s]; None: when the task is done.
        seed: Of everything random: trial order, patient, sensor noise.
        profile: Accuracy of physics and picture, by the tolerances of the planner.
        quality: "auto": a live picture is drawn as well as its frame time allows; "full": as the scene requests,
            whatever time that takes.
        device: Instead of the scene's robot device; "" keeps it (a window takes "pointer").
        recording: Run folder whose sensors the device "replay" plays, or None.
        patient: Preset instead of the scene's; "" keeps it.
        sound: "auto": the device when live, nothing kept when headless; "file": sound.wav in the run; "off": none.
        size: Of the picture [px].
        display: Where it is shown, KIND or KIND:FILE; "" keeps the scene's.
        pictures: Frames a headless run draws and keeps.
        video: File of a film, or folder for every frame as PNG, or None.
        action: File of task actions to replay, or None.
        physio: Source of body signals, e.g. "sim" or "lsl:NAME"; "": none.
        learn: Policy that adapts the task; "": the task's own, if any.
        goal: Goal of the policy, see `learning.goals.build_goal`; "": the task's.
        estimator: Of the person's state, one of `estimation.registry.ESTIMATORS`; "": the task's.
        baseline_s: Length of the baseline measured at rest at the beginning [s].
        runs: Folder the run folder is made in.
        difficulty: "easier" and "harder" move what the task can adapt half-way to its easiest or hardest value.
        trials: How many trials count, in the scene's order and again from its beginning; 0: as the scene says.
        participant: Code of the person, for results over time; "": none.
        journey: File for reports of the progress and of the choice on the page of results, or None.
        recipe: Scheduler of the live haptic loop, one of RECIPES.
        from_trial: Trial to begin with, 1 first: after a session that was broken off, the one it stopped in.
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
    size: tuple[int, int] = (1280, 720)
    display: str = ""
    pictures: int = 4
    video: Path | None = None
    action: Path | None = None
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
    journey: Path | None = None
