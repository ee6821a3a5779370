"""Port of a live device that takes blocks mixed here."""

from __future__ import annotations

from typing import Protocol

from mimics_app.contracts.arrays import F4

__all__ = ["LIVE_BLOCK", "SoundStream"]

LIVE_BLOCK = 80
"""Frames per block, 1.7 ms at 48 kHz; shorter than a file's, as the queue makes up most of the latency."""


class SoundStream(Protocol):
    """A queue of frames that a device consumes in real time."""

    @property
    def name(self) -> str:
        """Name of the device."""
        ...

    @property
    def rate(self) -> int:
        """Frames per second."""
        ...

    @property
    def channels(self) -> int:
        """Number of channels."""
        ...

    @property
    def period(self) -> int:
        """Frames that the device takes at once."""
        ...

    @property
    def behind(self) -> int:
        """Upper bound of the frames from the end of the queue to the device's output."""
        ...

    def left(self) -> int:
        """Read the frames written and not yet taken; negative: the device has played so much silence."""
        ...

    @property
    def ran_empty(self) -> bool:
        """Whether the device found the queue empty since the reading before the last one."""
        ...

    def write(self, block: F4) -> int:
        """Append a block, shape [frames, channels], after an empty queue as near as it can; return the frames left."""
        ...

    def flush(self) -> None:
        """Play what was written.

        Raises:
            DeviceError: The device has gone or refuses it.
        """
        ...

    def connected(self) -> bool:
        """False once the device is gone."""
        ...

    def close(self) -> None:
        """Close the device."""
        ...
