"""Decides what sounds: contact events of the loop, orders of the task and the newest wall pressure become voices."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts import ring, triple_buffer
from mimics_app.contracts.audio_port import SoundRow
from mimics_app.contracts.clock import Clock
from mimics_app.contracts.haptic import EVENT, EventKind
from mimics_app.contracts.messages import SoundEvent
from mimics_app.contracts.session_memory import SessionMemory
from mimics_app.rendering.audio.bank import SoundBank
from mimics_app.rendering.audio.contact_law import ContactGate, contact_gain, scrape_gain
from mimics_app.rendering.audio.openal_mixer import OpenALMixer
from mimics_app.rendering.audio.settings import AudioSettings

__all__ = ["SoundDirector"]

Vec3 = tuple[float, float, float]

_STALE_NS = 100_000_000
_AUDIBLE_CHANGE = 0.02


class SoundDirector:
    """Reads the session's memory and plays it on a mixer.

    Attributes:
        rows: One row for every sound started.
        merged: Contacts held back by the pause of their pair.
        stale: Events older than 100 ms when they were read; they are not played.
    """

    def __init__(
        self, memory: SessionMemory, mixer: OpenALMixer, bank: SoundBank, settings: AudioSettings, clock: Clock
    ) -> None:
        self.rows: list[SoundRow] = []
        self.merged = 0
        self.stale = 0
        self._memory = memory
        self._mixer = mixer
        self._bank = bank
        self._settings = settings
        self._clock = clock
        self._begin_gate = ContactGate()
        self._end_gate = ContactGate()
        self._impact_gate = ContactGate()
        self._emitters: dict[str, tuple[int, float]] = {}
        self._drained = np.zeros(256, EVENT)

    def take_contacts(self) -> None:
        """Drain the ring and start a sound for every contact that deserves one."""
        while True:
            count = ring.drain(self._memory.audio_event_words, self._memory.audio_events, self._drained)
            self.play_contacts(self._drained[:count])
            if count < len(self._drained):
                return

    def play_contacts(self, events: NDArray[Any]) -> None:
        """Start the sounds of EVENT records, shape [n]; only contacts that begin or end and impacts have one."""
        now = self._clock.now_ns()
        for event in events:
            kind = int(event["kind"])
            if kind == EventKind.CONTACT_BEGIN and self._settings.contact:
                self._play_contact(event, self._settings.contact, self._begin_gate, "contact", now)
            elif kind == EventKind.CONTACT_END and self._settings.contact_end:
                self._play_contact(event, self._settings.contact_end, self._end_gate, "contact_end", now)
            elif kind == EventKind.IMPACT and self._settings.impact:
                self._play_contact(event, self._settings.impact, self._impact_gate, "impact", now)

    def play_order(self, order: SoundEvent) -> None:
        """Start a sound the task asked for; a name the bank does not know is ignored, the app has refused it before."""
        if order.sound not in self._bank:
            return
        if self._clock.now_ns() - order.t_ns > 10 * _STALE_NS:
            self.stale += 1
            return
        self._start("order", order.sound, order.t_ns, -1, order.position_world, order.gain)

    def _play_contact(self, event: NDArray[Any], name: str, gate: ContactGate, cause: str, now: int) -> None:
        t_ns, speed = int(event["t_ns"]), abs(float(event["speed"]))
        level = contact_gain(speed, float(event["force"]), self._settings.sounds[name].full_force)
        if now - t_ns > _STALE_NS:
            self.stale += 1
        elif not gate.passes(int(event["body_a"]), int(event["body_b"]), t_ns, level):
            self.merged += 1
        else:
            sound = self._bank.variant(name, speed, len(self.rows))
            self._start(cause, sound, t_ns, int(event["tick"]), _finite_place(event["position_world"]), level)

    def set_emitter(self, sound: str, t_ns: int, place: Vec3, gain: float) -> None:
        """Let a looping sound play from a place: started when first named, then moved and its gain followed."""
        known = self._emitters.get(sound)
        if known is None:
            if gain > 0.0 and sound in self._bank:
                self._emitters[sound] = (self._mixer.start(sound, t_ns, place, gain), gain)
            return
        handle, before = known
        if abs(gain - before) > _AUDIBLE_CHANGE * (gain + before):
            self._mixer.gain(handle, gain)
            self._emitters[sound] = (handle, gain)
        if gain > 0.0:
            self._mixer.move(handle, place)

    def follow_pressure(self) -> None:
        """Let the rub of the wall follow the newest haptic snapshot."""
        if not self._settings.scrape:
            return
        slot, fresh = triple_buffer.acquire(self._memory.audio_words)
        if not fresh:
            return
        snapshot = self._memory.audio_snapshots[slot]
        pressed = float(np.linalg.norm(snapshot["f_user_world"])) if snapshot["penetration"] > 0.0 else 0.0
        level = scrape_gain(float(np.linalg.norm(snapshot["v_world"])), pressed)
        place = _finite_place(snapshot["hip_world"])
        if place is not None:
            self.set_emitter(self._settings.scrape, int(snapshot["t_ns"]), place, level)

    def _start(self, cause: str, sound: str, t_ns: int, tick: int, place: Vec3 | None, gain: float) -> None:
        start = self._mixer.place(sound, t_ns, place, gain)
        if start.handle == 0:
            return
        submitted = self._clock.now_ns()
        onset, heard = self._mixer.first_sample(start, submitted)
        self.rows.append(SoundRow(t_ns, tick, cause, sound, gain, submitted, onset, heard, start.late))


def _finite_place(position: NDArray[Any]) -> Vec3 | None:
    x, y, z = (float(value) for value in position)
    return (x, y, z) if math.isfinite(x) and math.isfinite(y) and math.isfinite(z) else None
