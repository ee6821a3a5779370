"""Wave files: a writer whose file is valid after every block, also when its process is killed, and a reader."""

from __future__ import annotations

import errno
import itertools
import os
import struct
from contextlib import suppress
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.errors import Issue, SceneError
from mimics_app.contracts.regular_file import read_regular

__all__ = ["WavWriter", "frames_of_wav", "read_wav", "resample", "soften_peaks", "unused_name"]

_HEADER_SIZE = 44
_LARGEST_DATA = 0xFFFF_FFFF - _HEADER_SIZE
_PCM, _FLOAT, _EXTENSIBLE = 1, 3, 0xFFFE
_KNEE = 0.85
_GIVEN_BACK = 2 << 20


def unused_name(path: Path | None) -> Path | None:
    """Return the path, or the first of name-2, name-3, .. that does not exist; None for None."""
    if path is None or not path.exists():
        return path
    names = (path.with_stem(f"{path.stem}-{number}") for number in itertools.count(2))
    return next(name for name in names if not name.exists())


class WavWriter:
    """Writer of a 16-bit wave file that is valid at any time.

    The sizes in the header are updated after each block, so that the file can be read to its last block; a kill between
    the two writes leaves one block beyond the stated end, which readers skip.

    Attributes:
        frames: Frames written so far.
        clipped: Samples above the limiter's knee.
    """

    def __init__(self, path: Path, rate: int, channels: int = 2) -> None:
        path.parent.mkdir(parents=True, exist_ok=True)
        self.path = path
        self.rate = rate
        self.channels = channels
        self._width = 2 * channels
        self.frames = 0
        self.clipped = 0
        self._file = path.open("wb", buffering=0)
        self._file.write(_header(rate, channels))

    def append(self, block: NDArray[np.float32]) -> None:
        """Write frames, shape [n, channels], full scale 1; beyond 4 GiB nothing is written.

        Raises:
            OSError: The disk is full or failed. The file is closed, and shortened by 2 MiB so that the recording on the
                same disk can be completed.
        """
        if (self.frames + len(block)) * self._width > _LARGEST_DATA:
            return
        soft, clipped = soften_peaks(block)
        self.clipped += clipped
        try:
            self._write(np.rint(soft * 32767.0).astype("<i2").tobytes())
        except OSError:
            self._give_way()
            raise
        self.frames += len(block)
        self._write_sizes()

    def _write(self, data: bytes) -> None:
        if self._file.write(data) != len(data):
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    def _write_sizes(self) -> None:
        size = self.frames * self._width
        for place, value in ((4, _HEADER_SIZE - 8 + size), (40, size)):
            self._file.seek(place)
            self._file.write(struct.pack("<I", value))
        self._file.seek(_HEADER_SIZE + size)

    def _give_way(self) -> None:
        self.frames = max(0, self.frames - _GIVEN_BACK // self._width)
        with suppress(OSError):
            self._file.truncate(_HEADER_SIZE + self.frames * self._width)
            self._write_sizes()
        self._file.close()

    def close(self) -> None:
        """Close the file; a second call does nothing."""
        self._file.close()


def soften_peaks(block: NDArray[np.float32]) -> tuple[NDArray[np.float32], int]:
    """Limit by a memoryless soft knee from 0.85 to 1; return the block and the number of samples above the knee."""
    loud = np.abs(block) > _KNEE
    count = int(np.count_nonzero(loud))
    if count == 0:
        return block, 0
    over = (np.abs(block) - _KNEE) / (1.0 - _KNEE)
    bent = np.sign(block) * (_KNEE + (1.0 - _KNEE) * np.tanh(over))
    return np.where(loud, bent, block).astype(np.float32), count


def read_wav(path: Path, rate: int) -> NDArray[np.float32]:
    """Read a wave file at `rate` [Hz]; shape [n, channels].

    Raises:
        SceneError: The file is missing, damaged, or of a kind that is not PCM or float.
    """
    frames, file_rate = frames_of_wav(path)
    return np.stack([resample(each, file_rate, rate) for each in frames.T], axis=1).astype(np.float32)


def frames_of_wav(path: Path) -> tuple[NDArray[np.float64], int]:
    """Read a wave file without resampling; return samples, shape [n, channels], and rate [Hz]; raises as `read_wav`."""
    try:
        raw = read_regular(path)
    except OSError as error:
        raise SceneError(Issue(str(path), "", f"cannot be read: {error.strerror}")) from error
    chunks = _chunks(raw)
    if raw[:4] != b"RIFF" or raw[8:12] != b"WAVE" or b"fmt " not in chunks or b"data" not in chunks:
        raise SceneError(Issue(str(path), "", "is no wave file", "save it as WAV, PCM 16 bit"))
    layout = chunks[b"fmt "]
    if len(layout) < 16:
        raise SceneError(Issue(str(path), "", "has a damaged fmt chunk", "save it as WAV, PCM 16 bit"))
    kind, channels, file_rate, _, _, bits = struct.unpack("<HHIIHH", layout[:16])
    if kind == _EXTENSIBLE and len(layout) >= 26:
        kind = struct.unpack("<H", layout[24:26])[0]
    samples = _decode(chunks[b"data"], kind, bits)
    if samples is None or channels == 0 or not 1000 <= file_rate <= 768_000:
        raise SceneError(
            Issue(str(path), "", f"has format {kind}, {bits} bit, {channels} channels", "save it as WAV, PCM 16 bit")
        )
    frames = samples[: len(samples) // channels * channels].reshape(-1, channels)
    if len(frames) == 0 or not np.isfinite(frames).all():
        raise SceneError(Issue(str(path), "", "holds no sound, or values that are not finite"))
    return frames, int(file_rate)


def _header(rate: int, channels: int) -> bytes:
    """Return the header of an empty file."""
    width = 2 * channels
    layout = (16, _PCM, channels, rate, rate * width, width, 16)
    return struct.pack("<4sI4s4sIHHIIHH4sI", b"RIFF", _HEADER_SIZE - 8, b"WAVE", b"fmt ", *layout, b"data", 0)


def _chunks(raw: bytes) -> dict[bytes, bytes]:
    chunks: dict[bytes, bytes] = {}
    offset = 12
    while offset + 8 <= len(raw):
        name, size = struct.unpack_from("<4sI", raw, offset)
        chunks.setdefault(name, raw[offset + 8 : offset + 8 + size])
        offset += 8 + size + (size & 1)
    return chunks


def _decode(data: bytes, kind: int, bits: int) -> NDArray[np.float64] | None:
    if kind == _PCM and bits == 24:
        octets = np.frombuffer(data[: len(data) // 3 * 3], np.uint8).reshape(-1, 3).astype(np.int32)
        value = (octets[:, 0] << 8) | (octets[:, 1] << 16) | (octets[:, 2] << 24)
        return np.asarray(value / 2147483648.0)
    known = {
        (_PCM, 16): ("<i2", 32768.0),
        (_PCM, 32): ("<i4", 2147483648.0),
        (_FLOAT, 32): ("<f4", 1.0),
        (_FLOAT, 64): ("<f8", 1.0),
    }
    if (kind, bits) not in known:
        return np.asarray((np.frombuffer(data, np.uint8) - 128.0) / 128.0) if (kind, bits) == (_PCM, 8) else None
    name, scale = known[(kind, bits)]
    width = bits // 8
    return np.asarray(np.frombuffer(data[: len(data) // width * width], name) / scale, np.float64)


def resample(samples: NDArray[np.float64], rate_in: int, rate_out: int) -> NDArray[np.float64]:
    """Resample by truncating or zero-padding the spectrum, exact for content below both Nyquist frequencies."""
    if rate_in == rate_out:
        return samples
    pad = rate_in // 10  # padding, so that the end does not wrap around to the beginning
    padded = np.concatenate([samples, np.zeros(pad)])
    count = round(len(padded) * rate_out / rate_in)
    resampled = np.fft.irfft(np.fft.rfft(padded)[: count // 2 + 1], count) * (count / len(padded))
    return resampled[: round(len(samples) * rate_out / rate_in)]
