"""What a session asks of its sound."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

__all__ = ["AudioSettings", "Sink", "SoundSpec"]

Sink = Literal["device", "file", "null"]


@dataclass(frozen=True, slots=True)
class SoundSpec:
    """One sound of a scene: made by a recipe of the synthesiser, or read from a wave file.

    Attributes:
        recipe: Name of a recipe ("contact", "goal", "start", "trial_end", "tick", "scrape", "knock", "grip",
            "slip"); "" when a file is given.
        file: Wave file (PCM or float, any rate, mixed to one channel); None when a recipe is given.
        gain: Linear gain it is authored with.
        pitch: Ratio that raises or lowers a recipe.
        loop: True to repeat it until it is stopped.
        full_force: Contact force [N] at which a contact is about as loud as authored; softer ones are quieter.
        reference_distance: Distance [m] at which it is as loud as authored; half as loud at twice the distance.
        max_distance: Distance [m] beyond which it gets no quieter.
        rolloff: Factor on the fall with distance; 0: none, 1: natural.
    """

    recipe: str = ""
    file: Path | None = None
    gain: float = 1.0
    pitch: float = 1.0
    loop: bool = False
    full_force: float = 10.0
    reference_distance: float = 1.0
    max_distance: float = 50.0
    rolloff: float = 1.0


def _default_sounds() -> dict[str, SoundSpec]:
    return {name: SoundSpec(recipe=name) for name in ("contact", "goal", "start", "trial_end", "tick", "scrape")}


@dataclass(frozen=True, slots=True)
class AudioSettings:
    """How sound is opened and what it plays.

    Attributes:
        sink: "device" (falls back to a file or to nothing), "file", or "null": no process, no sound.
        file: Wave file of the sink "file", and of the fallback when there is no device; None: dropped then.
        sounds: Sounds of the scene by the name that `SoundEvent.sound` uses.
        contact: Sound of a contact, or "" for silent contacts.
        contact_end: Sound of letting go, or "".
        impact: Sound of a body that hits another or the scene, or "".
        scrape: Looping sound of sliding along a wall, or "" for none.
        cues: Sounds of other triggers by their name ("goal", "start", "step"); the app plays them.
        emitters: Looping sounds that begin with the scene; the app places them with `AudioOutput.emitter`.
        hrtf: Head-related filters; switch off for loudspeakers.
        rate: Samples per second asked for.
        period: Frames per period of a live device, two periods queued; 128 or 256 keep contact to sound below 20 ms.
        block: Frames per block of a file.
        voices: Most sounds at once.
        realtime: Ask for the first-in-first-out scheduler below the haptic loop, where the system grants it.
        start_timeout_s: After this time without an answer the app is told that there is no sound [s].
        stop_timeout_s: After this time without a report the process is ended by force [s].
        driver: Backend of OpenAL Soft ("pulse", "alsa", ...); "" lets the library choose.
        library: Path of an OpenAL Soft library; "" takes the one PyOpenAL finds.
        environment: Environment variables set in the audio process before the library loads.
    """

    sink: Sink = "device"
    file: Path | None = None
    sounds: Mapping[str, SoundSpec] = field(default_factory=_default_sounds)
    contact: str = "contact"
    contact_end: str = ""
    impact: str = ""
    scrape: str = "scrape"
    cues: Mapping[str, str] = field(default_factory=dict)
    emitters: tuple[str, ...] = ()
    hrtf: bool = True
    rate: int = 48_000
    period: int = 128
    block: int = 240
    voices: int = 32
    realtime: bool = True
    start_timeout_s: float = 10.0
    stop_timeout_s: float = 3.0
    driver: str = ""
    library: str = ""
    environment: Mapping[str, str] = field(default_factory=dict)

    @property
    def sources(self) -> int:
        """Sources of the library: one for each voice, and spare ones for sounds that are fading out."""
        return self.voices + 8

    def __post_init__(self) -> None:
        if self.sink == "file" and self.file is None:
            raise ValueError('the sink "file" needs a file')
        if not 64 <= self.period <= 512:
            raise ValueError(
                f"a period of {self.period} frames is not between 64 and 512: the 20 ms bound would be lost"
            )
        if not 1 <= self.voices <= 200:
            raise ValueError(f"{self.voices} voices are not between 1 and 200")
        for name in filter(
            None, (self.contact, self.contact_end, self.impact, self.scrape, *self.cues.values(), *self.emitters)
        ):
            if name not in self.sounds:
                raise ValueError(f'sound "{name}" is used but not among the sounds: {", ".join(self.sounds)}')
