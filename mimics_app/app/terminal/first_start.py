"""The first start after a change of version compiles the kernels, which takes a minute or two: people are informed."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from typing import TextIO

from mimics_app.contracts.clock import Clock, MonotonicClock

__all__ = ["CompileLine", "is_cold", "say_if_cold"]

_USUAL = 350
"""Functions that a first run of the wavy tunnel compiles; with haptic objects it is about twice as many."""

_NS = 1_000_000_000
_SOON_NS = 2 * _NS
"""What takes less is not worth a word."""
_LINE_NS = 10 * _NS
"""Time between two lines where nobody watches a terminal."""


def say_if_cold(tell: Callable[[str], None] | None = None) -> None:
    """Say on stderr that kernels are about to be compiled, where no machine code is kept yet, and how far that is.

    Args:
        tell: Called once a second with the same for the window that waits; None: none does.
    """
    from mimics_app.contracts.kernel_cache import cache_folder, compile_listeners

    line = CompileLine(sys.stderr, MonotonicClock(), tell)
    compile_listeners[:] = [line.count]
    if is_cold(cache_folder):
        sys.stderr.write("mimics: compiling the kernels, once for this version; a minute or two\n")


def is_cold(folder: Path | None) -> bool:
    """Whether a cache folder holds no machine code; true of none at all, where every start compiles."""
    return folder is None or next(folder.rglob("*.nbc"), None) is None


class CompileLine:
    """How many functions are compiled, of about how many: in place on a terminal, else a line every ten seconds.

    Args:
        stream: Where to write.
        clock: Any.
        tell: Called with the text at most once a second; None: nobody else waits.
    """

    def __init__(self, stream: TextIO, clock: Clock, tell: Callable[[str], None] | None = None) -> None:
        self._stream = stream
        self._clock = clock
        self._tell = tell
        self._done = 0
        self._begun_ns = self._said_ns = self._told_ns = clock.now_ns()

    def count(self) -> None:
        """One more function is compiled."""
        now_ns = self._clock.now_ns()
        if self._done == 0:
            self._begun_ns = self._said_ns = self._told_ns = now_ns
        self._done += 1
        if now_ns - self._begun_ns < _SOON_NS:
            return
        if self._tell is not None and now_ns - self._told_ns >= _NS:
            self._told_ns = now_ns
            self._tell(f"Compiling, once for this version: {self._text}")
        self._write(now_ns)

    @property
    def _text(self) -> str:
        return f"{self._done}{f' of about {_USUAL}' if self._done <= _USUAL else ''} functions"

    def _write(self, now_ns: int) -> None:
        if self._stream.closed:  # by whoever reads a command's messages and had enough
            return
        watched = self._stream.isatty()
        if not watched and now_ns - self._said_ns < _LINE_NS:
            return
        self._said_ns = now_ns
        seconds = (now_ns - self._begun_ns) // _NS
        text = f"mimics: compiling the kernels, once for this version: {self._text}, {seconds} s"
        self._stream.write(f"\r{text}\x1b[K" if watched else f"{text}\n")
        self._stream.flush()
