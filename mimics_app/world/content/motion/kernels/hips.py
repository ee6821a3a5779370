"""Place of the hips by least squares, so that two legs whose ankles are given bend as hips and knees are given."""

from __future__ import annotations

import math

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import F8

__all__ = ["AHEAD", "ASIDE", "DOWN", "HIP", "KNEE", "LEG", "WEIGHT", "fit_hips"]

AHEAD = 0  # of the ankle before its hip [m]
DOWN = 1  # below it [m]
ASIDE = 2  # beside it [m]
HIP = 3  # given lean of the thigh, forward [rad]
KNEE = 4  # given flexion of the knee [rad]
WEIGHT = 5  # share in the fit, 0 to 1
LEG = 6  # numbers of a leg

_ROUNDS = 4
"""Steps of Gauss and Newton; the place of the last frame is near."""

_DIFFERENCES = 8
"""Those of four angles, of two legs that are too short, and of the hips from their place and from where they were."""

_FIRM = 5.0
"""What a shift of the hips ahead counts as [rad/m]: of real walkers they move by some centimetres."""

_CALM, _SHORTEST = 0.37, 1e-3
"""What a speed of that shift counts as [rad s/m], and the shortest time in which it is made [s]."""

_TOO_SHORT = 300.0
"""What it counts as that an ankle is out of reach [rad/m]: the ground has the foot."""

_LONGEST_STEP = 0.02
"""Longest step [m]."""

_APART = 1e-5
"""Distance of places by which the slopes are found [m]."""

_LEAST = 1e-3
"""Smallest square of a slope that counts [rad^2/m^2]: both legs swing."""


@kernel
def _bend(leg: F8, up: float, ahead: float, bones: F8, out: F8) -> None:
    """Set thigh and knee [rad] for shifted hips, and by how much the leg is too short [m]."""
    z, down, aside = leg[AHEAD] - ahead, leg[DOWN] + up, leg[ASIDE]
    thigh, shank = bones[0], bones[1]
    far = math.sqrt(z * z + down * down + aside * aside)
    out[2] = max(far - bones[2], 0.0)
    far = min(far, bones[2])
    cosine = (far * far - thigh * thigh - shank * shank) / (2.0 * thigh * shank)
    out[1] = math.acos(min(1.0, max(-1.0, cosine)))
    out[0] = math.atan2(z, down) + math.atan2(shank * math.sin(out[1]), thigh + shank * math.cos(out[1]))


@kernel
def _compare(legs: F8, up: float, ahead: float, bones: F8, moved: float, out: F8) -> None:
    """Set the weighted differences for hips that are shifted, and have moved ahead at a speed [rad]."""
    bent = np.empty(3)
    for k in range(2):
        weight = legs[k, WEIGHT]
        _bend(legs[k], up, ahead, bones, bent)
        out[2 * k] = weight * (bent[0] - legs[k, HIP])
        out[2 * k + 1] = weight * (bent[1] - legs[k, KNEE])
        out[4 + k] = _TOO_SHORT * weight * bent[2]
    out[6] = _FIRM * ahead
    out[7] = _CALM * moved


@kernel
def _step(slopes: F8, differences: F8, place: F8) -> None:
    """Shift the place by a step of Gauss and Newton."""
    a, b, c, p, q = _LEAST, 0.0, _LEAST, 0.0, 0.0
    for i in range(_DIFFERENCES):
        s, t = slopes[0, i], slopes[1, i]
        a, b, c = a + s * s, b + s * t, c + t * t
        p, q = p - s * differences[i], q - t * differences[i]
    det = a * c - b * b
    up, ahead = (c * p - b * q) / det, (a * q - b * p) / det
    share = min(1.0, _LONGEST_STEP / max(math.hypot(up, ahead), _APART))
    place[0] += share * up
    place[1] += share * ahead


@kernel
def fit_hips(legs: F8, bones: F8, seconds: float, place: F8) -> None:
    """Shift the hips up and ahead until the legs bend as given, as far as their ankles let them.

    Args:
        legs: A row of `LEG` numbers for each leg, [2, LEG].
        bones: Thigh, shank, and the longest reach of both [m], [3].
        seconds: Time since the last fit [s].
        place: Shift of the hips up and ahead in the last fit [m], [2]; written.
    """
    before, rate = place[1], 1.0 / max(seconds, _SHORTEST)
    now, slopes = np.empty(_DIFFERENCES), np.empty((2, _DIFFERENCES))
    for _ in range(_ROUNDS):
        up, ahead = place[0], place[1]
        moved = rate * (ahead - before)
        _compare(legs, up, ahead, bones, moved, now)
        _compare(legs, up + _APART, ahead, bones, moved, slopes[0])
        _compare(legs, up, ahead + _APART, bones, moved + rate * _APART, slopes[1])
        for i in range(_DIFFERENCES):
            slopes[0, i] = (slopes[0, i] - now[i]) / _APART
            slopes[1, i] = (slopes[1, i] - now[i]) / _APART
        _step(slopes, now, place)
