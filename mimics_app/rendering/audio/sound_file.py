"""Sound files, read by libsndfile in blocks."""

from __future__ import annotations

import io
import math
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.errors import Issue, SceneError
from mimics_app.contracts.system.read_budget import afford
from mimics_app.contracts.system.regular_file import open_regular

if TYPE_CHECKING:
    import soundfile

__all__ = ["check_sound_file", "is_streamed", "read_sound", "stream_sound"]

_HELD_S = 60.0
"""Longest sound that is held in memory as a whole [s]; a longer one is read while it plays."""

_LONGEST_S = 12 * 3600.0
"""Longest sound that is read [s]."""

_LARGEST_BYTES = 1 << 30
_MIX_RATE = 48_000
"""Rate at which a sound of a scene is held [Hz]."""
_RATES = range(1000, 768_001)
_BLOCK = 1 << 20
"""Frames that are resampled at once; a shorter sound in one piece."""
_PART = 1 << 16
"""Samples, at the rate of the mix, of a part of a sound that is read while it plays; a second at unusual rates."""
_FADE = 1 << 13
"""Frames by which the blocks of a longer sound overlap on each side."""


def check_sound_file(path: Path, inside: int | None, whole: bool) -> None:
    """Check that a file, or sound number `inside` of a model, can be played, by its header or by all of its samples.

    Of a sound that is read while it plays the first and the last samples count.

    Raises:
        SceneError: See `read_sound`.
    """
    with _opened(path, inside) as sound:
        if _is_long(sound):
            _afford_part(path, sound)
            next(_resampled(path, sound, _MIX_RATE, _part_of(sound, _MIX_RATE)))
            sound.seek(sound.frames - 1)
            if not len(sound.read(1)):
                raise _refused(path, "is cut off before the length that its header states")
            return
        _afford(path, sound, _MIX_RATE)
        for _ in _resampled(path, sound, sound.samplerate, _BLOCK) if whole else ():
            pass


def is_streamed(path: Path, inside: int | None = None) -> bool:
    """Return whether a sound is so long that it is read while it plays.

    Raises:
        SceneError: See `read_sound`.
    """
    with _opened(path, inside) as sound:
        return _is_long(sound)


def read_sound(path: Path, rate: int, inside: int | None = None) -> NDArray[np.float32]:
    """Read a sound file, or sound number `inside` of a model, at `rate` [Hz]; shape [n, channels].

    Raises:
        SceneError: The file is missing, damaged, too long, or of an unknown format.
    """
    with _opened(path, inside) as sound:
        count = _afford(path, sound, rate)
        samples, written = np.empty((count, sound.channels), np.float32), 0
        for block in _resampled(path, sound, rate, _BLOCK):
            samples[written : written + len(block)] = block
            written += len(block)
    return samples[:written]


def stream_sound(path: Path, rate: int, inside: int | None = None) -> Iterator[NDArray[np.float32]]:
    """Yield a sound at `rate` [Hz] from its beginning in parts of about a second, shape [n, channels].

    Raises:
        SceneError: See `read_sound`; also between two parts.
    """
    with _opened(path, inside) as sound:
        _afford_part(path, sound)
        for block in _resampled(path, sound, rate, _part_of(sound, rate)):
            yield block.astype(np.float32)


@contextmanager
def _opened(path: Path, inside: int | None) -> Iterator[soundfile.SoundFile]:
    """Open a sound whose header is plausible; raises as `read_sound`, also for faults found while it is open."""
    import soundfile

    try:
        with _stream(path, inside) as stream, soundfile.SoundFile(stream) as sound:
            if sound.frames > _LONGEST_S * sound.samplerate:
                raise _refused(path, f"lasts {sound.frames / sound.samplerate:.0f} s", f"{_LONGEST_S:.0f} s at most")
            if sound.frames == 0 or sound.samplerate not in _RATES:
                raise _refused(path, f"holds no sound, at {sound.samplerate} Hz")
            yield sound
    except (MemoryError, OSError, RuntimeError, ValueError) as error:
        why = str(error).rpartition(": ")[2]
        raise _refused(path, f"cannot be read as a sound ({why[:80]})", "save it as WAV, FLAC or OGG") from error


