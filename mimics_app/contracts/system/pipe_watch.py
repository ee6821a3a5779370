"""A pipe that is asked again and again whether something has arrived."""

from __future__ import annotations

import select
from multiprocessing.connection import Connection

__all__ = ["PipeWatch"]


class PipeWatch:
    """Tells whether a pipe can be read without waiting; `Connection.poll` makes a selector for each question.

    Args:
        end: The end of the pipe to read.
    """

    def __init__(self, end: Connection) -> None:
        self._end = end
        self._poller = select.poll() if hasattr(select, "poll") else None
        if self._poller is not None:
            self._poller.register(end, select.POLLIN)

    def ready(self) -> bool:
        """Whether a message has arrived, or the other end is closed."""
        return self._end.poll() if self._poller is None else bool(self._poller.poll(0))
