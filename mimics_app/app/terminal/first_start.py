"""Messages of a cold start: the first start of a version compiles the kernels, which takes a minute or two."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from typing import TextIO

from mimics_app.contracts.clock import Clock, MonotonicClock
from mimics_app.contracts.system.phrases import phrase

__all__ = ["CompileLine", "is_cold", "say_if_cold"]

_NS = 1_000_000_000
_SOON_NS = 2 * _NS
"""Compile time up to which no progress is shown [ns]."""
_LINE_NS = 10 * _NS
"""Time between two lines of progress where stderr is no terminal [ns]."""


def say_if_cold(tell: Callable[[str], None] | None = None) -> None:
    """Report on stderr that the kernels will be compiled, where none are cached, and show the progress.

    Args:
        tell: Receives the progress once a second, for the window that waits; None: there is none.
    """
    from mimics_app.compiled.cache_folder import cache_folder, compile_listeners

    line = CompileLine(sys.stderr, MonotonicClock(), tell)
    compile_listeners[:] = [line.count]
    if is_cold(cache_folder):
        sys.stderr.write("mimics: compiling the kernels, once for this version; a minute or two\n")


def is_cold(folder: Path | None) -> bool:
    """Whether a cache folder holds no machine code; True without a folder, where every start compiles."""
    return folder is None or next(folder.rglob("*.nbc"), None) is None


class CompileLine:
    """Number of functions compiled so far: in place on a terminal, else a line every ten seconds.

    How many there will be depends on the scene and is not known before, so no total is shown.

    Args:
        stream: Stream to write to.
        clock: Clock of the elapsed time.
        tell: Receives the text at most once a second; None: no window waits.
    """

    def __init__(self, stream: TextIO, clock: Clock, tell: Callable[[str], None] | None = None) -> None:
        self._stream = stream
        self._clock = clock
        self._tell = tell
        self._done = 0
        self._begun_ns = self._said_ns = self._reported_ns = clock.now_ns()

    def count(self) -> None:
        """Count a compiled function."""
        now_ns = self._clock.now_ns()
        if self._done == 0:
            self._begun_ns = self._said_ns = self._reported_ns = now_ns
        self._done += 1
        if now_ns - self._begun_ns < _SOON_NS:
            return
        if self._tell is not None and now_ns - self._reported_ns >= _NS:
            self._reported_ns = now_ns
            self._tell(phrase("Preparing, once for this version; parts done: {n:d}", n=self._done))
        self._write(now_ns)

    @property
    def _text(self) -> str:
        return f"{self._done} functions done"

    def _write(self, now_ns: int) -> None:
        if self._stream.closed:  # by a caller that captured it
            return
        watched = self._stream.isatty()
        if not watched and now_ns - self._said_ns < _LINE_NS:
            return
        self._said_ns = now_ns
        seconds = (now_ns - self._begun_ns) // _NS
        text = f"mimics: compiling the kernels, once for this version: {self._text}, {seconds} s"
        self._stream.write(f"\r{text}\x1b[K" if watched else f"{text}\n")
        self._stream.flush()
