"""Samples that stay in a file until they are played: a long recording takes no more memory than a short one."""

from __future__ import annotations

from abc import abstractmethod
from typing import IO, Protocol

import numpy as np
from numpy.typing import NDArray

__all__ = ["KEPT_BYTES", "Samples", "SamplesInFile", "StoredSamples", "kept"]

KEPT_BYTES = 64 << 20
"""Size up to which the samples of a signal are kept in memory [bytes]: two hours at 1 kHz."""


class Samples(Protocol):
    """Samples of a signal: an array, or one that is read in parts."""

    def __len__(self) -> int:
        """Return the number of samples."""
        ...

    def __getitem__(self, part: slice, /) -> NDArray[np.float64]:
        """Return the samples of a slice without step."""
        ...


class SamplesInFile:
    """Samples that are read where they are asked for, from a file that may be that of several signals.

    Args:
        file: The file, open for reading.
        count: Number of samples.
    """

    def __init__(self, file: IO[bytes], count: int) -> None:
        self._file, self._count = file, count

    def __len__(self) -> int:
        return self._count

    @abstractmethod
    def __getitem__(self, part: slice, /) -> NDArray[np.float64]:
        """Return the samples of a slice without step.

        Raises:
            OSError: The file is no longer what it was.
        """

    def close(self) -> None:
        """Close the file."""
        self._file.close()

    def __del__(self) -> None:
        self.close()


class StoredSamples(SamplesInFile):
    """Samples as float64 in a file of their own."""

    def __getitem__(self, part: slice, /) -> NDArray[np.float64]:
        first, last, _ = part.indices(self._count)
        self._file.seek(8 * first)
        return np.frombuffer(self._file.read(8 * max(last - first, 0)), np.float64)


def kept(samples: Samples) -> Samples:
    """Return samples in memory where they are few, else as they are."""
    return samples[:] if 8 * len(samples) <= KEPT_BYTES else samples
