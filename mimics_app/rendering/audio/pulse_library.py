"""Bindings of the client library of PulseAudio, which PipeWire serves too: the only module that knows its C interface.

Only calls without callbacks are bound: the audio process polls, so that no code of ours runs in a foreign thread.
"""

from __future__ import annotations

import ctypes
from collections.abc import Mapping
from types import SimpleNamespace
from typing import Any, ClassVar

from mimics_app.contracts.errors import DeviceError

__all__ = ["PULSE", "BufferSizes", "ChannelMap", "SampleFormat", "load_pulse"]

_NAME = "libpulse.so.0"


class PULSE:
    """Constants of pulse/def.h and pulse/sample.h used here."""

    FLOAT32LE = 5
    NO_AUTOSPAWN = 0x1
    INTERPOLATE_TIMING = 0x2
    AUTO_TIMING_UPDATE = 0x8
    EARLY_REQUESTS = 0x4000
    CONTEXT_READY = 4
    STREAM_READY = 2
    SEEK_RELATIVE = 0
    SERVER_DEFAULT = 0xFFFFFFFF
    POSITIONS: ClassVar[Mapping[int, tuple[int, ...]]] = {
        2: (1, 2),
        6: (1, 2, 3, 7, 5, 6),
        8: (1, 2, 3, 7, 5, 6, 10, 11),
    }
    """Positions (pulse/channelmap.h) of the channels of a mix: front left, right, middle, low, rear pair, sides."""


class SampleFormat(ctypes.Structure):
    """pa_sample_spec."""

    _fields_ = (("format", ctypes.c_int), ("rate", ctypes.c_uint32), ("channels", ctypes.c_uint8))


class ChannelMap(ctypes.Structure):
    """pa_channel_map: number of channels, and the position of each."""

    _fields_ = (("channels", ctypes.c_uint8), ("positions", ctypes.c_int * 32))


class BufferSizes(ctypes.Structure):
    """pa_buffer_attr [bytes]."""

    _fields_ = tuple((name, ctypes.c_uint32) for name in ("longest", "target", "prebuffer", "request", "fragment"))


class _TimingInfo(ctypes.Structure):
    """The beginning of pa_timing_info."""

    _fields_ = (
        ("seconds", ctypes.c_long),
        ("microseconds", ctypes.c_long),
        ("synchronised", ctypes.c_int),
        ("sink_us", ctypes.c_uint64),
        ("source_us", ctypes.c_uint64),
        ("transport_us", ctypes.c_uint64),
        ("playing", ctypes.c_int),
    )


_pointer, _int, _text, _size = ctypes.c_void_p, ctypes.c_int, ctypes.c_char_p, ctypes.c_size_t

_SIGNATURES: dict[str, tuple[Any, list[Any]]] = {
    "pa_mainloop_new": (_pointer, []),
    "pa_mainloop_get_api": (_pointer, [_pointer]),
    "pa_mainloop_iterate": (_int, [_pointer, _int, _pointer]),
    "pa_mainloop_free": (None, [_pointer]),
    "pa_context_new": (_pointer, [_pointer, _text]),
    "pa_context_connect": (_int, [_pointer, _text, _int, _pointer]),
    "pa_context_get_state": (_int, [_pointer]),
    "pa_context_disconnect": (None, [_pointer]),
    "pa_context_unref": (None, [_pointer]),
    "pa_context_errno": (_int, [_pointer]),
    "pa_strerror": (_text, [_int]),
    "pa_stream_new": (
        _pointer,
        [_pointer, _text, ctypes.POINTER(SampleFormat), ctypes.POINTER(ChannelMap)],
    ),
    "pa_stream_connect_playback": (
        _int,
        [_pointer, _text, ctypes.POINTER(BufferSizes), _int, _pointer, _pointer],
    ),
    "pa_stream_get_state": (_int, [_pointer]),
    "pa_stream_get_device_name": (_text, [_pointer]),
    "pa_stream_get_buffer_attr": (ctypes.POINTER(BufferSizes), [_pointer]),
    "pa_stream_get_timing_info": (ctypes.POINTER(_TimingInfo), [_pointer]),
    "pa_stream_get_underflow_index": (ctypes.c_int64, [_pointer]),
    "pa_stream_writable_size": (_size, [_pointer]),
    "pa_stream_write": (_int, [_pointer, _pointer, _size, _pointer, ctypes.c_int64, _int]),
    "pa_stream_disconnect": (_int, [_pointer]),
    "pa_stream_unref": (None, [_pointer]),
}


def load_pulse() -> Any:
    """Return the functions of the library by their C names.

    Raises:
        DeviceError: The system has no such library, or one without these functions.
    """
    try:
        handle = ctypes.CDLL(_NAME)
        functions = {name: getattr(handle, name) for name in _SIGNATURES}
    except (OSError, AttributeError) as error:
        raise DeviceError(f"no client library of PulseAudio ({_NAME})") from error
    for name, (result, arguments) in _SIGNATURES.items():
        functions[name].restype, functions[name].argtypes = result, arguments
    return SimpleNamespace(**functions)
