"""Settings of a session's sound."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

__all__ = ["AROUSAL", "AudioSettings", "BusSpec", "Sink", "SoundSpec", "Speakers"]

Sink = Literal["device", "file", "null"]
Speakers = Literal["stereo", "5.1", "7.1", "ambisonic"]

_LAYOUTS: Mapping[Speakers, int] = {"stereo": 2, "5.1": 6, "7.1": 8, "ambisonic": 16}
"""Number of channels per loudspeaker layout; ambisonic: third order, ACN, SN3D."""

AROUSAL = 0.6
"""Arousal of a crowd for which nothing else is named."""

_MOST_VOICES = 4096


@dataclass(frozen=True, slots=True)
class BusSpec:
    """A mixer bus: a group of sounds with a common gain.

    Attributes:
        gain: Linear gain.
        ducks: Buses that are ducked while this one sounds.
        duck_gain: Linear gain of a ducked bus; 0.25 is -12 dB.
    """

    gain: float = 1.0
    ducks: tuple[str, ...] = ()
    duck_gain: float = 0.25


@dataclass(frozen=True, slots=True)
class SoundSpec:
    """One sound of a scene: synthesised from a recipe, or read from a file.

    Attributes:
        recipe: Name of a recipe of the bank; "" when a file is given.
        file: Sound file of any rate, or the model that holds it; None when a recipe is given.
        inside: Number of the sound in that model, None for a file of its own.
        gain: Authored linear gain.
        pitch: Pitch ratio of a recipe.
        arousal: How much a crowd shouts and claps, 0 to 1.
        loop: True to repeat until stopped.
        full_force: Contact force at which a contact has about the authored gain [N]; softer ones are quieter.
        reference_distance: Distance at which the sound has its authored gain [m].
        max_distance: Distance beyond which attenuation is constant [m].
        rolloff: Factor on distance attenuation; 0: none, 1: natural.
        distance_model: "inverse" (6 dB per doubling), "linear" (zero at max_distance) or "exponential".
        cone_inner: Full angle of the cone with the authored gain [rad].
        cone_outer: Full angle beyond which the gain is `cone_gain` [rad].
        cone_gain: Linear gain outside the outer cone.
        doppler: Factor on the Doppler shift; 0: none, 1: natural.
        priority: Factor on the level when voices are stolen: the lowest product is stolen first.
        reverb: Linear send level to the reverb.
        bus: Name of its mixer bus.
        spatial: False for music and binaural recordings: played unspatialised, with two channels where they have two.
    """

    recipe: str = ""
    file: Path | None = None
    inside: int | None = None
    gain: float = 1.0
    pitch: float = 1.0
    arousal: float = AROUSAL
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
    """Output and content of a session's sound.

    Attributes:
        sink: "device" (falls back to a file or to nothing), "file", or "null": no process, no sound.
        file: Wave file of the sink "file", and of the fallback when there is no device; None: sound is dropped.
        sounds: Sounds of the scene by the name that `SoundEvent.sound` uses.
        triggers: Sound by trigger: "contact", "contact_end" and "impact" come from the haptic loop, all other kinds
            ("goal", "start", "step") from the frame; "step/grass" holds for one material and takes precedence.
        materials: Name of each material number; number 0 is "".
        body_materials: Material number of each body of the haptic loop, by its row.
        scrape: Looping sound of sliding along a wall, or "" for none.
        emitters: Sounds of entities, in the order of the rows of SOUND_SCENE.
        buses: Mixer buses by name; "main" always exists.
        mixer: Name of the mixer (rendering/audio/mixer_kinds.py).
        hrtf: Whether head-related filters are applied; off for loudspeakers.
        speakers: Loudspeaker layout where `hrtf` is off; not every mixer has others than stereo.
        sofa: SOFA file of a measured head; None: a computed head of `head_width`.
        head_width: Distance between the ears of the computed head [m].
        rate: Samples per second requested.
        period: Frames that a live device takes at once; 64 to 192 keep contact to sound below 20 ms.
        queue_ms: Shortest queue ahead of a live device [ms]; longer where the device needs it.
        block: Frames per block of a file.
        voices: Maximum number of voices.
        realtime: Request SCHED_FIFO with a priority below the haptic loop's, where the system grants it.
        start_timeout_s: Time-out for the start, after which the session has no sound [s].
        stop_timeout_s: Time-out for the report, after which the process is killed [s].
        driver: Backend of OpenAL Soft ("pulse", "alsa", ...); "" lets the library choose.
        library: Path of an OpenAL Soft library; "" takes the one that PyOpenAL finds.
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
    mixer: str = "openal"
    hrtf: bool = True
    speakers: Speakers = "stereo"
    sofa: Path | None = None
    head_width: float = 0.152
    rate: int = 48_000
    period: int = 64
    queue_ms: float = 0.0
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
        """Number of channels of the mix."""
        return 2 if self.hrtf else _LAYOUTS[self.speakers]

    def sound_of(self, kind: str, material: str = "") -> str:
        """Return the sound of a trigger, "" for none; a sound for the material takes precedence."""
        return self.triggers.get(f"{kind}/{material}", "") or self.triggers.get(kind, "")

    def sound_of_touch(self, kind: str, rows: Sequence[int], numbers: Sequence[int]) -> str:
        """Return the sound of a contact: that of the first material with one of its own, else the general one, else "".

        Args:
            kind: Trigger.
            rows: Rows of the bodies in contact; values that are no row are ignored.
            numbers: Further material numbers; those without a name are ignored.
        """
        of_bodies = [self.body_materials[row] for row in rows if 0 <= row < len(self.body_materials)]
        named = [self.materials[number] for number in (*of_bodies, *numbers) if 0 <= number < len(self.materials)]
        own = (f"{kind}/{name}" for name in named if name)
        return next((self.triggers[each] for each in own if each in self.triggers), self.triggers.get(kind, ""))

    def __post_init__(self) -> None:
        if self.sink == "file" and self.file is None:
            raise ValueError('the sink "file" needs a file')
        if not 64 <= self.period <= 192:
            raise ValueError(
                f"a period of {self.period} frames is not between 64 and 192: the 20 ms bound would be lost"
            )
        if not 1 <= self.voices <= _MOST_VOICES:
            raise ValueError(f"{self.voices} voices are not between 1 and {_MOST_VOICES}")
        for name in filter(None, (self.scrape, *self.triggers.values(), *self.emitters)):
            if name not in self.sounds:
                raise ValueError(f'sound "{name}" is used but not among the sounds: {", ".join(self.sounds)}')
