"""Shapes of skin conductance responses and of breaths, by name: people differ in them, and so do models of them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from mimics_app.contracts.arrays import F8

__all__ = ["BREATHS", "RESPONSES", "Breath", "Response"]

Breath = Callable[[F8], F8]
"""Waveform of a breath, -1 to 1, over its phase of 0 to 1, which begins with the in-breath."""


@dataclass(frozen=True, slots=True)
class Response:
    """Skin conductance response by the time since its onset.

    Attributes:
        of: Conductance over the time since the onset [s], 0 or more; of any height.
        peak_s: Time of its peak [s].
        lasts_s: Time after which nothing of it is left [s].
    """

    of: Callable[[F8], F8]
    peak_s: float
    lasts_s: float

    @property
    def peak(self) -> float:
        """Height of the peak."""
        return float(self.of(np.array([self.peak_s]))[0])


def _sampled(of: Callable[[F8], F8], lasts_s: float) -> Response:
    """Return a response whose peak has no closed form."""
    t = np.arange(0.0, lasts_s, 1e-3)
    return Response(of, float(t[np.argmax(of(t))]), lasts_s)


_RISE_S, _FALL_S = 0.75, 2.6
"""Time constants of the difference of two exponentials [s]: rise 1 to 3 s, half recovery 2 to 10 s (Dawson et al.,
2007)."""
_TO_PEAK_S = float(np.log(_FALL_S / _RISE_S) * _FALL_S * _RISE_S / (_FALL_S - _RISE_S))
_STEEP_S, _DECAY_S = 1.1, 4.5
"""Time of the rise and constant of the decay of the sigmoid form [s] (Lim et al., Int J Psychophysiol 25(2), 1997)."""
_QUICK_S, _TWO_S, _SLOW_SHARE = 0.5, (1.7, 9.0), 0.35
"""Rise, two decays [s] and the share of the slower one: a recovery that slows down (Boucsein 2012, chapter 1.4)."""


def _exponentials(t: F8) -> F8:
    return np.asarray(np.exp(-t / _FALL_S) - np.exp(-t / _RISE_S))


def _sigmoid(t: F8) -> F8:
    return np.asarray(np.exp(-t / _DECAY_S) / (1.0 + (_STEEP_S / np.maximum(t, 1e-9)) ** 2) ** 2)


def _two_decays(t: F8) -> F8:
    quick, slow = (np.exp(-t / tau) for tau in _TWO_S)
    return np.asarray((1.0 - _SLOW_SHARE) * quick + _SLOW_SHARE * slow - np.exp(-t / _QUICK_S))


RESPONSES: Mapping[str, Response] = {
    "exponentials": Response(_exponentials, _TO_PEAK_S, 12.0 * _FALL_S),
    "sigmoid": _sampled(_sigmoid, 10.0 * _DECAY_S),
    "two decays": _sampled(_two_decays, 8.0 * _TWO_S[1]),
}


def _rounded(phase: F8) -> F8:
    """Return a cosine whose in-breath is a little shorter than its out-breath."""
    turn = 2.0 * np.pi * phase
    return np.asarray(-np.cos(turn + 0.35 * np.sin(turn)))


_IN, _OUT = 0.3, 0.4
"""Shares of in-breath and out-breath; the rest is the pause at the end of a quiet breath."""


def _paused(phase: F8) -> F8:
    rises, falls = phase / _IN, (phase - _IN) / _OUT
    way = np.where(phase < _IN, rises, 1.0 + np.clip(falls, 0.0, 1.0))
    return np.asarray(-np.cos(np.pi * way))


_LETS_GO = 3.5
"""Time constants of the lung in an out-breath that is let go."""


def _released(phase: F8) -> F8:
    """Return a straight in-breath and a passive out-breath: the lung empties exponentially."""
    share = np.clip((phase - _IN) / (1.0 - _IN), 0.0, 1.0)
    out = (np.exp(-_LETS_GO * share) - np.exp(-_LETS_GO)) / (1.0 - np.exp(-_LETS_GO))
    return np.asarray(2.0 * np.where(phase < _IN, phase / _IN, out) - 1.0)


BREATHS: Mapping[str, Breath] = {"rounded": _rounded, "paused": _paused, "let go": _released}
