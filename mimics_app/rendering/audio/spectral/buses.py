"""Mixer buses: a gain each, and ducking of other buses."""

from __future__ import annotations

from collections.abc import Mapping
from math import exp

import numpy as np
from numpy.typing import NDArray

from mimics_app.rendering.audio.settings import BusSpec

__all__ = ["Buses"]

_DOWN_S = 0.05
"""Attack of ducking [s]: within the first syllable."""

_UP_S = 0.4
"""Release of ducking [s]: slow enough not to pump between words."""


class Buses:
    """Gains of all buses, block by block.

    Args:
        specs: Buses by name; "main" is added.
        rate: Samples per second.
    """

    def __init__(self, specs: Mapping[str, BusSpec], rate: int) -> None:
        self._specs = {"main": BusSpec(), **specs}
        self._names = list(self._specs)
        self._rate = rate
        self._ducked = np.ones(len(self._names))
        self._own = np.array([spec.gain for spec in self._specs.values()])
        self._ducks = any(spec.ducks for spec in self._specs.values())

    def row_of(self, name: str) -> int:
        """Return the row of a bus, that of "main" for an unknown name."""
        return self._names.index(name) if name in self._specs else 0

    def gains(self, sounding: NDArray[np.int64], frames: int) -> NDArray[np.float64]:
        """Return the linear gain of each bus for a block in which the buses `sounding` have voices, shape [buses]."""
        if not self._ducks:
            return self._own
        wanted = np.ones(len(self._names))
        for row in np.unique(sounding).tolist():
            spec = self._specs[self._names[row]]
            for name in spec.ducks:
                wanted[self.row_of(name)] = min(wanted[self.row_of(name)], spec.duck_gain)
        span = frames / self._rate
        share = np.where(wanted < self._ducked, 1.0 - exp(-span / _DOWN_S), 1.0 - exp(-span / _UP_S))
        self._ducked += share * (wanted - self._ducked)
        return self._ducked * self._own
