"""What a person asks of one run: the command line and the launcher both end here."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

__all__ = ["PROFILES", "QUALITIES", "RECIPES", "SOUNDS", "Profile", "Quality", "RunSettings", "SoundChoice"]

Profile = Literal["draft", "training", "study"]
SoundChoice = Literal["auto", "device", "file", "off"]
Quality = Literal["auto", "full"]

PROFILES: tuple[Profile, ...] = ("draft", "training", "study")
QUALITIES: tuple[Quality, ...] = ("auto", "full")
SOUNDS: tuple[SoundChoice, ...] = ("auto", "device", "file", "off")
RECIPES = ("auto", "fifo", "ordinary", "plain")
"""What `rendering.haptic.scheduler` knows; named here too so that --help imports no haptics (a test compares them)."""


@dataclass(frozen=True, slots=True)
class RunSettings:
    """One run.

    Attributes:
        scene: Scene file.
        headless: No window: virtual clock, simulated patient, as fast as the machine allows.
        seconds: Simulated time after which the run ends [s]; None: when the task is done.
        seed: Of everything random: trial order, patient, sensor noise.
        profile: How much the picture and the tolerances may give up.
        quality: "auto": a live picture is drawn as well as its frame time allows; "full": as the scene asks, whatever
            time that takes.
        device: Instead of the scene's robot device; "" keeps it (a window takes "pointer").
        recording: Run folder whose sensors the device "replay" plays, or None.
        patient: Preset instead of the scene's; "" keeps it.
        sound: "auto": device when live, file when headless; "off": none.
        size: Of the picture [px].
        pictures: Frames a headless run draws and keeps.
        video: File of a film, or folder for every frame as PNG, or None.
        action: File of task actions to replay, or None.
        runs: Folder the run folder is made in.
        participant: Code of the person, for results over time; "": none.
        journey: File that hears how far the start has come and what the person chose on the page of results, or None.
        recipe: Scheduler of the live haptic loop, one of RECIPES.
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
    pictures: int = 4
    video: Path | None = None
    action: Path | None = None
    runs: Path = field(default_factory=lambda: Path("runs"))
    recipe: str = "auto"
    participant: str = ""
    journey: Path | None = None
