"""Drive of the sound by the frame: poses of head and emitters for the mixer, triggers and orders for the output."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from mimics_app.app.cues.cue_watch import CueWatch
from mimics_app.app.cues.sound_surroundings import SoundSurroundings
from mimics_app.app.terminal.output import say
from mimics_app.contracts.arrays import F4, F8
from mimics_app.contracts.commands.vocabulary import Reply
from mimics_app.contracts.messages.stage_messages import SoundEvent, SoundTrigger, TaskOrders
from mimics_app.contracts.ports.audio_port import AudioOutput, AudioReport
from mimics_app.contracts.shared_memory import triple_buffer
from mimics_app.contracts.shared_memory.session_memory import SessionMemory
from mimics_app.contracts.shared_memory.sound_scene import SOUND_SCENE, fill_defaults
from mimics_app.maths.mat import unscale
from mimics_app.rendering.audio.queue_need import keep_needed_ms
from mimics_app.rendering.audio.settings import AudioSettings, SoundSpec
from mimics_app.rendering.audio.sound_file import is_streamed, read_sound
from mimics_app.world.content.motion.speaking import LEVELS_PER_S
from mimics_app.world.content.world import World

__all__ = ["SoundStage", "read_voices"]

_JUMP = 50.0
"""Largest speed of a movement [m/s]; a faster object was repositioned and has no Doppler shift."""

_VOICE_RATE = 8000
"""Rate at which a voice is read for its loudness [Hz]."""
_LOUD = 95.0
"""Percentile of the effective values that is as loud as the mouth opens: one shout does not close it elsewhere."""
_NEAR = np.array([0.25, 0.5, 0.25])
"""Weights of the windows before, now and after: lips do not flutter."""

_WAITED_NS = 5_000_000_000
"""Time after which a sound that is still starting is reported [ns]; usual are one to three seconds."""


class SoundStage:
    """The audio output of a session, and its inputs in each frame.

    Args:
        output: The output, open.
        memory: Shared memory from which the mixer reads head and emitters.
        settings: Sounds of the triggers, and the emitters.
        surroundings: Obstacles, rooms and walkers.
        gain: Master gain of the scene; the task's own gain multiplies it.
        listener: Entity at whose place the person hears; "": the person's eyes, whichever view is shown.
        voices: Levels of the voices of persons by the name of the sound, for their mouths.
    """

    def __init__(
        self,
        output: AudioOutput,
        memory: SessionMemory,
        settings: AudioSettings,
        surroundings: SoundSurroundings,
        gain: float,
        listener: str = "",
        voices: Mapping[str, F8] = MappingProxyType({}),
    ) -> None:
        self.output = output
        self._listener, self._voices = listener, voices
        self._memory = memory
        self._settings = settings
        self._surroundings = surroundings
        self._gain, self._of_task, self.volume, self._muted = gain, 1.0, 1.0, False
        self._watch = CueWatch()
        self._notice = ""
        self._begun_ns: int | None = None
        self._now = np.zeros(1, SOUND_SCENE)
        fill_defaults(self._now)
        self._placed = False
        self._set_master()

    def set_volume(self, level: float) -> Reply:
        """Set the volume of all sound, 1 as authored; gains of scene and task multiply it."""
        self.volume = level
        return self._set_master()

    def mute(self, *, on: bool) -> Reply:
        """Silence all sound, or end that."""
        self._muted = on
        return self._set_master()

    def step(self, orders: TaskOrders, world: World, now_ns: int, triggers: Sequence[SoundTrigger] = ()) -> None:
        """Do one frame at session time `now_ns` [ns]; never waits."""
        self._place(world, now_ns)
        if orders.audio.gain is not None:
            self._of_task = orders.audio.gain
            self._set_master()
        cue = self._watch.poll(orders)
        own = [SoundTrigger(cue, now_ns)] if cue else []
        moved = (*_motion_triggers(world, now_ns), *self._surroundings.steps(world, now_ns))
        for trigger in (*triggers, *orders.audio.cues, *own, *moved):
            sound = self._settings.sound_of(trigger.kind, trigger.material)
            if sound:
                self._play(SoundEvent(sound, trigger.t_ns, trigger.position_world, trigger.strength), world)
        for order in orders.audio.sounds:
            self._play(order, world)
        self.output.advance(now_ns)
        self._show_notice(now_ns)

    def pass_over(self, orders: TaskOrders) -> None:
        """See a frame whose sounds are not played, so that the next one does not play what began in it."""
        self._watch.poll(orders)

    def stop(self) -> AudioReport:
        """Stop the output, keep for later sessions what its queue needed, and return its report."""
        report = self.output.stop()
        self._show(report.status.notice)
        keep_needed_ms(report.queue)
        return report

    def _play(self, event: SoundEvent, world: World) -> None:
        """Start a sound; the person whose voice it is moves the lips."""
        self.output.play(event)
        levels, mouth = self._voices.get(event.sound), world.motion.mouths.get(event.sound)
        if levels is not None and mouth is not None:
            mouth.say(levels)

    def _set_master(self) -> Reply:
        self.output.master(0.0 if self._muted else self._gain * self._of_task * self.volume)
        return Reply(done=True)

    def _place(self, world: World, now_ns: int) -> None:
        """Publish the pose of the listener and of the emitters, with velocities from the previous frame."""
        now, count = self._now[0], len(self._settings.emitters)
        head, places = now["head_position"], now["position"][:count]
        before, places_before = head.copy(), places.copy()
        span = (now_ns - int(now["t_ns"])) * 1e-9
        now["t_ns"] = now_ns
        ears = world.eye(self._listener)
        if ears is not None:
            pose = ears.world_matrix()
            unscale(pose)
            now["head_position"], now["head_forward"], now["head_up"] = pose[:3, 3], -pose[:3, 2], pose[:3, 1]
        for row, name in enumerate(self._settings.emitters):
            if name in world:
                pose = world.find(name).world_matrix()
                places[row], now["forward"][row], now["gain"][row] = pose[:3, 3], -pose[:3, 2], 1.0
        moved_s = span if self._placed else 0.0
        now["head_velocity"] = _velocities(head - before, moved_s)
        if count:
            now["velocity"][:count] = _velocities(places - places_before, moved_s)
            now["passes"][:count] = self._surroundings.passes(world, head, places, span)
        now["room_level"], now["room_time"] = self._surroundings.room(world, head)
        self._placed = True
        slot = triple_buffer.back_slot(self._memory.sound_scene_words)
        self._memory.sound_scenes[slot] = now
        triple_buffer.publish(self._memory.sound_scene_words)

    def _show_notice(self, now_ns: int) -> None:
        """Report once on stderr where the sound is not yet, not, or no longer, the one requested."""
        status = self.output.ready
        if self._begun_ns is None:
            self._begun_ns = now_ns
        if status is not None:
            self._show(status.notice)
        elif now_ns - self._begun_ns > _WAITED_NS:
            self._show("the sound is still starting: the computer is busy")

    def _show(self, notice: str) -> None:
        if notice != self._notice:
            self._notice = notice
            if notice:
                say(notice)


def read_voices(specs: Mapping[str, SoundSpec]) -> dict[str, F8]:
    """Return the levels of recorded voices by name; recipes and what lasts longer than a minute are no speech."""
    return {
        name: _levels(read_sound(spec.file, _VOICE_RATE, spec.inside).mean(axis=1))
        for name, spec in specs.items()
        if spec.file is not None and not is_streamed(spec.file, spec.inside)
    }


def _levels(samples: F4) -> F8:
    """Return the effective value of each window of a recording [n], 0 to 1 of a loud one."""
    wide = _VOICE_RATE // LEVELS_PER_S
    whole = np.zeros(-(-len(samples) // wide) * wide)
    whole[: len(samples)] = samples
    levels = np.sqrt((whole.reshape(-1, wide) ** 2).mean(axis=1))
    loud = float(np.percentile(levels, _LOUD)) if len(levels) else 0.0
    if loud == 0.0:
        return levels
    result: F8 = np.convolve(np.minimum(levels / loud, 1.0), _NEAR, "same")
    return result


def _velocities(moved: NDArray[np.float64], span: float) -> NDArray[np.float64]:
    """Return the velocities [m/s] of displacements [m], shape [.., 3], in a time [s]; 0 for repositioned objects."""
    if span <= 0.0:
        return np.zeros_like(moved)
    velocity = moved / span
    speed2 = (velocity * velocity).sum(axis=-1, keepdims=True)
    return np.where(speed2 < _JUMP * _JUMP, velocity, 0.0)


def _motion_triggers(world: World, now_ns: int) -> Iterator[SoundTrigger]:
    """Yield a trigger, with its position, for each event that the clips of models passed in this frame."""
    for index, event in world.motion.happened:
        x, y, z = _place_of(world, index, event.node)
        yield SoundTrigger(
            event.kind,
            now_ns,
            material=event.material,
            position_world=(float(x), float(y), float(z)),
            strength=event.strength,
        )


def _place_of(world: World, index: int, node: str) -> NDArray[np.float64]:
    """Return the position of a node of a model, else of the model itself, world [m], shape [3]."""
    name = f"{world.graph.name(index)}/{node}"
    return world.graph.world_matrix(world.graph.find(name) if node and name in world else index)[:3, 3]
