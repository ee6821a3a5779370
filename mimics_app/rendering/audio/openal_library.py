"""Bindings of OpenAL Soft: the only module that knows the library's C interface.

PyOpenAL locates the library where it has an unusual name. Its wrappers lack loopback, HRTF and float formats and report
errors as `ALC_OUT_OF_MEMORY`; therefore the library is loaded through a second handle, whose function objects do not
carry PyOpenAL's error hooks. The library reads its configuration once, when the first device opens. Ours is written
before that, as the defaults break the 20 ms from contact to sound (1024 x 3 frames: 51 ms).
"""

from __future__ import annotations

import ctypes
import os
import signal
import sys
import tempfile
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from mimics_app.contracts.errors import DeviceError
from mimics_app.rendering.audio.settings import AudioSettings

__all__ = ["AL", "ALC", "OpenALLibrary", "load_library", "quiet_stderr"]

_INSTALL_LINE = "apt-get install libopenal1"
_USUAL_NAME = "libopenal.so.1"
"""File name of the library on Linux."""


DEVICE_PERIODS = 3
"""Queued periods of a live device; with two, a sound server that is one period late causes a gap (decision 020)."""


class ALC:
    """Constants of alc.h and alext.h used here."""

    FREQUENCY = 0x1007
    REFRESH = 0x1008
    MONO_SOURCES = 0x1010
    ALL_DEVICES_SPECIFIER = 0x1013
    CONNECTED = 0x313
    FORMAT_CHANNELS = 0x1990
    FORMAT_TYPE = 0x1991
    STEREO = 0x1501
    FLOAT = 0x1406
    HRTF = 0x1992
    NUM_HRTF_SPECIFIERS = 0x1994
    HRTF_SPECIFIER = 0x1995
    HRTF_ID = 0x1996
    OUTPUT_LIMITER = 0x199A
    DEVICE_LATENCY = 0x1601


class AL:
    """Constants of al.h and alext.h used here."""

    CONE_INNER_ANGLE = 0x1001
    CONE_OUTER_ANGLE = 0x1002
    DIRECTION = 0x1005
    VELOCITY = 0x1006
    CONE_OUTER_GAIN = 0x1022
    SOURCE_RELATIVE = 0x202
    PITCH = 0x1003
    POSITION = 0x1004
    LOOPING = 0x1007
    BUFFER = 0x1009
    GAIN = 0x100A
    ORIENTATION = 0x100F
    SOURCE_STATE = 0x1010
    PLAYING = 0x1012
    BUFFERS_PROCESSED = 0x1016
    SAMPLE_OFFSET = 0x1025
    DIRECT_CHANNELS = 0x1033
    STOPPED = 0x1014
    REFERENCE_DISTANCE = 0x1020
    ROLLOFF_FACTOR = 0x1021
    MAX_DISTANCE = 0x1023
    FORMAT_MONO_FLOAT32 = 0x10010
    FORMAT_STEREO_FLOAT32 = 0x10011
    MAP_WRITE = 0x2
    MAP_PERSISTENT = 0x4
    VERSION = 0xB002
    INVERSE_DISTANCE_CLAMPED = 0xD002


_pointer, _int, _uint, _float, _text, _bool = (
    ctypes.c_void_p,
    ctypes.c_int,
    ctypes.c_uint,
    ctypes.c_float,
    ctypes.c_char_p,
    ctypes.c_uint8,
)

