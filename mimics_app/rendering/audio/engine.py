"""Opens the requested sound output, or the next one of the fallback chain, and feeds it.

    device  -> a queue in the sound server, filled by the audio process; without a server a device of OpenAL
    file    -> blocks that are due by the clock, written to a wave file
    null    -> no output: events are read and dropped

Where the requested output is not available, the session continues and one line reports what happens to its sound.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.clock import Clock
from mimics_app.contracts.errors import DeviceError, SceneError
from mimics_app.contracts.ports.audio_port import AudioStatus, Mixer, OnDemandMixer, Timing
from mimics_app.rendering.audio.bank import SoundBank
from mimics_app.rendering.audio.mixer_kinds import MixerRequest, find_mixer
from mimics_app.rendering.audio.pulse_library import PULSE
from mimics_app.rendering.audio.settings import AudioSettings
from mimics_app.rendering.audio.sound_stream import SoundStream
from mimics_app.rendering.audio.streamed_mixer import StreamedMixer
from mimics_app.rendering.audio.wav_file import WavWriter

__all__ = ["Engine", "fall_back", "open_device", "open_engine", "open_engine_in_step", "open_mixer"]

_TAIL_S = 1.5
"""Time from the end of a session to that of its file [s], in which the last sounds decay."""

_FADE_S = 0.04
"""Time at the end of a file in which sounds that do not end by themselves are faded [s]."""

_SILENT = AudioStatus(device="none", sink="null", hrtf=False, rate=0, latency_ms=0.0)


class Engine:
    """An open output: the mixer, the file it is written to, and the status reported to the application.

    Attributes:
        status: Status as the application receives it.
        bank: Sound bank, None where there is none.
        mixer: None where sound is dropped.
        writer: None where no file is written.
        listener: Called with each block that is mixed on demand; None: nobody listens.
    """

    def __init__(
        self, status: AudioStatus, bank: SoundBank | None, mixer: Mixer | None, writer: WavWriter | None
    ) -> None:
        self.status = status
        self.bank = bank
        self.mixer = mixer
        self.writer = writer
        self.listener: Callable[[NDArray[np.float32]], None] | None = None

    @property
    def live(self) -> bool:
        """True where a device plays the sound."""
        return self.status.sink == "device"

    def render_to(self, frame: int, block: int) -> int:
        """Render up to a frame, in blocks, into the file, if any; return the number of blocks; 0 on a live device.

        Raises:
            DeviceError: The file cannot be written any further.
        """
        if self.mixer is None or self.live:
            return 0
        blocks = 0
        while self.mixer.position < frame:
            samples = self.mixer.render(min(block, frame - self.mixer.position))
            if self.listener is not None:
                self.listener(samples)
            if self.writer is not None:
                try:
                    self.writer.append(samples)
                except OSError as error:
                    raise DeviceError(f"{self.writer.path}: {error.strerror}") from error
            blocks += 1
        return blocks

    def decay(self, block: int) -> int:
        """Render the decay of the last sounds, in blocks, and fade what still sounds; return the number of blocks.

        Raises:
            DeviceError: The file cannot be written any further.
        """
        if self.mixer is None or self.live:
            return 0
        end = self.mixer.position + round(_TAIL_S * self.mixer.rate)
        blocks = self.render_to(end - round(_FADE_S * self.mixer.rate), block)
        self.mixer.master(0.0)
        return blocks + self.render_to(end, block)

    def close(self) -> None:
        """Close mixer and file."""
        if self.mixer is not None:
            self.mixer.close()
        if self.writer is not None:
            self.writer.close()


def open_engine(settings: AudioSettings, clock: Clock, prepared: Callable[[], None] | None = None) -> Engine:
    """Open the output of a live session, falling back where needed; a missing library or device raises nothing.

    Args:
        settings: Requested output.
        clock: Clock of the session.
        prepared: Called after the slow part (sounds, head tables, kernels) and before a device opens.
    """
    try:
        kind = find_mixer(settings.mixer)
        bank = SoundBank(settings.sounds, settings.rate)
        kind.prepare(settings, bank)
    except DeviceError as error:
        return _dropped(f"{error.what}: sound is dropped; picture and touch run on ({error.fix})")
    except SceneError as error:
        return _dropped(f"{error}: sound is dropped; picture and touch run on")
    if prepared is not None:
        prepared()
    if settings.sink == "device":
        try:
            return open_device(settings, bank, clock)
        except DeviceError as error:
            return fall_back(settings, bank, clock, error.what)
    return fall_back(settings, bank, clock, "")


def fall_back(settings: AudioSettings, bank: SoundBank, clock: Clock, why: str) -> Engine:
    """Fall back to the file, or to no output; `why` begins the line the user reads, "" where this was requested."""
    if settings.file is None:
        return _dropped(f"{why}: sound is dropped; picture and touch run on")
    try:
        # One block of slack, one block being filled, and 1 ms until the event of a tick is in the ring.
        engine = open_engine_in_step(settings, bank, clock, settings.file, 2 * settings.block + settings.rate // 1000)
    except (DeviceError, OSError) as error:
        return _dropped(f"{why or 'no sound file'} ({error}): sound is dropped; picture and touch run on")
    if why:
        notice = f"{why}: sound is rendered to {settings.file}; picture and touch run on"
        engine.status = replace(engine.status, notice=notice)
    return engine


def open_engine_in_step(
    settings: AudioSettings,
    bank: SoundBank,
    clock: Clock,
    file: Path | None,
    latency: int,
    origin_ns: int | None = None,
) -> Engine:
    """Open a mixer that renders on demand into `file` or nowhere; sounds start `latency` frames after their events.

    Raises:
        DeviceError: The library of the requested mixer is missing.
        OSError: The file cannot be written.
    """
    origin = clock.now_ns() if origin_ns is None else origin_ns
    mixer = open_mixer(settings, bank, clock, latency, origin)
    writer = WavWriter(file, mixer.rate, mixer.channels) if file is not None else None
    latency_ms = (latency + mixer.timing.pipeline) / mixer.rate * 1e3
    sink = "file" if writer else "null"
    return Engine(_status(settings, mixer, "loopback", sink, latency_ms), bank, mixer, writer)


def open_mixer(
    settings: AudioSettings, bank: SoundBank, clock: Clock, latency: int, origin_ns: int, *, live: bool = False
) -> OnDemandMixer:
    """Open the mixer that the settings name, rendering on demand; `live`: every block for a device, in its time.

    Raises:
        DeviceError: Its library is missing.
        SceneError: The SOFA file of the head cannot be used.
    """
    kind = find_mixer(settings.mixer)
    if missing := kind.lacks(settings.speakers, head=settings.sofa is not None):
        raise DeviceError(f'the mixer "{settings.mixer}" plays no {missing}', 'take "spectral"')
    return kind.open(MixerRequest(settings, bank, clock, Timing(origin_ns, latency), live))


def _status(settings: AudioSettings, mixer: Mixer, device: str, sink: str, latency_ms: float) -> AudioStatus:
    return AudioStatus(device, sink, mixer.hrtf, mixer.rate, latency_ms, mixer=settings.mixer, channels=mixer.channels)


def open_device(settings: AudioSettings, bank: SoundBank, clock: Clock) -> Engine:
    """Open a live device: a stream to the sound server, or else a device of OpenAL, which knows those of every system.

    Raises:
        DeviceError: There is none, it cannot be opened, or the mix is one for files.
    """
    if settings.channels not in PULSE.POSITIONS:
        raise DeviceError(f"no live device supports {settings.speakers} sound of {settings.channels} channels")
    if settings.driver in ("", "pulse"):
        with suppress(DeviceError):
            from mimics_app.rendering.audio.pulse_stream import PulseStream

            stream = PulseStream(settings.rate, settings.period, clock, settings.channels)
            return _open_streamed(stream, settings, bank, clock)
    own = find_mixer(settings.mixer).open_device
    if own is not None:
        device = own(settings, bank, clock)
        return Engine(
            _status(settings, device.mixer, device.name, "device", device.latency_ms), bank, device.mixer, None
        )
    from mimics_app.rendering.audio.openal_context import OpenALContext
    from mimics_app.rendering.audio.openal_library import load_library
    from mimics_app.rendering.audio.openal_stream import OpenALStream

    context = OpenALContext(load_library(settings), settings.rate, False, 1, loopback=False)
    return _open_streamed(OpenALStream(context), settings, bank, clock)


def _open_streamed(stream: SoundStream, settings: AudioSettings, bank: SoundBank, clock: Clock) -> Engine:
    """Open the mixer that the settings name and play its blocks on a stream, which is closed where that fails."""
    try:
        mixer = open_mixer(settings, bank, clock, 0, 0, live=True)
        if mixer.channels != stream.channels:
            what = f"without a sound server (PulseAudio, PipeWire) a device has two channels, not {mixer.channels}"
            raise DeviceError(what)
        if mixer.rate != stream.rate:
            raise DeviceError(f"the device runs at {stream.rate} Hz, not at {mixer.rate}")
        streamed = StreamedMixer(mixer, stream, clock, settings.queue_ms)
    except DeviceError:
        stream.close()
        raise
    status = _status(settings, mixer, stream.name, "device", streamed.latency / mixer.rate * 1e3)
    return Engine(status, bank, streamed, None)


def _dropped(notice: str) -> Engine:
    return Engine(replace(_SILENT, notice=notice), None, None, None)
