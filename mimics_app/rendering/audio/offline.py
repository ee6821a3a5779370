"""Sound of a virtual clock: the same events give the same bytes, and every sound starts at its exact sample."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import Vec3
from mimics_app.contracts.clock import VirtualClock
from mimics_app.contracts.errors import DeviceError, MimicsError, nearest
from mimics_app.contracts.messages.stage_messages import SoundEvent
from mimics_app.contracts.ports.audio_port import AudioReport, AudioStatus, ListenerState, Mixer, frame_at
from mimics_app.contracts.shared_memory.session_memory import SessionMemory
from mimics_app.contracts.shared_memory.shared_words import DROPPED
from mimics_app.rendering.audio.bank import SoundBank
from mimics_app.rendering.audio.director import SoundDirector
from mimics_app.rendering.audio.engine import Engine, open_engine_in_step, open_mixer
from mimics_app.rendering.audio.long_sounds import LongSounds
from mimics_app.rendering.audio.settings import AudioSettings, SoundSpec

__all__ = ["OfflineAudio", "render_offline"]

Pose = tuple[Vec3, Vec3, Vec3]

_BLOCK = 1024


class OfflineAudio:
    """Sound of a headless session, mixed in the main process, with the interface of `AudioProcess`.

    It is written to a wave file where the settings name one; else only the report says which sounds play when.
    Frame n of the file is session time n / rate; a sound starts at round(t * rate) plus the constant pipeline.

    Attributes:
        listener: Called with each block that was mixed, shape [n, channels]; None: nobody listens.
    """

    def __init__(self, memory: SessionMemory, settings: AudioSettings) -> None:
        self._memory = memory
        self._settings = settings
        self._clock = VirtualClock()
        self._engine: Engine | None = None
        self._director: SoundDirector | None = None
        self._status: AudioStatus | None = None
        self._report: AudioReport | None = None
        self._blocks = 0
        self._lost = False
        self.listener: Callable[[NDArray[np.float32]], None] | None = None

    def start(self) -> None:
        """Open the loopback and the file, if any; without the library the session continues silently, with a notice."""
        settings = self._settings
        try:
            bank = SoundBank(settings.sounds, settings.rate)
            engine = open_engine_in_step(settings, bank, self._clock, settings.file, latency=0, origin_ns=0)
        except (DeviceError, OSError) as error:
            notice = f"{error}: sound is dropped; picture and touch run on"
            self._status = AudioStatus("none", "null", hrtf=False, rate=0, latency_ms=0.0, notice=notice)
            return
        engine.listener = self._keep_block
        self._engine, self._status = engine, engine.status
        if engine.mixer is not None:
            self._director = SoundDirector(self._memory, engine.mixer, bank, settings, self._clock, in_step=True)

    @property
    def ready(self) -> AudioStatus | None:
        """Status of the output, None before `start`."""
        return self._status

    def play(self, event: SoundEvent) -> None:
        """Start a sound of the task at its time. MimicsError: the settings know no sound of that name."""
        if event.sound not in self._settings.sounds:
            raise MimicsError(f'no sound "{event.sound}"', nearest(event.sound, self._settings.sounds))
        if self._director is not None:
            self._director.play_order(event)

    def master(self, gain: float) -> None:
        """Set the linear gain of everything."""
        if self._mixer is not None:
            self._mixer.master(gain)

    def advance(self, now_ns: int) -> None:
        """Read the contacts up to now and mix them; to be called after the haptic ticks of the frame."""
        self._clock.sleep_until_ns(now_ns)
        if self._engine is None or self._director is None or self._mixer is None:
            return
        self._director.take_contacts()
        self._director.listen()
        if problem := self._director.take_problem():
            self._engine.status = self._status = replace(self._engine.status, notice=problem)
        self._write(self._engine, partial(self._engine.render_to, frame_at(now_ns, 0, self._mixer.rate), _BLOCK))

    def stop(self) -> AudioReport:
        """Let the last sounds decay, close the file and return the report."""
        if self._report is None:
            self._report = self._close()
        return self._report

    def _keep_block(self, block: NDArray[np.float32]) -> None:
        if self.listener is not None:
            self.listener(block)

    @property
    def _mixer(self) -> Mixer | None:
        return None if self._engine is None else self._engine.mixer

    def _write(self, engine: Engine, render: Callable[[], int]) -> None:
        """Render blocks, and count them; a file that cannot be written any further ends the sound, not the session."""
        if self._lost:
            return
        try:
            self._blocks += render()
        except DeviceError as error:
            self._lost = True
            notice = f"{error.what}: the rest of the sound is dropped; picture and touch run on"
            engine.status = self._status = replace(engine.status, notice=notice)

    def _close(self) -> AudioReport:
        engine, director, mixer = self._engine, self._director, self._mixer
        silent = AudioStatus("none", "null", hrtf=False, rate=0, latency_ms=0.0)
        if engine is None or director is None or mixer is None:
            return AudioReport(self._status or silent)
        director.take_contacts()
        director.decay()
        self._write(engine, partial(engine.decay, _BLOCK))
        director.close()
        engine.close()
        return AudioReport(
            engine.status,
            rows=tuple(director.rows),
            merged=director.merged,
            stale=director.stale,
            dropped=int(self._memory.audio_event_words[DROPPED]),
            refused=mixer.refused,
            blocks=self._blocks,
            clipped=0 if engine.writer is None else engine.writer.clipped,
            file="" if engine.writer is None else str(engine.writer.path),
        )


def render_offline(
    events: Sequence[SoundEvent],
    sounds: Mapping[str, SoundSpec],
    seconds: float,
    listener: Pose | None = None,
    *,
    hrtf: bool = True,
    rate: int = 48_000,
    mixer: str = "openal",
) -> tuple[NDArray[np.float32], list[int]]:
    """Render a list of events on a clock that starts at 0.

    Args:
        events: Sounds to start, in any order.
        sounds: Settings of the sounds, by name.
        seconds: Length of the render.
        listener: Position [m], forward and up of the head; None: at the origin, looking along -z.
        hrtf: Whether head-related filters are applied.
        rate: Samples per second.
        mixer: Mixer to use.

    Returns:
        The mix, shape [n, 2], not limited to full scale, and for every event the frame of its first sample:
        round(t * rate) plus the constant pipeline of the mix; -1 where no voice was free.

    Raises:
        DeviceError: No OpenAL library.
        KeyError: An event names a sound that is not among `sounds`.
    """
    settings = AudioSettings(sounds=sounds, triggers={}, scrape="", hrtf=hrtf, rate=rate, voices=64, mixer=mixer)
    bank, clock = SoundBank(sounds, rate), VirtualClock()
    opened = open_mixer(settings, bank, clock, latency=0, origin_ns=0)
    try:
        if listener is not None:
            opened.set_listener(_head_alone(listener))
        return _render_events(opened, LongSounds(opened, bank, clock, in_step=True), events, round(seconds * rate))
    finally:
        opened.close()


def _head_alone(pose: Pose) -> ListenerState:
    position, forward, up = (np.asarray(each, np.float64) for each in pose)
    none, some = np.zeros((0, 3)), np.zeros(0)
    return ListenerState(
        0, position, np.zeros(3), forward, up, 0.0, 1.0, np.zeros(0, np.int64), none, none, none, some, none, some
    )


def _render_events(
    mixer: Mixer, long: LongSounds, events: Sequence[SoundEvent], frames: int
) -> tuple[NDArray[np.float32], list[int]]:
    """Pass each event to the mixer one block before it is due, so that voices are busy only while they sound."""
    order = sorted(range(len(events)), key=lambda k: events[k].t_ns)
    onsets = [-1] * len(events)
    blocks = []
    waiting = iter(order)
    following = next(waiting, None)
    while mixer.position < frames:
        end = min(mixer.position + _BLOCK, frames)
        while following is not None and frame_at(events[following].t_ns, 0, mixer.rate) < end:
            event = events[following]
            start = mixer.start(event.sound, event.t_ns, event.position_world, event.gain)
            long.begin(event.sound, start)
            if start.handle:
                onsets[following] = mixer.first_sample(start, event.t_ns)[0]
            following = next(waiting, None)
        long.advance()
        blocks.append(mixer.render(end - mixer.position))
    return np.concatenate(blocks) if blocks else np.zeros((0, 2), np.float32), onsets