_SIGNATURES: dict[str, tuple[Any, list[Any]]] = {
    "alcOpenDevice": (_pointer, [_text]),
    "alcCloseDevice": (_bool, [_pointer]),
    "alcLoopbackOpenDeviceSOFT": (_pointer, [_text]),
    "alcRenderSamplesSOFT": (None, [_pointer, _pointer, _int]),
    "alcCreateContext": (_pointer, [_pointer, ctypes.POINTER(_int)]),
    "alcMakeContextCurrent": (_bool, [_pointer]),
    "alcDestroyContext": (None, [_pointer]),
    "alcGetCurrentContext": (_pointer, []),
    "alcGetError": (_int, [_pointer]),
    "alcGetString": (_text, [_pointer, _int]),
    "alcGetIntegerv": (None, [_pointer, _int, _int, ctypes.POINTER(_int)]),
    "alcGetStringiSOFT": (_text, [_pointer, _int, _int]),
    "alcGetInteger64vSOFT": (None, [_pointer, _int, _int, ctypes.POINTER(ctypes.c_int64)]),
    "alGetError": (_int, []),
    "alGetString": (_text, [_int]),
    "alGenSources": (None, [_int, ctypes.POINTER(_uint)]),
    "alDeleteSources": (None, [_int, ctypes.POINTER(_uint)]),
    "alGenBuffers": (None, [_int, ctypes.POINTER(_uint)]),
    "alDeleteBuffers": (None, [_int, ctypes.POINTER(_uint)]),
    "alBufferData": (None, [_uint, _int, _pointer, _int, _int]),
    "alSourcef": (None, [_uint, _int, _float]),
    "alSource3f": (None, [_uint, _int, _float, _float, _float]),
    "alSourcei": (None, [_uint, _int, _int]),
    "alGetSourcei": (None, [_uint, _int, ctypes.POINTER(_int)]),
    "alSourcePlay": (None, [_uint]),
    "alSourceQueueBuffers": (None, [_uint, _int, ctypes.POINTER(_uint)]),
    "alSourceUnqueueBuffers": (None, [_uint, _int, ctypes.POINTER(_uint)]),
    "alSourceStop": (None, [_uint]),
    "alListener3f": (None, [_int, _float, _float, _float]),
    "alListenerf": (None, [_int, _float]),
    "alListenerfv": (None, [_int, ctypes.POINTER(_float)]),
    "alDistanceModel": (None, [_int]),
}

_OPTIONAL: dict[str, tuple[Any, list[Any]]] = {
    "alBufferStorageSOFT": (None, [_uint, _int, _pointer, _int, _int, _uint]),
    "alMapBufferSOFT": (_pointer, [_uint, _int, _int, _uint]),
}
"""Functions of AL_SOFT_map_buffer: buffers written while they play. Without them, contacts play recordings."""

_ERRORS = {
    0xA001: "invalid name or device",
    0xA002: "invalid enum or context",
    0xA003: "invalid enum",
    0xA004: "invalid value or operation",
    0xA005: "out of memory, or no device",
}


class OpenALLibrary:
    """The functions of one OpenAL Soft library, with explicit checks.

    Attributes:
        path: Path or name that was loaded.
        call: Functions by their C names.
        maps: Whether AL_SOFT_map_buffer is available.
    """

    def __init__(self, path: str) -> None:
        self.path = path
        handle = ctypes.CDLL(path)
        self.call: Any = SimpleNamespace()
        for name, (result, arguments) in _SIGNATURES.items():
            try:
                function = getattr(handle, name)
            except AttributeError as error:
                raise DeviceError(f"{path} has no {name}: it is not OpenAL Soft", _INSTALL_LINE) from error
            function.restype, function.argtypes = result, arguments
            setattr(self.call, name, function)
        self.maps = all(hasattr(handle, name) for name in _OPTIONAL)
        for name, (result, arguments) in _OPTIONAL.items() if self.maps else ():
            function = getattr(handle, name)
            function.restype, function.argtypes = result, arguments
            setattr(self.call, name, function)

    def check(self, what: str) -> None:
        """Raise DeviceError if a call since the last check has failed."""
        code = self.call.alGetError()
        if code:
            raise DeviceError(f"OpenAL could not {what}: {_ERRORS.get(code, hex(code))}")

    def device_error(self, device: int | None) -> str:
        """Return the error of a device, or of the library (None), in words; "" when there is none."""
        code = self.call.alcGetError(device)
        return _ERRORS.get(code, hex(code)) if code else ""


_loaded: dict[str, OpenALLibrary] = {}


