"""Sound files, read by libsndfile."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.errors import Issue, SceneError
from mimics_app.contracts.regular_file import read_regular

__all__ = ["frames_of", "read_sound"]

_LONGEST_S = 1800.0
"""Longest sound that is read [s]: half an hour of two channels takes 700 MB of memory."""

_LARGEST_BYTES = 1 << 30
_RATES = range(1000, 768_001)


def read_sound(path: Path, rate: int, inside: int | None = None) -> NDArray[np.float32]:
    """Read a sound file, or sound number `inside` of a model, at `rate` [Hz]; shape [n, channels].

    Raises:
        SceneError: The file is missing, damaged, too long, or of an unknown format.
    """
    frames, own = frames_of(path, inside)
    return np.stack([_resample(each, own, rate) for each in frames.T], axis=1).astype(np.float32)


def frames_of(path: Path, inside: int | None = None) -> tuple[NDArray[np.float64], int]:
    """Read a sound without resampling; return samples, shape [n, channels], and rate [Hz]; raises as `read_sound`."""
    try:
        size = path.stat().st_size
    except OSError as error:
        raise _refused(path, f"cannot be read: {error.strerror}") from error
    if size > _LARGEST_BYTES:
        raise _refused(path, f"has {size / 1e9:.1f} GB", "a sound has 1 GB at most: cut it, or save it as OGG")
    try:
        frames, rate = _decode(path, read_regular(path) if inside is None else _taken_out(path, inside))
    except (MemoryError, OSError, RuntimeError, ValueError) as error:
        why = str(error).rpartition(": ")[2]
        raise _refused(path, f"cannot be read as a sound ({why[:80]})", "save it as WAV, FLAC or OGG") from error
    if len(frames) == 0 or rate not in _RATES or not np.isfinite(frames).all():
        raise _refused(path, f"holds no sound, or values that are not finite, at {rate} Hz")
    return frames, rate


def _decode(path: Path, raw: bytes) -> tuple[NDArray[np.float64], int]:
    """Return samples, shape [n, channels], and their rate; of a sound that is too long, none is decoded.

    Raises:
        SceneError: Its header says that it is too long.
        RuntimeError: libsndfile does not know the format.
    """
    import soundfile

    with soundfile.SoundFile(io.BytesIO(raw)) as sound:
        if sound.frames > _LONGEST_S * sound.samplerate:
            raise _refused(path, f"lasts {sound.frames / sound.samplerate:.0f} s", f"{_LONGEST_S:.0f} s at most")
        return sound.read(dtype="float64", always_2d=True), sound.samplerate


def _resample(samples: NDArray[np.float64], rate_in: int, rate_out: int) -> NDArray[np.float64]:
    """Resample by truncating or zero-padding the spectrum, exact for content below both Nyquist frequencies."""
    if rate_in == rate_out:
        return samples
    pad = rate_in // 10  # padding, so that the end does not wrap around to the beginning
    padded = np.concatenate([samples, np.zeros(pad)])
    count = round(len(padded) * rate_out / rate_in)
    resampled = np.fft.irfft(np.fft.rfft(padded)[: count // 2 + 1], count) * (count / len(padded))
    return resampled[: round(len(samples) * rate_out / rate_in)]


def _taken_out(model: Path, number: int) -> bytes:
    from mimics_app.world.gltf.sounds import read_embedded_sound

    return read_embedded_sound(model, number)


def _refused(path: Path, what: str, fix: str = "") -> SceneError:
    return SceneError(Issue(str(path), "", what, fix))
