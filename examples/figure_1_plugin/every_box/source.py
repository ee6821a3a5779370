"""Source of body signals: a belt round the chest whose stretch is measured 50 times a second."""

from __future__ import annotations

import numpy as np

from mimics_app.contracts.messages.stage_messages import SignalBlock

RATE = 50.0


class Belt:
    """A belt on a person who breathes 15 times a minute.

    Attributes:
        lost: Why there are no more samples, "" while there are.
    """

    lost = ""

    def __init__(self, seed):
        self._noise = np.random.default_rng(seed)
        self._sent, self._start_ns = 0, None

    def read(self, now_ns):
        """Return the samples since the last call."""
        self._start_ns = now_ns if self._start_ns is None else self._start_ns
        due = np.arange(self._sent, int((now_ns - self._start_ns) * 1e-9 * RATE))
        first_ns = self._start_ns + round(1e9 * self._sent / RATE)
        self._sent += len(due)
        values = 10.0 + 2.0 * np.sin(2.0 * np.pi * 0.25 * due / RATE) + 0.05 * self._noise.standard_normal(len(due))
        return (SignalBlock("stretch", RATE, first_ns, values),) if len(due) else ()

    def take_experience(self, experience):
        """Hardware feels nothing of the session."""

    def close(self):
        """Nothing is open."""


def open_belt(address, seed):
    """Open the belt; it has no address."""
    return Belt(seed)
