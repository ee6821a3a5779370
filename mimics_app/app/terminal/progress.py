"""Progress of a command on a terminal; nothing is written elsewhere."""

from __future__ import annotations

from typing import TextIO

__all__ = ["ProgressBar", "draw_bar"]

_WIDTH = 30


def draw_bar(share: float) -> str:
    """Return a bar with its percentage.

    Args:
        share: Share that is done, 0 to 1.
    """
    filled = round(_WIDTH * share)
    return f"[{'#' * filled}{'.' * (_WIDTH - filled)}] {100 * share:3.0f} %"


class ProgressBar:
    """A bar with a caption, over a number of steps or a share.

    Args:
        stream: Stream to write to; nothing is written unless it is a terminal.
        total: Number of steps; unused with `show`.
        done: Number of steps that were done before.
    """

    def __init__(self, stream: TextIO, total: int = 1, done: int = 0) -> None:
        self._stream = stream
        self._total = max(total, 1)
        self._done = done
        self._shown = stream.isatty()

    def __enter__(self) -> ProgressBar:
        return self

    def __exit__(self, *_: object) -> None:
        if self._shown:
            self._stream.write("\r\x1b[K")
            self._stream.flush()

    def step(self, word: str) -> None:
        """Show the caption of the step that begins; the previous step is done."""
        self.show(self._done / self._total, word)
        self._done += 1

    def show(self, share: float, word: str) -> None:
        """Show the share that is done, 0 to 1, and a caption of what follows."""
        if self._shown:
            self._stream.write(f"\r\x1b[K{draw_bar(share)}  {word[:60]}")
            self._stream.flush()
