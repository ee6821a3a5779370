"""What a session asks of its sound."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

__all__ = ["LAYOUTS", "AudioSettings", "BusSpec", "MixerName", "Sink", "SoundSpec", "Speakers"]

Sink = Literal["device", "file", "null"]
MixerName = Literal["openal", "spectral"]
Speakers = Literal["stereo", "5.1", "7.1", "ambisonic"]

LAYOUTS: Mapping[Speakers, int] = {"stereo": 2, "5.1": 6, "7.1": 8, "ambisonic": 16}
"""Channels by arrangement; ambisonic: third order, ACN, SN3D."""

_MOST_VOICES = 4096


@dataclass(frozen=True, slots=True)
class BusSpec:
    """A group of sounds that are loud together.

    Attributes:
        gain: Linear.
        ducks: Other buses this one turns down while it sounds.
        duck_gain: Linear factor on those, 0.25: by 12 dB.
    """

    gain: float = 1.0
    ducks: tuple[str, ...] = ()
    duck_gain: float = 0.25


@dataclass(frozen=True, slots=True)
class SoundSpec:
    """One sound of a scene: made by a recipe of the synthesiser, or read from a wave file.

    Attributes:
        recipe: Name of a recipe ("contact", "goal", "start", "trial_end", "tick", "scrape", "knock", "grip",
            "slip"); "" when a file is given.
        file: Sound file (any rate, mixed to one channel), or the model that holds it; None when a recipe is given.
        inside: Number of the sound in that model, None for a file of its own.
        gain: Linear gain it is authored with.
        pitch: Ratio that raises or lowers a recipe.
        loop: True to repeat it until it is stopped.
        full_force: Contact force [N] at which a contact is about as loud as authored; softer ones are quieter.
        reference_distance: Distance [m] at which it is as loud as authored; half as loud at twice the distance.
        max_distance: Distance [m] beyond which it gets no quieter.
        rolloff: Factor on the fall with distance; 0: none, 1: natural.
        distance_model: "inverse" (6 dB per doubling), "linear" (to nothing at max_distance) or "exponential".
        cone_inner: Full angle around its axis in which it is as loud as authored [rad].
        cone_outer: Full angle beyond which it has `cone_gain` [rad].
        cone_gain: Linear gain behind the cone.
        doppler: Factor on the change of pitch by motion; 0: none, 1: natural.
        priority: Factor on its level when voices are short: the quietest by it gives way.
        reverb: Linear share that the room answers.
        bus: Name of its group.
        spatial: False for music and binaural recordings, which play as they are, two channels where they have two.
    """

    recipe: str = ""
    file: Path | None = None
    inside: int | None = None
    gain: float = 1.0
    pitch: float = 1.0
    loop: bool = False
    full_force: float = 10.0
    reference_distance: float = 1.0
    max_distance: float = 50.0
    rolloff: float = 1.0
    distance_model: Literal["inverse", "linear", "exponential"] = "inverse"
    cone_inner: float = 6.2832
    cone_outer: float = 6.2832
    cone_gain: float = 1.0
    doppler: float = 1.0
    priority: float = 1.0
    reverb: float = 1.0
    bus: str = "main"
    spatial: bool = True


def _default_sounds() -> dict[str, SoundSpec]:
    return {name: SoundSpec(recipe=name) for name in ("contact", "goal", "start", "trial_end", "tick", "scrape")}


@dataclass(frozen=True, slots=True)
class AudioSettings:
    """How sound is opened and what it plays.

    Attributes:
        sink: "device" (falls back to a file or to nothing), "file", or "null": no process, no sound.
        file: Wave file of the sink "file", and of the fallback when there is no device; None: dropped then.
        sounds: Sounds of the scene by the name that `SoundEvent.sound` uses.
        triggers: Sound by what starts it: "contact", "contact_end" and "impact" come from the haptic loop, any
            other kind ("goal", "start", "step") from the frame; "step/grass" is for one material and goes first.
        materials: Name of each material number of what can be touched; number 0 is "".
        body_materials: Material number of each body of the haptic loop, by its row.
        scrape: Looping sound of sliding along a wall, or "" for none.
        emitters: Sounds that play from entities, in the order of the rows of SOUND_SCENE.
        buses: Groups of sounds by name; "main" is always there.
        mixer: "openal", or "spectral": exact between the ears and the same to the sample on any machine.
        hrtf: Head-related filters; switch off for loudspeakers.
        speakers: Arrangement of the loudspeakers where `hrtf` is off; beyond stereo only "spectral" has them.
        sofa: SOFA file of a measured head; None: a computed one of `head_width`. Of "spectral" only.
        head_width: Between the ears of the computed head [m].
        rate: Samples per second requested.
        period: Frames per period of a live device, three periods queued; 64 to 192 keep contact to sound below 20 ms.
        block: Frames per block of a file.
        voices: Most sounds at once.
        realtime: Request the first-in-first-out scheduler below the haptic loop, where the system grants it.
        start_timeout_s: After this time without an answer the app reports that there is no sound [s].
        stop_timeout_s: After this time without a report the process is ended by force [s].
        driver: Backend of OpenAL Soft ("pulse", "alsa", ...); "" lets the library choose.
        library: Path of an OpenAL Soft library; "" takes the one PyOpenAL finds.
        environment: Environment variables set in the audio process before the library loads.
    """

    sink: Sink = "device"
    file: Path | None = None
    sounds: Mapping[str, SoundSpec] = field(default_factory=_default_sounds)
    triggers: Mapping[str, str] = field(default_factory=lambda: {"contact": "contact"})
    materials: tuple[str, ...] = ("",)
    body_materials: tuple[int, ...] = ()
    scrape: str = "scrape"
    emitters: tuple[str, ...] = ()
    buses: Mapping[str, BusSpec] = field(default_factory=dict)
    mixer: MixerName = "openal"
    hrtf: bool = True
    speakers: Speakers = "stereo"
    sofa: Path | None = None
    head_width: float = 0.152
    rate: int = 48_000
    period: int = 64
    block: int = 240
    voices: int = 32
    realtime: bool = True
    start_timeout_s: float = 10.0
    stop_timeout_s: float = 3.0
    driver: str = ""
    library: str = ""
    environment: Mapping[str, str] = field(default_factory=dict)

    @property
    def channels(self) -> int:
        """Of the mix."""
        return 2 if self.hrtf else LAYOUTS[self.speakers]

    def sound_of(self, kind: str, material: str = "") -> str:
        """Sound that a trigger starts, "" for none; one for its material goes before one for all."""
        return self.triggers.get(f"{kind}/{material}", "") or self.triggers.get(kind, "")

    def sound_of_touch(self, kind: str, rows: Sequence[int], numbers: Sequence[int]) -> str:
        """Sound of a touch: that of the first surface which has one of its own, else the one for all, "" for none.

        Args:
            kind: Of the trigger.
            rows: Bodies that touch, by their row; what is none of them is passed over.
            numbers: Materials after those of the bodies; what has no name is passed over.
        """
        of_bodies = [self.body_materials[row] for row in rows if 0 <= row < len(self.body_materials)]
        named = [self.materials[number] for number in (*of_bodies, *numbers) if 0 <= number < len(self.materials)]
        own = (f"{kind}/{name}" for name in named if name)
        return next((self.triggers[each] for each in own if each in self.triggers), self.triggers.get(kind, ""))

    @property
    def sources(self) -> int:
        """Sources of the library: one for each voice, and spare ones for sounds that are fading out."""
        return self.voices + 8

    def __post_init__(self) -> None:
        if self.sink == "file" and self.file is None:
            raise ValueError('the sink "file" needs a file')
        if not 64 <= self.period <= 192:
            raise ValueError(
                f"a period of {self.period} frames is not between 64 and 192: the 20 ms bound would be lost"
            )
        most = _MOST_VOICES if self.mixer == "spectral" else 200
        if not 1 <= self.voices <= most:
            raise ValueError(f"{self.voices} voices are not between 1 and {most}")
        if self.channels != 2 and self.mixer == "openal":
            raise ValueError(f'the mixer "openal" has two channels, not those of {self.speakers}: take "spectral"')
        for name in filter(None, (self.scrape, *self.triggers.values(), *self.emitters)):
            if name not in self.sounds:
                raise ValueError(f'sound "{name}" is used but not among the sounds: {", ".join(self.sounds)}')
