"""How far a command is, on a terminal; nothing where nobody watches."""

from __future__ import annotations

from types import TracebackType
from typing import TextIO

__all__ = ["ProgressBar", "draw_bar"]

_WIDTH = 30


def draw_bar(share: float) -> str:
    """A bar and its percentage.

    Args:
        share: Done, 0 to 1.
    """
    filled = round(_WIDTH * share)
    return f"[{'#' * filled}{'.' * (_WIDTH - filled)}] {100 * share:3.0f} %"


class ProgressBar:
    """A bar over a known number of steps, each with a word of what is being done.

    Args:
        stream: Where to write; silent unless it is a terminal.
        total: Number of steps.
        done: Of these beforehand.
    """

    def __init__(self, stream: TextIO, total: int, done: int = 0) -> None:
        self._stream = stream
        self._total = max(total, 1)
        self._done = done
        self._shown = stream.isatty()

    def __enter__(self) -> ProgressBar:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._shown:
            self._stream.write("\r\x1b[K")
            self._stream.flush()

    def step(self, word: str) -> None:
        """Say what begins now; what was said before is done."""
        if self._shown:
            self._stream.write(f"\r\x1b[K{draw_bar(self._done / self._total)}  {word[:60]}")
            self._stream.flush()
        self._done += 1
