"""Gain of contact and scrape sounds from force and speed, and the refractory period of a pair of bodies."""

from __future__ import annotations

from math import hypot, isfinite, tanh

__all__ = ["REFRACTORY_NS", "SCRAPE_SPEED", "ContactGate", "contact_gain", "scrape_gain", "scrape_pitch"]

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

SCRAPE_SPEED = 0.2
"""Sliding speed at which the recipe of scraping sounds as it is synthesised [m/s]."""
_SCRAPE_FORCE, _SCRAPE_GAIN = 4.0, 0.07
"""Force [N], and gain there and at `SCRAPE_SPEED` [-]."""
_SPEED_EXPONENT, _FORCE_EXPONENT = 0.75, 0.5
"""Exponents of sound pressure: speed as measured on rough dry surfaces (Influence of sliding speed on roughness noise,
2019: about 3/4; a power law by H. Ben Abdelounis et al., Wear 268, 2010, too); force for a sound energy in proportion
to the power of friction."""
_SCRAPE_LOUDEST = 0.22
"""Largest gain of scraping [-]: it does not cover the contacts."""
_PITCHES = (1.0 / 32.0, 5.0)
"""Limits of the pitch: 6 mm/s, where scraping is inaudible, and 1 m/s, where its band reaches 5 kHz."""


def contact_gain(speed: float, force: float, full_force: float = 10.0) -> float:
    """Return the linear gain of a contact, 0.05 to 1; it rises with approach speed [m/s] and force [N] and saturates.

    0.3 m/s alone or `full_force` alone give 0.91, half of either 0.65. The force is that of the first tick, so an
    impact is rated by its speed and a press by its force. Values that are not finite count as 0.
    """
    strength = hypot(_finite(speed) / _FULL_SPEED, _finite(force) / full_force)
    return _QUIETEST + (1.0 - _QUIETEST) * tanh(_KNEE * strength)


def scrape_gain(speed: float, force: float) -> float:
    """Return the linear gain of scraping: powers of sliding speed [m/s] and force [N]; 0 without either, limited."""
    slid, pressed = _finite(speed) / SCRAPE_SPEED, _finite(force) / _SCRAPE_FORCE
    return min(_SCRAPE_LOUDEST, _SCRAPE_GAIN * slid**_SPEED_EXPONENT * pressed**_FORCE_EXPONENT)


def scrape_pitch(speed: float) -> float:
    """Return the rate at which a surface's profile is read at a sliding speed [m/s], within limits.

    A texture of k periods per metre is met k * speed times a second, so all frequencies are proportional to the speed
    (K. van den Doel et al., FoleyAutomatic, 2001: the phonograph needle).
    """
    low, high = _PITCHES
    return min(high, max(low, _finite(speed) / SCRAPE_SPEED))


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
