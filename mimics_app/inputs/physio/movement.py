"""The movement of the hand as signals beside those of the body."""

from __future__ import annotations

import numpy as np

from mimics_app.contracts.messages import Experience, SignalBlock

__all__ = ["Movement"]

_RATE = 60.0
"""Nominal frame rate [Hz]."""


class Movement:
    """A `SignalSource` of "speed" [m/s] and "power" [W]: one sample a frame, that of the previous frame."""

    def __init__(self) -> None:
        self._last: Experience | None = None

    def read(self, now_ns: int) -> tuple[SignalBlock, ...]:
        """Return the newest sample of each signal."""
        last, self._last = self._last, None
        if last is None:
            return ()
        pairs = (("speed", last.speed), ("power", last.power))
        return tuple(SignalBlock(name, _RATE, last.t_ns, np.array([value])) for name, value in pairs)

    def feel(self, experience: Experience) -> None:
        """Keep the movement of this frame."""
        self._last = experience

    def close(self) -> None:
        """Nothing is open."""