def load_library(settings: AudioSettings) -> OpenALLibrary:
    """Return the library of this process; the first call fixes its configuration.

    Raises:
        DeviceError: No library is found, or it is not OpenAL Soft; the fix names the package.
    """
    if settings.library not in _loaded:
        path = settings.library or _find()
        with _configuration(settings), quiet_stderr():
            try:
                library = OpenALLibrary(path)
            except OSError as error:
                raise DeviceError(f"the OpenAL library {path} cannot be loaded", _INSTALL_LINE) from error
            # The library reads its configuration when a device first opens; the file can be deleted then.
            first = library.call.alcLoopbackOpenDeviceSOFT(None)
            if first:
                library.call.alcCloseDevice(first)
        _loaded[settings.library] = library
    return _loaded[settings.library]


def _find() -> str:
    """Find the library by its usual name, else by PyOpenAL, whose search is far slower: it runs a compiler."""
    if sys.platform.startswith("linux"):
        with suppress(OSError):
            ctypes.CDLL(_USUAL_NAME)
            return _USUAL_NAME
    return _find_by_pyopenal()


def _find_by_pyopenal() -> str:
    path_before = os.environ.get("PATH", "")
    try:
        with _signals_held():
            from openal.al_lib import lib
    except ImportError:
        found = _find_without_pyopenal()
    except Exception as error:  # PyOpenAL raises a class of its own
        raise DeviceError(f"no OpenAL library ({type(error).__name__})", _INSTALL_LINE) from error
    else:
        found = str(lib._name)
    finally:
        os.environ["PATH"] = path_before  # PyOpenAL appends the working directory to it
    return found


@contextmanager
def _signals_held() -> Iterator[None]:
    """Defer signals that end the program: PyOpenAL has bare `except:` clauses, which would swallow Ctrl-C."""
    came: list[int] = []
    names = ("SIGINT", "SIGTERM", "SIGHUP") if threading.current_thread() is threading.main_thread() else ()
    numbers = [getattr(signal, name) for name in names if hasattr(signal, name)]
    before = {number: signal.getsignal(number) for number in numbers}
    ours = {number: handler for number, handler in before.items() if callable(handler)}
    for number in ours:
        signal.signal(number, lambda number, _frame: came.append(number))
    try:
        yield
    finally:
        for number, handler in ours.items():
            signal.signal(number, handler)
        for number in came[:1]:
            signal.raise_signal(number)


def _find_without_pyopenal() -> str:
    from ctypes.util import find_library

    for name in ("openal", "soft_oal", "OpenAL32"):
        found = find_library(name)
        if found:
            return found
    raise DeviceError("no OpenAL library", _INSTALL_LINE)


def _configuration_text(settings: AudioSettings) -> str:
    """Return a configuration that fixes latency and samples, whatever files the user or the system has."""
    drivers = f"drivers = {settings.driver}\n" if settings.driver else ""
    values = {"drivers": drivers, "rate": settings.rate, "period": settings.period, "periods": DEVICE_PERIODS}
    return Path(__file__).with_name("alsoft.conf").read_text(encoding="utf-8").format(**values)


@contextmanager
def _configuration(settings: AudioSettings) -> Iterator[None]:
    handle, name = tempfile.mkstemp(prefix="mimics-", suffix=".alsoft")
    os.write(handle, _configuration_text(settings).encode())
    os.close(handle)
    before = os.environ.get("ALSOFT_CONF")
    os.environ["ALSOFT_CONF"] = name
    try:
        yield
    finally:
        Path(name).unlink(missing_ok=True)
        if before is None:
            del os.environ["ALSOFT_CONF"]
        else:
            os.environ["ALSOFT_CONF"] = before


@contextmanager
def quiet_stderr() -> Iterator[None]:
    """Redirect file descriptor 2 to /dev/null: sound libraries print many lines where there is no sound card."""
    saved = os.dup(2)
    null = os.open(os.devnull, os.O_WRONLY)
    os.dup2(null, 2)
    os.close(null)
    try:
        yield
    finally:
        os.dup2(saved, 2)
        os.close(saved)
