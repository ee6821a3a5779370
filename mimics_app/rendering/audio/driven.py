"""Force-driven sounds: started at the contact event and filled with samples while the contact force is computed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import Vec3
from mimics_app.contracts.loop.contact_force import CONTACT_FORCE, FOLLOWED
from mimics_app.contracts.ports.audio_port import Mixer, Start, frame_at
from mimics_app.rendering.audio.bank import LIVE_VOICES, SoundBank
from mimics_app.rendering.audio.modal import FORCE_RATE, ModalVoice
from mimics_app.rendering.audio.wav_file import soften_peaks

__all__ = ["DrivenSounds"]

Pair = tuple[int, int]

_FOLLOWED_NS = FOLLOWED * 1_000_000_000 // FORCE_RATE
_PREDICTED_S = 0.01
"""How far a voice is filled beyond the newest force [s], so that a late tick causes no gap."""


@dataclass(slots=True, eq=False)
class _Voice:
    """One contact with a force-driven sound.

    Attributes:
        handle: Handle of the sound in the mixer.
        modes: Modal synthesiser of the struck object.
        begin_ns: Start of the contact.
        last_ns: Time of the newest force.
        cursor: Number of samples whose values are final.
        length: Number of samples of the sound.
        free_ns: Time at which the sound ends.
        open: True while forces are expected.
    """

    handle: int
    modes: ModalVoice
    begin_ns: int
    last_ns: int
    cursor: int
    length: int
    free_ns: int
    open: bool = True


class DrivenSounds:
    """The force-driven voices of a mixer.

    Args:
        mixer: Mixer that plays them.
        bank: Bank with the force-driven sounds and their modes.
    """

    def __init__(self, mixer: Mixer, bank: SoundBank) -> None:
        self._mixer = mixer
        self._bank = bank
        self._lead = mixer.lead
        self._voices: dict[str, _Voice] = {}
        self._by_pair: dict[Pair, _Voice] = {}
        self._predicted = round(_PREDICTED_S * mixer.rate)

    @property
    def playing(self) -> bool:
        """Whether forces of any contact are expected."""
        return bool(self._by_pair)

    def start(self, name: str, t_ns: int, place: Vec3 | None, force: float, pair: Pair) -> tuple[str, Start] | None:
        """Start the force-driven sound of a contact.

        Args:
            name: Name of the sound.
            t_ns: Start of the contact.
            place: Point of contact in the world [m].
            force: Force in the first tick [N].
            pair: The two bodies, as the CONTACT_FORCE records name them.

        Returns:
            Name of the sound and its start; None where a recording must be played instead: the sound is not
            force-driven, all its voices are busy, or the mixer cannot fill a voice.
        """
        number = self._free(name, t_ns)
        if number is None or self._lead is None:
            return None
        sound = f"{name}:live:{number}"
        start = self._mixer.start(sound, t_ns, place, 1.0)
        if start.handle == 0:
            return sound, start
        length = len(self._bank[sound].samples)
        self._mixer.fill(start.handle, 0, np.zeros(length, np.float32))
        modes = ModalVoice(self._bank.modes[name][number])
        over = t_ns + (length + self._mixer.rate // 10) * 1_000_000_000 // self._mixer.rate
        voice = _Voice(start.handle, modes, t_ns, t_ns, self._lead, length, over)
        self._end(self._by_pair.get(pair))
        self._voices[sound] = self._by_pair[pair] = voice
        self._apply_force(voice, t_ns, force)
        return sound, start

    def push_forces(self, forces: NDArray[np.void]) -> None:
        """Take CONTACT_FORCE records, shape [n], in order of time; contacts without such a sound are ignored."""
        assert forces.dtype == CONTACT_FORCE
        for row in forces:
            voice = self._by_pair.get((int(row["body_a"]), int(row["body_b"])))
            t_ns, force = int(row["t_ns"]), float(row["force"])
            if voice is not None and t_ns > voice.last_ns and np.isfinite(force):
                self._apply_force(voice, t_ns, force)

    def pass_time(self, now_ns: int) -> None:
        """Let contacts decay that have had no force for too long."""
        for voice in list(self._by_pair.values()):
            if now_ns - voice.begin_ns > 2 * _FOLLOWED_NS or voice.last_ns - voice.begin_ns >= _FOLLOWED_NS - 1:
                self._end(voice)

    def decay(self) -> None:
        """Let all voices decay; no more forces are expected."""
        for voice in list(self._by_pair.values()):
            self._end(voice)

    def _free(self, name: str, t_ns: int) -> int | None:
        """Return the number of an idle voice of a sound, None where all are busy or there is none."""
        if name not in self._bank.modes:
            return None
        voices = (self._voices.get(f"{name}:live:{number}") for number in range(LIVE_VOICES))
        return next((k for k, voice in enumerate(voices) if voice is None or voice.free_ns <= t_ns), None)

    def _apply_force(self, voice: _Voice, t_ns: int, force: float) -> None:
        """Fill the decay since the last force, the response to this one, and the decay that would follow."""
        rate = self._mixer.rate
        begin = (self._lead or 0) + frame_at(t_ns, 0, rate) - frame_at(voice.begin_ns, 0, rate)
        since = voice.modes.decay(max(0, begin - voice.cursor))
        forced, after = voice.modes.apply_force(abs(force)), voice.modes.predict(self._predicted)
        self._fill(voice, np.concatenate([since, forced, after]))
        voice.cursor += len(since) + len(forced)
        voice.last_ns = t_ns

    def _end(self, voice: _Voice | None) -> None:
        """Fill the rest of a voice with its decay."""
        if voice is None or not voice.open:
            return
        voice.open = False
        self._fill(voice, voice.modes.decay(max(0, voice.length - voice.cursor)))
        for pair in [pair for pair, each in self._by_pair.items() if each is voice]:
            del self._by_pair[pair]

    def _fill(self, voice: _Voice, samples: NDArray[np.float64]) -> None:
        self._mixer.fill(voice.handle, voice.cursor, soften_peaks(samples.astype(np.float32))[0])
