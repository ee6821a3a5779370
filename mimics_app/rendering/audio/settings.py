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
        recipe: Name of a recipe ("contact", "goal", "start", "trial_end", "tick", "scrape"); "" when a file is given.
        file: Wave file (PCM or float, any rate, mixed to one channel); None when a recipe is given.
        gain: Linear gain it is authored with.
        loop: True to repeat it until it is stopped.
        reference_distance: Distance [m] at which it is as loud as authored; half as loud at twice the distance.
    """

    recipe: str = ""
    file: Path | None = None
    gain: float = 1.0
    loop: bool = False
    reference_distance: float = 1.0


def _default_sounds() -> dict[str, SoundSpec]:
    names = ("contact", "goal", "start", "trial_end", "tick")
    return {name: SoundSpec(recipe=name) for name in names} | {"scrape": SoundSpec(recipe="scrape", loop=True)}


@dataclass(frozen=True, slots=True)
class AudioSettings:
    """How sound is opened and what it plays.

    Attributes:
        sink: "device" (falls back to a file or to nothing), "file", or "null": no process, no sound.
        file: Wave file of the sink "file", and of the fallback when there is no device; None: dropped then.
        sounds: Sounds of the scene by the name that `SoundEvent.sound` uses.
        contact: Sound of a contact, or "" for silent contacts.
        scrape: Looping sound of sliding along a wall, or "" for none.
        contact_gain: Linear gain of the loudest contact.
        hrtf: Head-related filters; switch off for loudspeakers.
        rate: Samples per second asked for.
        period: Frames per period of a live device, two periods queued; 128 or 256 keep contact to sound below 20 ms.
        block: Frames per block of a file.
        voices: Most sounds at once.
        realtime: Ask for the first-in-first-out scheduler below the haptic loop, where the system grants it.
        start_timeout_s: After this time without an answer the app is told that there is no sound [s].
        driver: Backend of OpenAL Soft ("pulse", "alsa", ...); "" lets the library choose.
        library: Path of an OpenAL Soft library; "" takes the one PyOpenAL finds.
        environment: Environment variables set in the audio process before the library loads.
    """

    sink: Sink = "device"
    file: Path | None = None
    sounds: Mapping[str, SoundSpec] = field(default_factory=_default_sounds)
    contact: str = "contact"
    scrape: str = "scrape"
    contact_gain: float = 0.8
    hrtf: bool = True
    rate: int = 48_000
    period: int = 128
    block: int = 240
    voices: int = 32
    realtime: bool = True
    start_timeout_s: float = 10.0
    driver: str = ""
    library: str = ""
    environment: Mapping[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if self.sink == "file" and self.file is None:
            raise ValueError('the sink "file" needs a file')
        if not 64 <= self.period <= 512:
            raise ValueError(
                f"a period of {self.period} frames is not between 64 and 512: the 20 ms bound would be lost"
            )
        for name in filter(None, (self.contact, self.scrape)):
            if name not in self.sounds:
                raise ValueError(f'sound "{name}" is used but not among the sounds: {", ".join(self.sounds)}')
