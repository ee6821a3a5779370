"""Sounds that are too long to be held: read from their files while they play, a few seconds ahead.

Such a sound plays as a loop of STREAM_FRAMES, a ring in which what was heard is overwritten by what comes next. A
thread decodes; only the thread of the mixer writes into the ring. How far the mixer has read is known from its frames,
and with a Doppler shift to within the time in which the sound comes from its place, so that the ring has seconds to
spare in front of and behind it.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np

from mimics_app.contracts.arrays import F4
from mimics_app.contracts.clock import Clock
from mimics_app.contracts.errors import SceneError
from mimics_app.contracts.ports.audio_port import Mixer, Start, frame_at
from mimics_app.rendering.audio.bank import STREAM_FRAMES, SoundBank

__all__ = ["LongSounds"]

_AHEAD = STREAM_FRAMES * 5 // 8
"""Samples beyond the mixer's place that are written at least; a part, an eighth of the ring, may lie beyond."""


@dataclass(slots=True)
class _Voice:
    """A long sound that plays.

    Attributes:
        name: Its name.
        handle: Handle of the sound in the mixer.
        frame: Frame of its first sample, -1 where a device mixes in its own thread.
        begun_ns: Session time of its start.
        parts: What follows of the file.
        written: Samples written.
        coming: The part that is being decoded.
        end: Number of samples, once the file has ended.
    """

    name: str
    handle: int
    frame: int
    begun_ns: int
    parts: Iterator[F4]
    written: int
    coming: Future[F4 | None] | None = None
    end: int | None = None


class LongSounds:
    """The sounds of a bank that are read while they play; each plays once at a time.

    Args:
        mixer: Mixer that plays them.
        bank: The bank.
        clock: Clock of the session.
        in_step: True to decode within `advance`: the same calls give the same samples, however slow the disk is.

    Attributes:
        problem: What ended a sound before its end, for a person; "" for nothing.
    """

    def __init__(self, mixer: Mixer, bank: SoundBank, clock: Clock, *, in_step: bool) -> None:
        self.problem = ""
        self._mixer = mixer
        self._clock = clock
        self._sounds = bank.streams
        self._rate = bank.rate
        self._voices: dict[str, _Voice] = {}
        threaded = bool(self._sounds) and not in_step
        self._decoder = ThreadPoolExecutor(1, "long sounds", _leave_precedence) if threaded else None

    def begin(self, name: str, start: Start) -> None:
        """Fill the beginning of a sound that the mixer has just started; no effect on one that is held as a whole."""
        if name not in self._sounds or start.handle == 0:
            return
        if name in self._voices:
            self._mixer.stop(self._voices[name].handle)
        sound = self._sounds[name]
        self._mixer.fill(start.handle, 0, sound.head)
        parts = sound.parts_after_head(self._rate)
        self._voices[name] = _Voice(name, start.handle, start.frame, self._clock.now_ns(), parts, len(sound.head))

    def advance(self) -> None:
        """Write what was decoded, ask for what comes next, and stop the sounds whose file has ended."""
        for name, voice in list(self._voices.items()):
            taken = self._taken(voice)
            try:
                self._read_ahead(voice, taken)
            except SceneError as error:
                self.problem, voice.end = f"a sound ends before its end: {error}", 0
            if voice.end is not None and taken >= voice.end + self._rate // 10:  # with what the mixer's filters hold
                self._mixer.stop(voice.handle)
                del self._voices[name]

    def close(self) -> None:
        """End the thread that decodes."""
        if self._decoder is not None:
            self._decoder.shutdown(cancel_futures=True)

    def _taken(self, voice: _Voice) -> int:
        """Return the samples of a sound that the mixer has read."""
        if voice.frame >= 0:
            return max(0, self._mixer.position - voice.frame)
        return frame_at(self._clock.now_ns(), voice.begun_ns, self._rate)

    def _read_ahead(self, voice: _Voice, taken: int) -> None:
        while voice.written < taken + _AHEAD:
            if voice.coming is None:
                voice.coming = self._decode(voice.parts)
            if not voice.coming.done():
                return
            part, voice.coming = voice.coming.result(), None
            if part is None:
                voice.end = voice.written if voice.end is None else voice.end
                part = np.zeros_like(self._sounds[voice.name].head)
            self._mixer.fill(voice.handle, voice.written, part)
            voice.written += len(part)

    def _decode(self, parts: Iterator[F4]) -> Future[F4 | None]:
        """Return the next part of a file, None at its end, as soon as it is decoded."""
        if self._decoder is not None:
            return self._decoder.submit(next, parts, None)
        decoded: Future[F4 | None] = Future()
        decoded.set_result(next(parts, None))
        return decoded


def _leave_precedence() -> None:
    """Give up the real-time priority of the thread that mixes, which this one inherits: it has seconds."""
    if hasattr(os, "sched_setscheduler"):
        os.sched_setscheduler(0, os.SCHED_OTHER, os.sched_param(0))