def _is_long(sound: soundfile.SoundFile) -> bool:
    return bool(sound.frames > _HELD_S * sound.samplerate)


def _afford(path: Path, sound: soundfile.SoundFile, rate: int) -> int:
    """Return the number of frames that a sound has at a rate, if they fit in memory."""
    count = round(sound.frames * rate / sound.samplerate)
    afford(str(path), "", 4 * sound.channels * max(count, sound.frames), "save it with fewer channels")
    return count


def _part_of(sound: soundfile.SoundFile, rate: int) -> int:
    """Return the frames of a file that make a part at a rate."""
    return max(1, _PART * sound.samplerate // rate)


def _afford_part(path: Path, sound: soundfile.SoundFile) -> None:
    """Refuse a sound of which not even one part fits in memory, with what is decoded on both sides of it."""
    part = 3 * max(_part_of(sound, _MIX_RATE), sound.samplerate, _FADE)
    afford(str(path), "", 8 * sound.channels * part, "save it with fewer channels")


def _stream(path: Path, inside: int | None) -> io.BufferedIOBase:
    if inside is not None:
        return io.BytesIO(_taken_out(path, inside))
    try:
        stream = open_regular(path)
    except OSError as error:
        raise _refused(path, f"cannot be read: {error.strerror}") from error
    if (size := stream.seek(0, io.SEEK_END)) > _LARGEST_BYTES:
        stream.close()
        raise _refused(path, f"has {size / 1e9:.1f} GB", "a sound has 1 GB at most: cut it, or save it as OGG")
    stream.seek(0)
    return stream


def _resampled(path: Path, sound: soundfile.SoundFile, rate: int, size: int) -> Iterator[NDArray[np.float64]]:
    """Yield the samples at a rate in blocks of about `size` frames, shape [n, channels].

    They overlap and are faded before resampling.
    """
    own = sound.samplerate
    unit = own // math.gcd(own, rate)  # frames after which both rates have a sample at the same time
    step = max(size // unit, 1) * unit
    margin = 0 if rate == own else -(-_FADE // unit) * unit
    fade = 0.5 - 0.5 * np.cos(np.pi * (np.arange(margin) + 0.5) / max(margin, 1))
    for start in range(0, sound.frames, step):
        before = min(start, margin)
        sound.seek(start - before)
        block = sound.read(before + step + margin, dtype="float64", always_2d=True)
        if not np.isfinite(block).all():
            raise _refused(path, "holds values that are not finite")
        kept, after = min(len(block) - before, step), max(len(block) - before - step, 0)
        if kept <= 0:
            return  # cut off before the length that its header states
        block[:before] *= fade[:before, None]
        block[len(block) - after :] *= fade[::-1][:after, None]
        first = before * rate // own
        channels = [_resample(each, own, rate)[first : first + round(kept * rate / own)] for each in block.T]
        yield np.stack(channels, axis=1)


def _resample(samples: NDArray[np.float64], rate_in: int, rate_out: int) -> NDArray[np.float64]:
    """Resample by truncating or zero-padding the spectrum, exact for content below both Nyquist frequencies."""
    if rate_in == rate_out:
        return samples
    unit = rate_in // math.gcd(rate_in, rate_out)  # a whole number of which is a whole number of samples at both rates
    pad = rate_in // 10  # so that the end does not wrap around to the beginning
    padded = np.concatenate([samples, np.zeros(pad + -(len(samples) + pad) % unit)])
    count = len(padded) // unit * (rate_out * unit // rate_in)
    resampled = np.fft.irfft(np.fft.rfft(padded)[: count // 2 + 1], count) * (count / len(padded))
    return resampled[: round(len(samples) * rate_out / rate_in)]


def _taken_out(model: Path, number: int) -> bytes:
    from mimics_app.world.files.gltf.sounds import read_embedded_sound

    return read_embedded_sound(model, number)


def _refused(path: Path, what: str, fix: str = "") -> SceneError:
    return SceneError(Issue(str(path), "", what, fix))
