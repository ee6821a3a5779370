"""Opens the output a session requested, or the next one down the ladder, and keeps it fed.

    device  -> a live device, drawn by the library's own thread
    file    -> a loopback, rendered on the clock in blocks and written to a wave file
    null    -> nothing: the events are read and forgotten

Where the wish cannot be had the session goes on with one clear line about what became of its sound.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from mimics_app.contracts.audio_port import AudioStatus, Mixer, Timing
from mimics_app.contracts.clock import Clock
from mimics_app.contracts.errors import DeviceError, SceneError
from mimics_app.rendering.audio.bank import SoundBank
from mimics_app.rendering.audio.openal_context import OpenALContext, measure_pipeline
from mimics_app.rendering.audio.openal_library import OpenALLibrary, load_library
from mimics_app.rendering.audio.openal_mixer import OpenALMixer
from mimics_app.rendering.audio.settings import AudioSettings
from mimics_app.rendering.audio.wav_file import WavWriter

__all__ = ["Engine", "fall_back", "open_device", "open_engine", "open_engine_in_step", "open_mixer"]

_SILENT = AudioStatus(device="none", sink="null", hrtf=False, rate=0, latency_ms=0.0)


class Engine:
    """What is open: a mixer, perhaps a file behind it, and the status that says so.

    Attributes:
        status: As the app gets it.
        bank: The sounds.
        mixer: None where sound is dropped.
        writer: None where no file is written.
    """

    def __init__(
        self, status: AudioStatus, bank: SoundBank | None, mixer: Mixer | None, writer: WavWriter | None
    ) -> None:
        self.status = status
        self.bank = bank
        self.mixer = mixer
        self.writer = writer

    @property
    def live(self) -> bool:
        """True where the library's own thread draws the sound."""
        return self.status.sink == "device"

    def render_to(self, frame: int, block: int) -> int:
        """Render a loopback up to a frame in blocks, into the file; return how many blocks that took.

        Raises:
            DeviceError: The file takes no more.
        """
        if self.mixer is None or self.live:
            return 0
        blocks = 0
        while self.mixer.position < frame:
            samples = self.mixer.render(min(block, frame - self.mixer.position))
            if self.writer is not None:
                try:
                    self.writer.append(samples)
                except OSError as error:
                    raise DeviceError(f"{self.writer.path}: {error.strerror}") from error
            blocks += 1
        return blocks

    def close(self) -> None:
        """Close device and file."""
        if self.mixer is not None:
            self.mixer.close()
        if self.writer is not None:
            self.writer.close()


def open_engine(settings: AudioSettings, clock: Clock, prepared: Callable[[], None] | None = None) -> Engine:
    """The output of a live session, down the ladder; never raises for a missing library or device.

    Args:
        settings: What is wished.
        clock: Of the session.
        prepared: Called when what takes long is done (sounds and head made, kernels loaded) and nothing is open yet.
    """
    try:
        if settings.mixer == "openal":
            load_library(settings)
        bank = SoundBank(settings.sounds, settings.rate)
        if settings.mixer == "spectral":
            _warm_spectral(settings, bank)
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
    """A file where one is named, else nothing; `why` begins the line the person reads, "" when it was requested."""
    if settings.file is None:
        return _dropped(f"{why}: sound is dropped; picture and touch run on")
    try:
        # A block of slack, a block to fill, and a millisecond for the tick's own work before its event is in the ring.
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
    """A mixer that renders on demand, whose sounds start `latency` frames after their events, into `file` or nowhere.

    Raises:
        DeviceError: No library for the mixer that is requested.
        OSError: The file cannot be written.
    """
    origin = clock.now_ns() if origin_ns is None else origin_ns
    mixer = open_mixer(settings, bank, clock, latency, origin)
    writer = WavWriter(file, mixer.rate, mixer.channels) if file is not None else None
    latency_ms = (latency + mixer.timing.pipeline) / mixer.rate * 1e3
    sink = "file" if writer else "null"
    return Engine(_status(settings, mixer, "loopback", sink, latency_ms), bank, mixer, writer)


def open_mixer(settings: AudioSettings, bank: SoundBank, clock: Clock, latency: int, origin_ns: int) -> Mixer:
    """The mixer the settings name, rendering on demand.

    Raises:
        DeviceError: There is no library for it.
        SceneError: The head it is to take cannot be used.
    """
    if settings.mixer == "spectral":
        from mimics_app.rendering.audio.spectral.mixer import SpectralMixer

        return SpectralMixer(bank, settings, Timing(origin_ns, latency))
    library = load_library(settings)
    pipeline = measure_pipeline(library, settings.rate, settings.hrtf)
    context = OpenALContext(library, settings.rate, settings.hrtf, settings.sources, loopback=True)
    return OpenALMixer(context, bank, settings, clock, Timing(origin_ns, latency, pipeline))


def _status(settings: AudioSettings, mixer: Mixer, device: str, sink: str, latency_ms: float) -> AudioStatus:
    hrtf = mixer.context.hrtf if isinstance(mixer, OpenALMixer) else settings.hrtf
    return AudioStatus(device, sink, hrtf, mixer.rate, latency_ms, mixer=settings.mixer, channels=mixer.channels)


def open_device(settings: AudioSettings, bank: SoundBank, clock: Clock) -> Engine:
    """A live device.

    Raises:
        DeviceError: There is none, or it cannot be opened.
    """
    library = load_library(settings)
    if settings.mixer == "spectral":
        return _open_stream(settings, bank, clock, library)
    context = OpenALContext(library, settings.rate, settings.hrtf, settings.sources, loopback=False)
    pipeline = measure_pipeline(library, context.rate, context.hrtf)
    mixer = OpenALMixer(context, bank, settings, clock, Timing(clock.now_ns(), 0, pipeline))
    latency_ms = context.buffered_ms + pipeline / context.rate * 1e3
    return Engine(_status(settings, mixer, context.name, "device", latency_ms), bank, mixer, None)


def _open_stream(settings: AudioSettings, bank: SoundBank, clock: Clock, library: OpenALLibrary) -> Engine:
    """The spectral mixer on a live device."""
    from mimics_app.rendering.audio.spectral.mixer import SpectralMixer
    from mimics_app.rendering.audio.streamed_mixer import StreamedMixer

    context = OpenALContext(library, settings.rate, False, 1, loopback=False)
    try:
        if context.rate != settings.rate:
            raise DeviceError(f"the device runs at {context.rate} Hz, not at {settings.rate}")
        mixer = StreamedMixer(SpectralMixer(bank, settings, Timing()), context, clock)
    except DeviceError:
        context.close()
        raise
    latency = (mixer.timing.latency + mixer.timing.pipeline) / mixer.rate * 1e3 + context.buffered_ms
    return Engine(_status(settings, mixer, context.name, "device", latency), bank, mixer, None)


def _warm_spectral(settings: AudioSettings, bank: SoundBank) -> None:
    """Make the head's tables and compile, or load, the mixing, before a device or the scheduler waits for it."""
    from mimics_app.rendering.audio.spectral.mixer import SpectralMixer

    mixer = SpectralMixer(bank, settings, Timing())
    for name in list(bank.sounds)[:1]:
        mixer.start(name, 0, (0.0, 0.0, -1.0), 0.0)
    mixer.render(settings.block)


def _dropped(notice: str) -> Engine:
    return Engine(replace(_SILENT, notice=notice), None, None, None)
