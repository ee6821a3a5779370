"""Sound of a replayed run: what the session's own sound received, on the clock of who listens."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields, replace
from typing import TypeVar

import numpy as np

from mimics_app.app.cues.cue_watch import with_gait_cues
from mimics_app.app.replay_view.replayed_scene import ReplayedScene
from mimics_app.app.session.replay import TaskFrame
from mimics_app.app.session.sound import open_sound
from mimics_app.contracts.arrays import Records, Words
from mimics_app.contracts.clock import TICK_NS, Clock
from mimics_app.contracts.loop.loop_fields import HapticSnapshot, PointSnapshot
from mimics_app.contracts.messages.stage_messages import SoundEvent, SoundTrigger, TaskOrders
from mimics_app.contracts.ports.audio_port import AudioReport
from mimics_app.contracts.shared_memory import ring, triple_buffer
from mimics_app.contracts.shared_memory.session_memory import SessionMemory
from mimics_app.world.content.world import World

__all__ = ["ReplaySound"]

_Timed = TypeVar("_Timed", SoundTrigger, SoundEvent)
_POINT = [field.name for field in fields(PointSnapshot)]


class ReplaySound:
    """Plays contacts, their forces, sliding, cues and orders of the frames of a run, as long as somebody listens.

    A frame holds the events and forces since the frame before it. Live, they are played one frame later than in the
    session, so that the next frame comes before a sound that its forces drive runs out of them.

    Args:
        replayed: The run.
        clock: Clock of who listens.
        live: Whether the output of this computer is used; else it is mixed and discarded, on the clock of the session.
    """

    def __init__(self, replayed: ReplayedScene, clock: Clock, *, live: bool = True) -> None:
        self._memory, self._clock, self._live = SessionMemory(), clock, live
        self._sound = open_sound(replayed.scene, "auto", self._memory, replayed.run.folder, live=live)
        self._forces = _on_the_clock_of(replayed.run.events, replayed.forces)
        self._ticks = replayed.forces["t_ns"] // TICK_NS
        self._before_ns, self._before_tick = 0, -1
        self._shift_ns: int | None = None
        self._audible = True

    def set_audible(self, *, on: bool) -> None:
        """Begin or end to play the frames that are done from now on."""
        if on is not self._audible:
            self._audible, self._shift_ns = on, None
            self._sound.mute(on=not on)

    def step(self, frame: TaskFrame, orders: TaskOrders, world: World) -> None:
        """Do a frame of the run, after the world was brought to it."""
        if self._audible:
            self._play(frame, orders, world)
        else:
            self._sound.pass_over(orders)
        self._before_ns, self._before_tick = frame.now_ns, frame.snapshot.tick

    def close(self) -> AudioReport | None:
        """End the sound, and return what was played; None for a scene without sound."""
        return self._sound.stop()

    def _play(self, frame: TaskFrame, orders: TaskOrders, world: World) -> None:
        now_ns = self._clock.now_ns()
        shift_ns = self._shift_to(now_ns, frame)
        memory = self._memory
        first, last = np.searchsorted(self._ticks, [self._before_tick, frame.snapshot.tick], side="right")
        _push_later(memory.audio_event_words, memory.audio_events, frame.events, shift_ns)
        _push_later(memory.audio_force_words, memory.audio_forces, self._forces[first:last], shift_ns)
        _publish_point(memory, frame.snapshot)
        audio = with_gait_cues(orders, frame.events).audio
        later = replace(audio, cues=_later(audio.cues, shift_ns), sounds=_later(audio.sounds, shift_ns))
        self._sound.step(replace(orders, audio=later), world, now_ns)

    def _shift_to(self, now_ns: int, frame: TaskFrame) -> int:
        """Return the time from the session to who listens [ns].

        It stays while the frames follow each other, so that the sounds keep their distances, and grows by the delay of
        one that comes late.
        """
        begun_ns = self._before_ns if self._live and self._before_ns < frame.now_ns else frame.now_ns
        shift_ns = now_ns - begun_ns
        if self._shift_ns is None or shift_ns > self._shift_ns:
            self._shift_ns = shift_ns
        return self._shift_ns


def _on_the_clock_of(events: Records, forces: Records) -> Records:
    """Return forces of a replayed loop [n] with the times of the session: each follows a recorded event."""
    forces = forces.copy()
    if len(events):
        at = np.searchsorted(events["tick"], forces["t_ns"] // TICK_NS, side="right") - 1
        forces["t_ns"] += (events["t_ns"] - events["tick"] * TICK_NS)[np.maximum(at, 0)]
    return forces


def _push_later(words: Words, records: Records, given: Records, shift_ns: int) -> None:
    """Push records [n] of the session to a ring, later by a time [ns]."""
    moved = given.copy()
    moved["t_ns"] += shift_ns
    for number in range(len(moved)):
        ring.push(words, records, moved[number : number + 1])


def _publish_point(memory: SessionMemory, snapshot: HapticSnapshot) -> None:
    """Publish the first point of contact to the sound, which hears from it how the hand slides."""
    record = memory.audio_snapshots[triple_buffer.back_slot(memory.audio_words)]
    for name in _POINT:
        record[name] = getattr(snapshot, name)
    triple_buffer.publish(memory.audio_words)


def _later(timed: Sequence[_Timed], shift_ns: int) -> tuple[_Timed, ...]:
    return tuple(replace(each, t_ns=each.t_ns + shift_ns) for each in timed)
