"""A writer of wave files that are valid after every block, also when its process is killed."""

from __future__ import annotations

import errno
import itertools
import os
import struct
from contextlib import suppress
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

__all__ = ["WavWriter", "soften_peaks", "unused_name"]

_HEADER_SIZE = 44
_LARGEST_DATA = 0xFFFF_FFFF - _HEADER_SIZE
_PCM = 1
_KNEE = 0.85  # level above which loud samples are compressed instead of clipped
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


def _header(rate: int, channels: int) -> bytes:
    """Return the header of an empty file."""
    width = 2 * channels
    layout = (16, _PCM, channels, rate, rate * width, width, 16)
    return struct.pack("<4sI4s4sIHHIIHH4sI", b"RIFF", _HEADER_SIZE - 8, b"WAVE", b"fmt ", *layout, b"data", 0)
