"""How a touch sounds: level from force and speed, a pause between sounds of one pair, and the rub of sliding."""

from __future__ import annotations

from math import exp, hypot, isfinite, tanh

__all__ = ["REFRACTORY_NS", "ContactGate", "contact_gain", "scrape_gain"]

REFRACTORY_NS = 40_000_000
"""Pause after a contact of the same two bodies [ns]: a chattering wall knocks 25 times a second at most."""

_FULL_SPEED = 0.3
_KNEE = 1.5
_QUIETEST = 0.05
_LOUDER = 2.0

_SCRAPE_LOUDEST = 0.22
_SCRAPE_FORCE = 8.0
_SCRAPE_SPEED = 0.12


def contact_gain(speed: float, force: float, full_force: float = 10.0) -> float:
    """Linear gain in [0.05, 1] of a contact: rising with approach speed [m/s] and force [N], saturating smoothly.

    0.3 m/s alone or `full_force` alone give 0.91, half of it 0.65. A contact's first force is that of one tick, so the
    speed says more about a hit and the force about a press. Values that are not finite count as 0.
    """
    strength = hypot(_finite(speed) / _FULL_SPEED, _finite(force) / full_force)
    return _QUIETEST + (1.0 - _QUIETEST) * tanh(_KNEE * strength)


def scrape_gain(speed: float, force: float) -> float:
    """Linear gain of rubbing along a wall: 0 at rest or untouched, rising with sliding speed [m/s] and force [N]."""
    pressed = 1.0 - exp(-_finite(force) / _SCRAPE_FORCE)
    return _SCRAPE_LOUDEST * pressed * (1.0 - exp(-_finite(speed) / _SCRAPE_SPEED))


def _finite(value: float) -> float:
    return abs(value) if isfinite(value) else 0.0


class ContactGate:
    """Lets one contact of a pair through and holds the next ones back for 40 ms, unless one is twice as loud."""

    def __init__(self) -> None:
        self._last: dict[tuple[int, int], tuple[int, float]] = {}

    def passes(self, body_a: int, body_b: int, t_ns: int, gain: float) -> bool:
        """Whether a contact of this gain at t_ns sounds; the order of the bodies does not matter."""
        pair = (min(body_a, body_b), max(body_a, body_b))
        last = self._last.get(pair)
        if last is not None and t_ns - last[0] < REFRACTORY_NS and gain < _LOUDER * last[1]:
            return False
        self._last[pair] = (t_ns, gain)
        return True
