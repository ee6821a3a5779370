"""Delay of a frame that begins while a software driver still draws the one before."""

from __future__ import annotations

__all__ = ["StartDelay"]

_MARGIN_NS = 700_000
"""Time by which a frame is prepared before the driver is expected to have drawn [ns], so that it is seldom idle."""

_SHARE = 0.25
"""Share of a new time in the mean of those before."""


class StartDelay:
    """Time that a driver is given after a frame is submitted, before the next one begins.

    The next frame reads its inputs when it begins, and once it is prepared it waits until the driver has drawn: the
    delay leaves no more than a margin of this wait.

    Attributes:
        ns: The delay [ns].
    """

    def __init__(self) -> None:
        self.ns = 0
        self._drawing_ns = self._preparing_ns = 0.0

    def note_drawn(self, drawing_ns: int, *, latest: bool = False) -> None:
        """Note for how long the driver drew after a frame was submitted [ns].

        Args:
            drawing_ns: The time.
            latest: True where it drew for no longer than that, and how much shorter is not known.
        """
        if latest:
            drawing_ns = min(drawing_ns, round(self._drawing_ns) - _MARGIN_NS)
        self._drawing_ns += _SHARE * (drawing_ns - self._drawing_ns)
        self._update()

    def note_prepared(self, preparing_ns: int) -> None:
        """Note how long a frame took from its beginning until it was prepared [ns]."""
        self._preparing_ns += _SHARE * (preparing_ns - self._preparing_ns)
        self._update()

    def _update(self) -> None:
        self.ns = max(0, round(self._drawing_ns - self._preparing_ns) - _MARGIN_NS)
