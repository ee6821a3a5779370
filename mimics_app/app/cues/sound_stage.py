"""Sound as the frame drives it: the listener's head, sounds that play from places, cues of the task, orders."""

from __future__ import annotations

import sys
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from mimics_app.app.cues.cue_watch import CueWatch
from mimics_app.contracts.audio_port import AudioOutput, AudioReport
from mimics_app.contracts.messages import SoundEvent, TaskOrders
from mimics_app.world.world import World

__all__ = ["SoundStage"]


class SoundStage:
    """The audio output of a session and what it is told once a frame.

    Args:
        output: Opened already.
        cues: Sound by trigger ("start", "goal").
        emitters: Entities whose sound plays from where they are.
        gain: Of everything, from the scene; the task's own gain multiplies it.
    """

    def __init__(self, output: AudioOutput, cues: Mapping[str, str], emitters: tuple[str, ...], gain: float) -> None:
        self.output = output
        self._cues = cues
        self._emitters = emitters
        self._gain = gain
        self._watch = CueWatch()
        self._notice = ""
        output.master(gain)

    def step(self, orders: TaskOrders, world: World, now_ns: int) -> None:
        """One frame at session time `now_ns`; never waits."""
        self._place(world)
        gain = orders.audio.get("gain")
        if isinstance(gain, int | float):
            self.output.master(self._gain * float(gain))
        cue = self._cues.get(self._watch.look(orders) or "")
        if cue is not None:
            self.output.play(SoundEvent(cue, now_ns))
        for sound in orders.sounds:
            self.output.play(sound)
        self._play_events(world, now_ns)
        self.output.advance(now_ns)
        self._tell_notice()

    def _play_events(self, world: World, now_ns: int) -> None:
        """What the clips of models passed in this frame, such as feet that touch the ground: where it happened."""
        for index, event in world.motion.happened:
            sound = self._cues.get(f"{event.kind}.{event.material}") or self._cues.get(event.kind)
            if sound is not None:
                self.output.play(
                    SoundEvent(sound, now_ns, _triple(_place_of(world, index, event.node)), event.strength)
                )

    def stop(self) -> AudioReport:
        """End the sound."""
        return self.output.stop()

    def _place(self, world: World) -> None:
        """Head at the camera; emitters where their entities are."""
        if world.cameras:
            pose = world.cameras[0].world_from_eye
            self.output.listener(_triple(pose[:3, 3]), _triple(-pose[:3, 2]), _triple(pose[:3, 1]))
        for name in self._emitters:
            if name in world:
                self.output.emitter(name, _triple(world.find(name).world_matrix()[:3, 3]))

    def _tell_notice(self) -> None:
        """One line when sound is not, or no longer, what was asked for."""
        status = self.output.ready
        if status is not None and status.notice != self._notice:
            self._notice = status.notice
            if self._notice:
                sys.stderr.write(f"mimics: {self._notice}\n")


def _place_of(world: World, index: int, node: str) -> NDArray[np.float64]:
    """Where a node of a model is, or the model itself, world [m]."""
    name = f"{world.graph.name(index)}/{node}"
    return world.graph.world_matrix(world.graph.find(name) if node and name in world else index)[:3, 3]


def _triple(values: NDArray[np.float64]) -> tuple[float, float, float]:
    return float(values[0]), float(values[1]), float(values[2])
