"""An OpenAL context on a live device, or on a loopback that renders on demand."""

from __future__ import annotations

import ctypes

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.errors import DeviceError
from mimics_app.rendering.audio.openal_library import AL, ALC, DEVICE_PERIODS, OpenALLibrary, quiet_stderr

__all__ = ["OpenALContext", "measure_pipeline"]


class OpenALContext:
    """A device of the library with one context.

    Attributes:
        library: Library of the device.
        loopback: True when it renders on demand.
        name: The library's name of the device, or "loopback".
        rate: Actual samples per second.
        hrtf: True when the head-related filters are on.
        period: Actual frames per period of a live device.
    """

    def __init__(self, library: OpenALLibrary, rate: int, hrtf: bool, voices: int, *, loopback: bool) -> None:
        self.library = library
        self.loopback = loopback
        self._call = library.call
        with quiet_stderr():
            device = self._call.alcLoopbackOpenDeviceSOFT(None) if loopback else self._call.alcOpenDevice(None)
        if not device:
            raise DeviceError("no audio device")
        self._device: int | None = device
        try:
            self._context: int | None = self._create_context(rate, hrtf, voices)
        except DeviceError:
            self.close()
            raise
        self.rate = self._integer(ALC.FREQUENCY)
        self.hrtf = bool(self._integer(ALC.HRTF))
        self.period = round(self.rate / max(self._integer(ALC.REFRESH), 1))
        self.name = "loopback" if loopback else self._device_name()

    def activate(self) -> None:
        """Make this the current context of the library."""
        self._call.alcMakeContextCurrent(self._context)

    def render_into(self, out: NDArray[np.float32]) -> None:
        """Render into `out`, shape [frames, 2], C order; loopback only."""
        self._call.alcRenderSamplesSOFT(self._device, out.ctypes.data, len(out))

    @property
    def connected(self) -> bool:
        """False once the device has gone (unplugged, server stopped)."""
        return bool(self._integer(ALC.CONNECTED, default=1))

    @property
    def buffered_ms(self) -> float:
        """Latency from the start of a sound to its first sample at the device's output [ms].

        One period of waiting plus the queued ones, or the library's own figure where that is larger and credible: on
        some servers it is 0 or 80 ms before the stream has run.
        """
        queued = (1 + DEVICE_PERIODS) * self.period / self.rate * 1e3
        latency = (ctypes.c_int64 * 1)()
        self._call.alcGetInteger64vSOFT(self._device, ALC.DEVICE_LATENCY, 1, latency)
        self._call.alcGetError(self._device)
        reported = latency[0] * 1e-6
        return max(queued, reported) if 0.0 < reported < 500.0 else queued

    def close(self) -> None:
        """Close context and device; a second call does nothing."""
        if getattr(self, "_context", None):
            if self._call.alcGetCurrentContext() == self._context:  # the current context may be another one
                self._call.alcMakeContextCurrent(None)
            self._call.alcDestroyContext(self._context)
            self._context = None
        if self._device:
            self._call.alcCloseDevice(self._device)
            self._device = None

    def _create_context(self, rate: int, hrtf: bool, voices: int) -> int:
        attributes = [ALC.FREQUENCY, rate, ALC.HRTF, int(hrtf), ALC.MONO_SOURCES, voices]
        if self.loopback:
            attributes += [ALC.FORMAT_CHANNELS, ALC.STEREO, ALC.FORMAT_TYPE, ALC.FLOAT, ALC.OUTPUT_LIMITER, 0]
        if hrtf:
            attributes += self._filters_for(rate)
        attributes.append(0)
        context = self._call.alcCreateContext(self._device, (ctypes.c_int * len(attributes))(*attributes))
        if not context or not self._call.alcMakeContextCurrent(context):
            raise DeviceError(f"no audio context: {self.library.device_error(self._device)}")
        self._call.alDistanceModel(AL.INVERSE_DISTANCE_CLAMPED)
        self.library.check("set the distance model")
        return int(context)

    def _filters_for(self, rate: int) -> list[int]:
        """Return the attributes that select filters of this rate: a device runs at the rate of its filters."""
        for index in range(self._integer(ALC.NUM_HRTF_SPECIFIERS)):
            name = self._call.alcGetStringiSOFT(self._device, ALC.HRTF_SPECIFIER, index)
            if name and str(rate) in name.decode(errors="replace"):
                return [ALC.HRTF_ID, index]
        return []

    def _integer(self, name: int, default: int = 0) -> int:
        value = ctypes.c_int(default)
        self._call.alcGetIntegerv(self._device, name, 1, ctypes.byref(value))
        self._call.alcGetError(self._device)
        return value.value

    def _device_name(self) -> str:
        name = self._call.alcGetString(self._device, ALC.ALL_DEVICES_SPECIFIER)
        return name.decode(errors="replace") if name else "unnamed"


def measure_pipeline(library: OpenALLibrary, rate: int, hrtf: bool) -> int:
    """Return the frames from the start of a sound to its first sample in the mix, a constant of the library."""
    context = OpenALContext(library, rate, hrtf, 1, loopback=True)
    call = library.call
    try:
        context.activate()
        source, buffer = ctypes.c_uint(), ctypes.c_uint()
        call.alGenSources(1, ctypes.byref(source))
        call.alGenBuffers(1, ctypes.byref(buffer))
        ones = np.ones(256, np.float32)
        call.alBufferData(buffer.value, AL.FORMAT_MONO_FLOAT32, ones.ctypes.data, ones.nbytes, rate)
        call.alSource3f(source.value, AL.POSITION, 0.0, 0.0, -1.0)
        call.alSourcei(source.value, AL.BUFFER, buffer.value)
        out = np.zeros((256, 2), np.float32)
        context.render_into(out)
        call.alSourcePlay(source.value)
        library.check("play a probe")
        context.render_into(out)
        sounding = np.flatnonzero(np.abs(out).max(axis=1) > 1e-4)
        if len(sounding) == 0:
            raise DeviceError("the OpenAL library renders silence")
        return int(sounding[0])
    finally:
        context.close()
