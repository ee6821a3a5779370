"""Gain of contact and scrape sounds from force and speed, and the refractory period of a pair of bodies."""

from __future__ import annotations

from math import exp, hypot, isfinite, tanh

__all__ = ["REFRACTORY_NS", "ContactGate", "contact_gain", "scrape_gain"]

REFRACTORY_NS = 40_000_000
"""Refractory period of two bodies [ns]: a chattering contact sounds 25 times a second at most."""

_FULL_SPEED = 0.3
"""Approach speed that alone gives a gain of 0.91 [m/s]."""
_KNEE = 1.5
"""Strength of saturation of the gain of a contact [-]."""
_QUIETEST = 0.05
"""Gain of the lightest contact [-]."""
_LOUDER = 2.0
"""Ratio of gains from which a contact sounds within the refractory period [-]."""

_SCRAPE_LOUDEST = 0.22
"""Largest gain of scraping [-]."""
_SCRAPE_FORCE, _SCRAPE_SPEED = 8.0, 0.12
"""Force [N] and sliding speed [m/s] that alone give 63 % of that gain."""


def contact_gain(speed: float, force: float, full_force: float = 10.0) -> float:
    """Return the linear gain of a contact, 0.05 to 1; it rises with approach speed [m/s] and force [N] and saturates.

    0.3 m/s alone or `full_force` alone give 0.91, half of either 0.65. The force is that of the first tick, so an
    impact is judged by its speed and a press by its force. Values that are not finite count as 0.
    """
    strength = hypot(_finite(speed) / _FULL_SPEED, _finite(force) / full_force)
    return _QUIETEST + (1.0 - _QUIETEST) * tanh(_KNEE * strength)


def scrape_gain(speed: float, force: float) -> float:
    """Return the linear gain of scraping along a wall: 0 at rest; it rises with sliding speed [m/s] and force [N]."""
    pressed = 1.0 - exp(-_finite(force) / _SCRAPE_FORCE)
    return _SCRAPE_LOUDEST * pressed * (1.0 - exp(-_finite(speed) / _SCRAPE_SPEED))


def _finite(value: float) -> float:
    return abs(value) if isfinite(value) else 0.0


class ContactGate:
    """Suppresses contacts of a pair of bodies during its refractory period, unless one is twice as loud."""

    def __init__(self) -> None:
        self._last: dict[tuple[int, int], tuple[int, float]] = {}

    def passes(self, body_a: int, body_b: int, t_ns: int, gain: float) -> bool:
        """Return whether a contact of this gain at t_ns [ns] sounds; the order of the bodies does not matter."""
        pair = (min(body_a, body_b), max(body_a, body_b))
        last = self._last.get(pair)
        if last is not None and t_ns - last[0] < REFRACTORY_NS and gain < _LOUDER * last[1]:
            return False
        self._last[pair] = (t_ns, gain)
        return True
