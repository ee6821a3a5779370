"""Reference gait: published joint angles of hip, knee and ankle, and the table a walk follows.

Sources:

- Natural speed: mean of healthy adults, one value per 2 % of the cycle from heel contact to heel contact [degrees]. The
  numbers are those that SCONE Studio ships for its gait analysis (resources/gaitanalysis/default.zml), which
  credits G. Bovi et al., A multiple-task gait analysis approach, Gait & Posture 33 (2011) 6-13; that attribution is
  not verified here. The ankle is given with the offset of 20 degrees that the file states. The hip is relative to the
  pelvis, which is tilted forward by `TILT`.
- Knee from 0.5 to 5 km/h: B. Koopman, E. H. F. van Asseldonk, H. van der Kooij, Speed-dependent reference joint
  trajectory generation for robotic gait support, J. Biomechanics 47 (2014) 1447-1458: regression of six events on
  speed [km/h] and body height [m], joined by quintic polynomials. Rows: 1, speed, its square, height. The
  coefficients were read from a public table of that regression, not from the paper itself. Its times are indices of
  samples that count from 1: heel contact is at 1. That a cycle has 100 steps of them, from 1 to 101, is not in the
  table: the last polynomial, from the fastest extension to heel contact, is two to three times smoother with its end at
  101 than at 100 (from 0.5 to 4.7 km/h).

The two differ by 8 degrees (root mean square) in the knee at 1.2 m/s: in the zero of the joint, and by a later
toe-off in the second. Hip and ankle at other speeds are scaled: the hip with the step, the ankle with its cube, as
fitted. The walk is compared with the knee, and against a hip and an ankle that it was not made from
(`lab.published_gait`): 5 degrees root mean square from 0.3 m/s on, 5.5 for the ankle at 0.5 m/s.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from mimics_app.contracts.arrays import F8

__all__ = [
    "NATURAL",
    "NATURAL_STANCE",
    "SAMPLES",
    "TILT",
    "Events",
    "curve_by_events",
    "knee_by_speed",
    "shape_gait",
    "stance_share",
]

Events = tuple[tuple[tuple[float, float, float, float], ...], ...]
"""Regressions of the six events of a joint, see `curve_by_events`."""


SAMPLES = 50
"""Samples of a cycle; row k is at k/50."""
TILT = 9.1
"""Mean forward tilt of the pelvis in the natural table [degrees]."""
NATURAL_STANCE = 0.60
"""Stance phase at natural speed, as a share of the cycle."""

NATURAL: dict[str, tuple[float, ...]] = {
    "hip": (
        33.0, 32.9, 32.5, 32.0, 31.2, 29.9, 28.1, 26.1, 24.0, 21.9, 19.7, 17.4, 14.9, 12.4, 9.9, 7.5, 5.2,
        3.0, 0.9, -1.1, -2.9, -4.5, -5.8, -6.8, -7.6, -8.2, -8.3, -7.8, -6.7, -4.9, -2.3, 1.1, 5.0, 9.0,
        12.9, 16.7, 20.2, 23.4, 26.3, 28.9, 30.9, 32.5, 33.4, 33.7, 33.5, 32.8, 32.0, 31.5, 31.4, 31.7,
    ),
    "knee": (
        7.9, 10.3, 11.9, 14.7, 17.4, 19.0, 19.4, 19.0, 18.1, 17.2, 16.2, 15.1, 14.0, 12.8, 11.5, 10.2, 9.1,
        8.1, 7.5, 7.2, 7.3, 7.7, 8.6, 10.0, 11.9, 14.1, 17.0, 20.6, 25.2, 30.8, 37.2, 44.0, 50.4, 55.7,
        59.8, 62.4, 63.4, 63.0, 61.3, 58.4, 54.2, 48.9, 42.4, 35.0, 26.8, 18.7, 11.6, 6.5, 4.0, 4.4,
    ),
    "ankle": (
        -2.3, -3.9, -6.2, -6.1, -4.6, -2.5, -0.5, 1.0, 2.3, 3.4, 4.4, 5.4, 6.4, 7.2, 7.9, 8.6, 9.2,
        10.0, 10.7, 11.5, 12.0, 12.4, 12.4, 12.1, 11.1, 9.4, 6.6, 2.4, -3.4, -9.8, -15.3, -18.9, -19.9, -18.0,
        -14.6, -10.7, -7.3, -4.3, -1.8, 0.0, 1.4, 2.4, 2.7, 2.4, 1.3, 0.0, -1.1, -1.9, -2.5, -2.7,
    ),
}  # fmt: skip
"""Flexion of hip and knee, dorsiflexion of the ankle [degrees], [50] each."""

_WHEN = (
    (1.0, 0.0, 0.0, 0.0),  # heel contact
    (17.1031, 0.0, 0.0, 0.0),  # maximum flexion in stance
    (48.5422, -0.998055, 0.0, 0.0),  # minimum flexion in stance
    (68.9475, -6.09610, 0.610870, 5.96713),  # maximum flexion velocity
    (85.8158, -4.48022, 0.518829, 0.0),  # maximum flexion in swing
    (92.4891, 0.0, 0.0, 0.0),  # maximum extension velocity
)
_ANGLE = (
    (31.5946, -4.31134, 0.494138, -13.0496), (5.99480, 3.02815, 0.0, 0.0), (-10.0373, 0.0, 0.0, 7.59433),
    (29.6178, 3.80279, -0.486270, 0.0), (38.1104, 9.74369, -1.10481, 0.0), (24.6306, -0.967375, 0.0, 0.0),
)  # fmt: skip
_SLOPE = (
    (-3.58087, 0.0, 0.0, 1.97723), (0.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 0.0),
    (3.27633, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 0.0), (-0.445591, 0.0, -0.0318891, -1.69608),
)  # fmt: skip
_BEND = (
    (0.301196, 0.0732306, 0.0, 0.0), (-0.0944567, 0.0, -0.00496254, 0.0), (0.0418350, 0.0, 0.00435602, 0.0),
    (0.0, 0.0, 0.0, 0.0), (-0.783686, 0.224573, -0.0263203, 0.0), (0.0, 0.0, 0.0, 0.0),
)  # fmt: skip
"""Times of the six events of the knee [samples of 1 %, from 1], its angles there [degrees], their first and second
derivatives."""

_HEIGHT = 1.75
"""Body height for which the knee is computed [m]."""
_SLOW, _NATURAL = 1.0, 1.3
"""Speeds up to which the knee is that of the regression, and from which it is the natural one [m/s]."""
_MIN_KNEE = 4.5
"""Minimum knee flexion [degrees]: the zero of the tables is uncertain."""
_ANKLE_EXPONENT = 3.0
"""Exponent of the step in the range of the ankle, fitted: with 1 slow feet push off so far that knees bend 11 degrees
beyond the regression."""
_FLAT = (0.14, 0.28, 0.48, 0.70)
"""Shares of the stance: begin and end of foot-flat, begin and end of heel rise."""


def stance_share(speed: float) -> float:
    """Return the stance phase at a speed [m/s] as a share of the cycle, longer when slower."""
    return min(0.72, max(0.56, NATURAL_STANCE + 0.13 * (_NATURAL - speed)))


def knee_by_speed(speed: float) -> F8:
    """Return the knee flexion of the regression at a speed [m/s], [degrees], [50]."""
    return curve_by_events((_WHEN, _ANGLE, _SLOPE, _BEND), speed)


def curve_by_events(events: Events, speed: float) -> F8:
    """Return a joint of the regression at a speed [m/s] and a body height of 1.75 m, [degrees], [50].

    Args:
        events: Times of six events [samples of 1 %, from 1], angles there [degrees], their first and second
            derivatives: factors of 1, speed [km/h], its square and body height [m].
        speed: [m/s]
    """
    kmh = 3.6 * min(max(speed, 0.14), 1.39)  # the measured range
    terms = np.array([1.0, kmh, kmh * kmh, _HEIGHT])
    when, angle, slope, bend = (np.array(rows) @ terms for rows in events)
    when = np.append(when, 101.0) - 1.0  # from heel contact
    at = np.arange(SAMPLES) * 100.0 / SAMPLES
    curve = np.empty(SAMPLES)
    for k in range(6):
        n = (k + 1) % 6
        length = when[k + 1] - when[k]
        ends = (angle[k], slope[k] * length, bend[k] * length**2, angle[n], slope[n] * length, bend[n] * length**2)
        inside = (at >= when[k]) & (at < when[k + 1])
        curve[inside] = _quintic((at[inside] - when[k]) / length, ends)
    return curve


def _quintic(x: F8, ends: tuple[float, ...]) -> F8:
    """Evaluate the quintic polynomial with given value and two derivatives at 0 and 1."""
    y0, d0, c0, y1, d1, c1 = ends
    step, d, c = y1 - y0 - d0 - 0.5 * c0, d1 - d0 - c0, c1 - c0
    cubic, fourth, fifth = 10.0 * step - 4.0 * d + 0.5 * c, -15.0 * step + 7.0 * d - c, 6.0 * step - 3.0 * d + 0.5 * c
    return np.asarray(y0 + x * (d0 + x * (0.5 * c0 + x * (cubic + x * (fourth + x * fifth)))))


@lru_cache(maxsize=512)
def shape_gait(speed: float, stretch: float) -> F8:
    """Return the angles of a leg over a cycle: thigh forward, knee flexion, foot pitch [rad].

    Args:
        speed: Speed [m/s].
        stretch: Step over that of the natural table, both over the leg's length.

    Returns:
        [50, 3]; pitch is positive toes up, and exactly 0 in foot-flat.
    """
    stance = stance_share(speed)
    phase = np.arange(SAMPLES) / SAMPLES
    standing = phase < stance
    natural_phase = np.where(
        standing,
        phase * NATURAL_STANCE / stance,
        NATURAL_STANCE + (phase - stance) * (1.0 - NATURAL_STANCE) / (1.0 - stance),
    )
    hip, knee, ankle = (
        np.interp(natural_phase, np.arange(SAMPLES) / SAMPLES, NATURAL[name], period=1.0)
        for name in ("hip", "knee", "ankle")
    )
    thigh = hip - TILT
    middle = 0.5 * float(thigh.max() + thigh.min())
    thigh = middle * min(stretch, 1.0) + stretch * (thigh - middle)
    share = min(max((speed - _SLOW) / (_NATURAL - _SLOW), 0.0), 1.0)
    knee = share * knee + (1.0 - share) * knee_by_speed(speed)
    knee = np.maximum(knee, _MIN_KNEE)
    x = phase / stance
    down, flat, rises, high = _FLAT
    window = np.clip((flat - x) / (flat - down), 0.0, 1.0) + np.clip((x - rises) / (high - rises), 0.0, 1.0)
    pitch = thigh - knee + min(stretch, 1.0) ** _ANKLE_EXPONENT * ankle
    # Pitch is 0 in foot-flat, because the zero of the ankle differs between tables.
    pitch -= float(pitch[(x > flat) & (x < rises)].mean())
    pitch = np.where(standing, window * pitch, pitch)
    pitch = np.where(x < flat, np.maximum(pitch, 0.0), np.where(standing, np.minimum(pitch, 0.0), pitch))
    table = np.radians(np.stack([thigh, knee, pitch], axis=1))
    table.setflags(write=False)
    return table
