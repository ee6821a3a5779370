"""The link of a loop device to the world outside: who may use the descriptor, and who opens it again.

The loop alone reads and writes the descriptor, a keeper thread of the main side alone opens and closes it. They meet in
eight words at the head of the plug-in's memory:

    OFFER   descriptor + 1 the keeper has opened and the loop has not taken yet; 0: none
    UP      1 while the loop uses the descriptor
    FD      the descriptor in use; the loop's own

The loop sets UP before it clears OFFER, and the keeper reads OFFER before UP: "nothing offered and down" always means
that the loop has let go.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from contextlib import suppress

import numpy as np

from mimics_app.contracts.arrays import Vec, Words
from mimics_app.contracts.atomics import load_acquire, store_release
from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.kernel import kernel

__all__ = ["LINK_LENGTH", "LinkKeeper", "drop_link", "link_words", "take_link"]

LINK_LENGTH = 8
"""float64 places at the head of the memory that hold the words."""

_OFFER, _UP, _FD = 0, 1, 2

_LOOK_EVERY_S = 0.1


@kernel
def link_words(memory: Vec) -> Words:
    """The words of a plug-in's memory, shape [LINK_LENGTH], int64."""
    return memory[:LINK_LENGTH].view(np.int64)


@kernel
def take_link(words: Words) -> tuple[int, bool]:
    """(descriptor or -1, True when it was taken in this very call and everything about the line is new)."""
    if load_acquire(words, _UP) == 1:
        return words[_FD], False
    offered = load_acquire(words, _OFFER)
    if offered == 0:
        return -1, False
    words[_FD] = offered - 1
    store_release(words, _UP, 1)
    store_release(words, _OFFER, 0)
    return words[_FD], True


@kernel
def drop_link(words: Words) -> None:
    """Let go of a descriptor whose other end is gone; the keeper may close it now."""
    words[_FD] = -1
    store_release(words, _UP, 0)


class LinkKeeper:
    """Opens the descriptor, and opens it again after the loop let go of it.

    Motion does not return with the line: a lost line latches SAFE_STOP, and only a person's reset leaves that.

    Args:
        memory: The plug-in's memory.
        open_line: Opens and greets the device; returns its descriptor and what closes it.
        name: Of the device, for messages.

    Raises:
        DeviceError: The device cannot be opened now.
    """

    def __init__(self, memory: Vec, open_line: Callable[[], tuple[int, Callable[[], None]]], name: str) -> None:
        self._words: Words = memory[:LINK_LENGTH].view(np.int64)
        self._words[:] = 0
        self._words[_FD] = -1
        self._open_line = open_line
        self._name = name
        self._trouble = ""
        self._ended = threading.Event()
        self._close_line: Callable[[], None] | None = None
        self._offer()
        self._thread = threading.Thread(target=self._watch, name=f"keeper of {name}", daemon=True)
        self._thread.start()

    def trouble(self) -> str:
        """Why there is no line, and what to do; "" while there is one."""
        return self._trouble

    def look(self) -> None:
        """Open the line again if the loop has let go of it; a failure is reported by `trouble` and tried again."""
        if self._close_line is None or (self._words[_OFFER] == 0 and self._words[_UP] == 0):
            self._release()
            gone = f"{self._name} is gone: no force. Connect it again"
            self._trouble = self._trouble or gone
            try:
                self._offer()
                self._trouble = ""
            except (DeviceError, OSError) as failure:
                self._trouble = f"{gone} ({getattr(failure, 'what', failure)})"

    def close(self) -> None:
        """End for good; the loop must have ended. A second call does nothing more."""
        self._ended.set()
        if self._thread is not threading.current_thread():
            self._thread.join()
        self._words[_UP] = self._words[_OFFER] = 0
        self._words[_FD] = -1
        self._release()

    def _offer(self) -> None:
        descriptor, self._close_line = self._open_line()
        store_release(self._words, _OFFER, descriptor + 1)

    def _release(self) -> None:
        if self._close_line is not None:
            with suppress(OSError):  # a line whose other end is gone may complain once more
                self._close_line()
            self._close_line = None

    def _watch(self) -> None:
        while not self._ended.wait(_LOOK_EVERY_S):
            self.look()
