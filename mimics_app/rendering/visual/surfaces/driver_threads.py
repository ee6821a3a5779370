"""Threads of a driver, as long as a frame is submitted."""

from __future__ import annotations

from contextlib import AbstractContextManager, nullcontext

__all__ = ["DriverThreads"]


class DriverThreads:
    """The threads of a graphics card's driver, which the system places."""

    def submitting(self, *, placed: bool) -> AbstractContextManager[None]:
        """Give the caller, who submits, the room that it needs.

        Args:
            placed: False leaves the threads to the system, as for a picture of few pixels.
        """
        return nullcontext()

    def free(self) -> None:
        """Leave the threads to the system again."""
