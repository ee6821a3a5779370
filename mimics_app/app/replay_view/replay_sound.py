"""Sound of a replay: what the session's sounds were begun by begins them again, at the time of who listens."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TypeVar

import numpy as np

from mimics_app.app.cues.cue_watch import with_gait_cues
from mimics_app.app.session.replay import TaskFrame
from mimics_app.app.session.sound import open_sound
from mimics_app.contracts.clock import Clock
from mimics_app.contracts.messages.stage_messages import SoundEvent, SoundTrigger, TaskOrders
from mimics_app.contracts.ports.audio_port import AudioReport
from mimics_app.contracts.shared_memory import ring
from mimics_app.contracts.shared_memory.session_memory import SessionMemory
from mimics_app.recording.run import Run
from mimics_app.world.content.world import World
from mimics_app.world.files.scene.scene import Scene

__all__ = ["ReplaySound"]

_Timed = TypeVar("_Timed", SoundTrigger, SoundEvent)


class ReplaySound:
    """Plays contacts, cues and orders of the frames of a run, as long as somebody listens.

    Sounds that follow the force of a contact or the sliding on a wall tick by tick have their beginning only: the
    forces of contacts are not recorded.

    Args:
        run: The recording.
        scene: Its scene.
        clock: Clock of who listens.
        live: Whether the output of this computer is used; else it is mixed and discarded, on the clock of the session.
    """

    def __init__(self, run: Run, scene: Scene, clock: Clock, *, live: bool = True) -> None:
        self._memory, self._clock = SessionMemory(), clock
        self._sound = open_sound(scene, "auto", self._memory, run.folder, live=live)
        self._audible = True

    def set_audible(self, *, on: bool) -> None:
        """Begin or end to play the frames that are done from now on."""
        if on is not self._audible:
            self._audible = on
            self._sound.mute(on=not on)

    def step(self, frame: TaskFrame, orders: TaskOrders, world: World) -> None:
        """Do a frame of the run, after the world was brought to it."""
        if not self._audible:
            self._sound.pass_over(orders)
            return
        now_ns = self._clock.now_ns()
        shift_ns = now_ns - frame.now_ns
        events = frame.events.copy()
        events["t_ns"] += shift_ns
        for event in events:
            ring.push(self._memory.audio_event_words, self._memory.audio_events, np.array([event]))
        audio = with_gait_cues(orders, frame.events).audio
        later = replace(audio, cues=_later(audio.cues, shift_ns), sounds=_later(audio.sounds, shift_ns))
        self._sound.step(replace(orders, audio=later), world, now_ns)

    def close(self) -> AudioReport | None:
        """End the sound, and return what was played; None for a scene without sound."""
        return self._sound.stop()


def _later(timed: Sequence[_Timed], shift_ns: int) -> tuple[_Timed, ...]:
    return tuple(replace(each, t_ns=each.t_ns + shift_ns) for each in timed)
