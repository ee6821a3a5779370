"""Sound files: WAV by our own reader, OGG and FLAC by libsndfile."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.errors import Issue, SceneError
from mimics_app.contracts.regular_file import read_regular
from mimics_app.rendering.audio.wav_file import read_wav, resample

__all__ = ["read_sound"]

_LONGEST_S = 1800.0
"""Longest sound that is read [s]: half an hour of two channels takes 700 MB of memory."""

_LARGEST_BYTES = 1 << 30


def read_sound(path: Path, rate: int, inside: int | None = None) -> NDArray[np.float32]:
    """Read a sound file, or sound number `inside` of a model, at `rate` [Hz]; shape [n, channels].

    Raises:
        SceneError: The file is missing, damaged, too long, or of an unknown format.
    """
    try:
        size = path.stat().st_size
    except OSError as error:
        raise _refused(path, f"cannot be read: {error.strerror}") from error
    if size > _LARGEST_BYTES:
        raise _refused(path, f"has {size / 1e9:.1f} GB", "a sound has 1 GB at most: cut it, or save it as OGG")
    if path.suffix.lower() == ".wav":
        return read_wav(path, rate)
    try:
        samples, own = _decode(read_regular(path) if inside is None else _taken_out(path, inside))
    except (OSError, RuntimeError, ValueError) as error:
        raise _refused(path, f"cannot be read as a sound ({str(error)[:80]})", "save it as WAV, FLAC or OGG") from error
    if len(samples) == 0 or not np.isfinite(samples).all():
        raise _refused(path, "holds no sound, or values that are not finite")
    if len(samples) > _LONGEST_S * own:
        raise _refused(path, f"lasts {len(samples) / own:.0f} s", f"{_LONGEST_S:.0f} s at most")
    return np.stack([resample(each, own, rate) for each in samples.T], axis=1).astype(np.float32)


def _decode(raw: bytes) -> tuple[NDArray[np.float64], int]:
    """Return samples, shape [n, channels], and their rate. RuntimeError: libsndfile does not know the format."""
    import soundfile

    samples, rate = soundfile.read(io.BytesIO(raw), dtype="float64", always_2d=True)
    return samples, int(rate)


def _taken_out(model: Path, number: int) -> bytes:
    from mimics_app.world.gltf.sounds import read_embedded_sound

    return read_embedded_sound(model, number)


def _refused(path: Path, what: str, fix: str = "") -> SceneError:
    return SceneError(Issue(str(path), "", what, fix))
