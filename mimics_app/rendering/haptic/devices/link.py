"""Link of a device to an open descriptor: its use by the loop, and the supervisor thread that reopens it.

Only the loop reads and writes the descriptor; only the supervisor, a Python thread, opens and closes it. They
synchronise through eight words at the head of the plug-in's memory:

    OFFER   descriptor + 1 that the supervisor has opened and the loop has not taken yet; 0: none
    UP      1 while the loop uses the descriptor
    FD      descriptor in use, written by the loop

The loop sets UP before it clears OFFER, and the supervisor reads OFFER before UP: "nothing offered and down" always
means that the loop has released it.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from contextlib import suppress

import numpy as np

from mimics_app.compiled.atomics import load_acquire, store_release
from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec, Words
from mimics_app.contracts.errors import DeviceError

__all__ = ["LINK_LENGTH", "LinkSupervisor", "drop_link", "link_words", "take_link"]

LINK_LENGTH = 8
"""Number of words, one per float64 place at the head of the memory."""

_OFFER, _UP, _FD = 0, 1, 2

_POLL_S = 0.1
_PATIENCE_S = 0.8
"""Time that `close` waits for the supervisor [s], which may hang in the driver of a port."""


@kernel
def link_words(memory: Vec) -> Words:
    """Return the words of a plug-in's memory as int64, shape [LINK_LENGTH]."""
    return memory[:LINK_LENGTH].view(np.int64)


@kernel
def take_link(words: Words) -> tuple[int, bool]:
    """Return (descriptor or -1, True when this call took a new one)."""
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
    """Release a descriptor whose other end is gone, for the supervisor to close."""
    words[_FD] = -1
    store_release(words, _UP, 0)


class LinkSupervisor:
    """Opens the descriptor, and reopens it after the loop released it.

    Motion does not resume with the line: a lost line latches SAFE_STOP, which only a reset by a person leaves.

    Args:
        memory: The plug-in's memory.
        open_line: Opens and greets the device; returns its descriptor and a function that closes it.
        name: Name of the device in messages.

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
        self._thread = threading.Thread(target=self._watch, name=f"supervisor of {name}", daemon=True)
        self._thread.start()

    def trouble(self) -> str:
        """Return why there is no line, and what to do; "" while there is one."""
        return self._trouble

    def poll(self) -> None:
        """Open the line again if the loop has let go of it; a failure is reported by `trouble` and tried again."""
        if self._close_line is None or (self._words[_OFFER] == 0 and self._words[_UP] == 0):
            self._release()
            gone = f"{self._name} is gone: no force. Connect it again"
            self._trouble = self._trouble or gone
            try:
                self._offer()
                self._trouble = ""
            except DeviceError as failure:
                self._trouble = f"{gone} ({failure.what})"

    def close(self) -> None:
        """End the supervisor and close the line; the loop must have ended. A second call does nothing."""
        self._ended.set()
        if self._thread is not threading.current_thread():
            self._thread.join(_PATIENCE_S)
        self._words[_UP] = self._words[_OFFER] = 0
        self._words[_FD] = -1
        self._release()

    def _offer(self) -> None:
        try:
            descriptor, self._close_line = self._open_line()
        except OSError as failure:
            raise DeviceError(f"{self._name} cannot be opened: {failure}") from failure
        store_release(self._words, _OFFER, descriptor + 1)

    def _release(self) -> None:
        if self._close_line is not None:
            with suppress(OSError):  # closing a line whose other end is gone may fail
                self._close_line()
            self._close_line = None

    def _watch(self) -> None:
        while not self._ended.wait(_POLL_S):
            self.poll()
