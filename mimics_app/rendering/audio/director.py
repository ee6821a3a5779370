"""The sound director: turns events of the haptic loop, orders of the task and emitters into voices of the mixer."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import F8, Vec3
from mimics_app.contracts.clock import Clock
from mimics_app.contracts.loop.contact_force import CONTACT_FORCE
from mimics_app.contracts.loop.haptic import EVENT, EventKind
from mimics_app.contracts.messages.stage_messages import SoundEvent
from mimics_app.contracts.ports.audio_port import ListenerState, Mixer, SoundRow, Start
from mimics_app.contracts.shared_memory import ring, triple_buffer
from mimics_app.contracts.shared_memory.session_memory import SessionMemory
from mimics_app.contracts.shared_memory.sound_scene import BANDS, SOUND_SCENE, fill_defaults
from mimics_app.maths.length import length
from mimics_app.rendering.audio.bank import SoundBank
from mimics_app.rendering.audio.contact_gain import ContactGate, contact_gain, scrape_gain, scrape_pitch
from mimics_app.rendering.audio.driven import DrivenSounds
from mimics_app.rendering.audio.long_sounds import LongSounds
from mimics_app.rendering.audio.settings import AudioSettings

__all__ = ["TOUCHES", "SoundDirector"]


_STALE_NS = 100_000_000

_SCRAPE_REST_NS = 500_000_000
"""Time without sliding after which the voice of the scrape ends [ns]."""

_ORDER_SPEED = 0.3
"""Impact speed assumed for an order of gain 1 [m/s], where the sound has speed steps."""

TOUCHES: Mapping[int, str] = {
    EventKind.CONTACT_BEGIN: "contact",
    EventKind.CONTACT_END: "contact_end",
    EventKind.IMPACT: "impact",
}
"""Names by which the settings refer to events of the haptic loop."""


class SoundDirector:
    """Plays the sounds of a session on a mixer, from the session's shared memory.

    Attributes:
        rows: One row for every sound started.
        merged: Contacts suppressed by the refractory period of their pair.
        stale: Events that were older than 100 ms when they were read, and were not played.
    """

    def __init__(
        self,
        memory: SessionMemory,
        mixer: Mixer,
        bank: SoundBank,
        settings: AudioSettings,
        clock: Clock,
        *,
        in_step: bool = False,
    ) -> None:
        self.rows: list[SoundRow] = []
        self.merged = 0
        self.stale = 0
        self._memory = memory
        self._mixer = mixer
        self._bank = bank
        self._settings = settings
        self._clock = clock
        self._gates = {kind: ContactGate() for kind in TOUCHES}
        self._handles = np.zeros(len(settings.emitters) + 1, np.int64)  # emitters, then the scrape of the wall
        self._scene = np.zeros(1, SOUND_SCENE)
        fill_defaults(self._scene)
        self._scrape_state = np.array([0.0] * 7 + [1.0])  # of the scrape: position, velocity, gain, pitch
        self._slid_ns = 0
        self._drained = np.zeros(256, EVENT)
        self._forces = np.zeros(1024, CONTACT_FORCE)
        self._driven = DrivenSounds(mixer, bank)
        self._long = LongSounds(mixer, bank, clock, in_step=in_step)

    @property
    def driving(self) -> bool:
        """Whether a force-driven sound plays; the ring of contact forces must then be read every tick."""
        return self._driven.playing

    def take_problem(self) -> str:
        """Return what ended a sound before its end, once; "" for nothing."""
        problem, self._long.problem = self._long.problem, ""
        return problem

    def close(self) -> None:
        """End what reads long sounds."""
        self._long.close()

    def take_contacts(self) -> None:
        """Drain the rings: start the sounds of new contacts and feed forces to the sounds they drive."""
        count = len(self._drained)
        while count == len(self._drained):
            count = ring.drain(self._memory.audio_event_words, self._memory.audio_events, self._drained)
            self.play_contacts(self._drained[:count])
        count = len(self._forces)
        while count == len(self._forces):
            count = ring.drain(self._memory.audio_force_words, self._memory.audio_forces, self._forces)
            self._driven.push_forces(self._forces[:count])
        self._driven.pass_time(self._clock.now_ns())

    def decay(self) -> None:
        """Let all force-driven sounds decay; no more forces are expected."""
        self._driven.decay()

    def play_contacts(self, events: NDArray[np.void]) -> None:
        """Start the sounds of EVENT records, shape [n]; only the kinds in `TOUCHES` have one."""
        now = self._clock.now_ns()
        for event in events:
            kind = int(event["kind"])
            sound = self._sound_of(event, TOUCHES[kind]) if kind in TOUCHES else ""
            if sound:
                self._play_contact(event, sound, self._gates[kind], TOUCHES[kind], now)

    def _sound_of(self, event: np.void, cause: str) -> str:
        """Return the sound of an event by the touched material; an event holds a material or a body row + 1."""
        bodies = (int(event["body_b"]) - 1, int(event["body_a"]) - 1)
        return self._settings.sound_of_touch(cause, bodies, (int(event["material_b"]), int(event["material_a"])))

    def play_order(self, order: SoundEvent) -> None:
        """Start a sound requested by the task; an unknown name is ignored here, as the application refuses it."""
        if order.sound not in self._bank:
            return
        if self._clock.now_ns() - order.t_ns > 10 * _STALE_NS:
            self.stale += 1
            return
        sound = self._bank.variant(order.sound, _ORDER_SPEED * order.gain, len(self.rows))
        self._start("order", sound, order.t_ns, -1, order.position_world, order.gain)

    def _play_contact(self, event: np.void, name: str, gate: ContactGate, cause: str, now: int) -> None:
        t_ns, speed = int(event["t_ns"]), abs(float(event["speed"]))
        level = contact_gain(speed, float(event["force"]), self._settings.sounds[name].full_force)
        if now - t_ns > _STALE_NS:
            self.stale += 1
        elif not gate.passes(int(event["body_a"]), int(event["body_b"]), t_ns, level):
            self.merged += 1
        else:
            place, tick = _finite_place(event["position_world"]), int(event["tick"])
            pair, force = (int(event["body_a"]), int(event["body_b"])), float(event["force"])
            driven = self._driven.start(name, t_ns, place, force if math.isfinite(force) else 0.0, pair)
            if driven is None:
                self._start(cause, self._bank.variant(name, speed, len(self.rows)), t_ns, tick, place, level)
            else:
                self._note(driven[1], cause, driven[0], t_ns, tick, level)

    def listen(self) -> None:
        """Pass the newest snapshots to the mixer: head and emitters of the frame, scrape of the haptic loop."""
        slot, fresh = triple_buffer.acquire(self._memory.sound_scene_words)
        if fresh:
            self._scene[:] = self._memory.sound_scenes[slot : slot + 1]
        scraped = bool(self._settings.scrape) and self._update_scrape()
        if fresh or scraped:
            self._mixer.set_listener(self._listener_state())
        self._long.advance()
        self._rest_scrape(self._clock.now_ns())

    def _rest_scrape(self, now: int) -> None:
        """End the voice of the scrape when it has been silent for a while, so that silence costs nothing."""
        if self._scrape_state[6] > 0.0:
            self._slid_ns = now
        elif self._handles[-1] != 0 and now - self._slid_ns > _SCRAPE_REST_NS:
            self._mixer.stop(int(self._handles[-1]))
            self._handles[-1] = 0

    def _update_scrape(self) -> bool:
        """Update the scrape from the newest haptic snapshot; return whether what is heard of it may have changed."""
        slot, fresh = triple_buffer.acquire(self._memory.audio_words)
        if not fresh:
            return False
        snapshot = self._memory.audio_snapshots[slot]
        touched = snapshot["wall_force"] > 0.0
        if not touched and self._scrape_state[6] == 0.0:
            return False
        place, velocity = snapshot["hip_world"], snapshot["v_world"]
        if not (np.isfinite(place).all() and np.isfinite(velocity).all()):
            return False
        self._scrape_state[:3], self._scrape_state[3:6] = place, velocity
        normal = snapshot["wall_normal"]
        pressed = max(0.0, float(snapshot["f_user_world"] @ normal)) if touched else 0.0
        speed = length(velocity - (velocity @ normal) * normal)
        self._scrape_state[6:] = scrape_gain(speed, pressed), scrape_pitch(speed)
        return True

    def _listener_state(self) -> ListenerState:
        """Return the snapshot in the mixer's form; emitters that appear for the first time are started."""
        scene, count = self._scene[0], len(self._settings.emitters)
        position = np.concatenate((scene["position"][:count], self._scrape_state[None, :3]))
        velocity = np.concatenate((scene["velocity"][:count], self._scrape_state[None, 3:6]))
        gain = np.concatenate((scene["gain"][:count], self._scrape_state[6:7]))
        for row, name in enumerate((*self._settings.emitters, self._settings.scrape)):
            if name and self._handles[row] == 0 and gain[row] > 0.0 and np.isfinite(position[row]).all():
                x, y, z = (float(value) for value in position[row])
                t_ns = min(int(scene["t_ns"]), self._clock.now_ns())
                self._handles[row] = self._begin(name, t_ns, (x, y, z), float(gain[row])).handle
        return ListenerState(
            t_ns=int(scene["t_ns"]),
            head_position=scene["head_position"],
            head_velocity=scene["head_velocity"],
            head_forward=scene["head_forward"],
            head_up=scene["head_up"],
            room_level=float(scene["room_level"]),
            room_time=float(scene["room_time"]),
            handles=self._handles,
            position=position,
            velocity=velocity,
            forward=np.concatenate((scene["forward"][:count], [(0.0, 0.0, -1.0)])),
            gain=gain,
            passes=np.concatenate((scene["passes"][:count], np.ones((1, BANDS)))),
            pitch=np.concatenate((np.ones(count), self._scrape_state[7:])),
        )

    def _start(self, cause: str, sound: str, t_ns: int, tick: int, place: Vec3 | None, gain: float) -> None:
        self._note(self._begin(sound, t_ns, place, gain), cause, sound, t_ns, tick, gain)

    def _begin(self, sound: str, t_ns: int, place: Vec3 | None, gain: float) -> Start:
        start = self._mixer.start(sound, t_ns, place, gain)
        self._long.begin(sound, start)
        return start

    def _note(self, start: Start, cause: str, sound: str, t_ns: int, tick: int, gain: float) -> None:
        """Append the row of a started sound."""
        if start.handle == 0:
            return
        submitted = self._clock.now_ns()
        onset, output_ns = self._mixer.first_sample(start, submitted)
        self.rows.append(SoundRow(t_ns, tick, cause, sound, gain, submitted, onset, output_ns, start.late))


def _finite_place(position: F8) -> Vec3 | None:
    """Return a position [m] as numbers, None where it is not finite."""
    x, y, z = (float(value) for value in position)
    return (x, y, z) if math.isfinite(x) and math.isfinite(y) and math.isfinite(z) else None
