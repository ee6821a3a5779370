"""Sampled, delayed wall, simulated and exact, for S3 and S3R.

A device of mass m and own damping b is pressed into a wall. Each tick its position is sampled, the wall's law gives a
force from depth and differenced depth, and that force acts, held, n ticks later.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Mat, Vec
from mimics_app.lab.stability.growth import LENGTHEN, QUARTERS, decay_sign, dies_away, note_peak
from mimics_app.lab.stability.linear import find_limit, hold, is_contracting
from mimics_app.rendering.haptic.kernels.contact_law import spring_damper
from mimics_app.rendering.haptic.kernels.integrators import step_free

__all__ = [
    "APART",
    "DEPTH",
    "LARGE",
    "LONGEST",
    "PRECISION",
    "SHORTEST",
    "SOFT",
    "Wall",
    "decide",
    "delayed_loop",
    "exact_limit",
    "exact_matrix",
    "is_stable",
    "press_wall",
    "rule_limit",
    "simulated_limit",
]


_SHORTEST, _LONGEST = 2_000, 128_000
"""Lengths of the first and of the last run [ticks]."""


@kernel
def _decide(k: Vec, B: Vec, m: Vec, b: Vec, dt: Vec, delay: NDArray[np.int64], stable: NDArray[np.uint8]) -> None:
    """Whether the motion of each point dies away, as `growth.dies_away`."""
    line = np.zeros(np.max(delay) + 1)
    peaks = np.zeros(QUARTERS)
    for i in range(k.shape[0]):
        ticks, sign = _SHORTEST, 0
        while sign == 0:
            press_wall(k[i], B[i], m[i], b[i], dt[i], delay[i], ticks, line, peaks)
            sign = decay_sign(peaks, ticks >= _LONGEST)
            ticks *= LENGTHEN
        stable[i] = 1 if sign > 0 else 0


def decide(
    stiffness: Sequence[Any],
    wall_damping: Sequence[Any],
    mass: Sequence[Any],
    device_damping: Sequence[Any],
    period: Sequence[Any],
    delay_ticks: Sequence[Any],
) -> list[bool]:
    """Return for each point whether the wall is stable [N/m, N s/m, kg, N s/m, s, ticks]."""
    delay = np.array(delay_ticks, np.int64)
    stable = np.zeros(len(delay), np.uint8)
    k, B, m, b, dt = (np.array(each, np.float64) for each in (stiffness, wall_damping, mass, device_damping, period))
    _decide(k, B, m, b, dt, delay, stable)
    return stable.astype(bool).tolist()


DEPTH = 1000.0
"""Depth at rest [m], so large that the surface is never reached and the law never clamped."""

APART = 1e-3
"""Initial distance from rest along the normal [m]."""

LARGE = 1.0
"""Distance from rest from which a motion does not return [m]; the law is still linear there."""

SHORTEST, LONGEST = 8_000, 400_000
"""Lengths of the first and of the last simulation [ticks]."""

PRECISION = 4e-3
"""Relative precision of a simulated limit."""

SOFT, _HARD = 1.0, 1e7
"""Ends of the search for a limit [N/m]."""


@dataclass(frozen=True, slots=True)
class Wall:
    """A device in front of a wall.

    Attributes:
        mass: Mass of the device and its load [kg].
        device_damping: Physical damping b of device and hand [N s/m].
        wall_damping: Damping B of the wall's law [N s/m].
        rate: Ticks per second [Hz].
        delay: Whole ticks between sampling and acting, n.
    """

    mass: float = 3.0
    device_damping: float = 5.0
    wall_damping: float = 0.0
    rate: float = 1000.0
    delay: int = 0


@kernel
def press_wall(
    k: float, B: float, m: float, b: float, dt: float, delay: int, ticks: int, line: Vec, peaks: Vec
) -> None:
    """Simulate the device in the wall, released at a distance from rest.

    Args:
        k: Stiffness of the wall [N/m].
        B: Damping of its law [N s/m].
        m: Mass of the device [kg].
        b: Its own damping [N s/m].
        dt: Tick [s].
        delay: Ticks between sampling and acting.
        ticks: Length of the run [ticks].
        line: Delay line of the forces, shape [at least delay + 1].
        peaks: Receives the peaks of the distance from rest by quarter of the run [m], shape [4], see `note_peak`.
    """
    line[: delay + 1] = k * DEPTH
    peaks[:] = 0.0
    x = DEPTH + APART
    last = x
    v = 0.0
    for i in range(ticks):
        line[i % (delay + 1)] = spring_damper(x, (x - last) / dt, k, B)
        last = x
        x, v = step_free(x, v, k * DEPTH - line[(i + 1) % (delay + 1)], m, b, dt)
        if note_peak(abs(x - DEPTH), i, ticks, LARGE, peaks):
            return


def is_stable(wall: Wall, stiffness: float) -> bool:
    """Whether a wall of a stiffness [N/m] is stable, by simulation."""

    def run(ticks: int) -> Vec:
        peaks = np.zeros(4)
        m, b, B, dt = wall.mass, wall.device_damping, wall.wall_damping, 1.0 / wall.rate
        press_wall(stiffness, B, m, b, dt, wall.delay, ticks, np.zeros(wall.delay + 1), peaks)
        return peaks

    return dies_away(run, SHORTEST, LONGEST)


def simulated_limit(wall: Wall, extra_delay: int = 0) -> float:
    """Return the largest stable stiffness by simulation [N/m]; `extra_delay` [ticks]: a fault of it alone."""
    late = replace(wall, delay=wall.delay + extra_delay)
    return find_limit(lambda stiffness: is_stable(late, stiffness), SOFT, _HARD, PRECISION)


def delayed_loop(K: Mat, B: Mat, m: float, b: float, dt: float, n: int) -> Mat:
    """Return one tick of a mass in sampled, delayed contacts as a matrix, shape [(3 + n) r, (3 + n) r].

    The state is position, velocity, last position and the forces under way, newest first, in r directions.

    Args:
        K: Stiffness of the contacts [N/m], shape [r, r].
        B: Damping of the contacts [N s/m], shape [r, r].
        m: Mass of the device [kg].
        b: Damping of the device [N s/m].
        dt: Tick [s].
        n: Delay between sampling and acting [ticks].
    """
    r = len(K)
    one, none = np.eye(r), np.zeros((r, r))
    A, held = hold(np.block([[none, one], [none, -b / m * one]]), np.vstack([none, one / m]), dt)
    law = np.hstack([-(K + B / dt), none, B / dt])
    step = np.zeros(((3 + n) * r, (3 + n) * r))
    step[: 2 * r, : 2 * r] = A
    step[2 * r : 3 * r, :r] = one
    if n == 0:
        step[: 2 * r] += held @ law
        return step
    step[: 2 * r, (2 + n) * r :] = held
    step[3 * r : 4 * r, : 3 * r] = law
    step[4 * r :, 3 * r : (2 + n) * r] = np.eye((n - 1) * r)
    return step


def exact_matrix(wall: Wall, stiffness: float) -> Mat:
    """Return one tick of the loop as a matrix, see `delayed_loop`."""
    K, B = np.array([[stiffness]]), np.array([[wall.wall_damping]])
    return delayed_loop(K, B, wall.mass, wall.device_damping, 1.0 / wall.rate, wall.delay)


def exact_limit(wall: Wall) -> float:
    """Return the largest stable stiffness by eigenvalues [N/m]."""
    return find_limit(lambda stiffness: is_contracting(exact_matrix(wall, stiffness)), SOFT, _HARD)


def rule_limit(wall: Wall) -> float:
    """Return the limit by the common rule (b + B) / (T/2 + n T) [N/m] (Gil et al. 2004, Hulin et al. 2008)."""
    return (wall.device_damping + wall.wall_damping) * wall.rate / (0.5 + wall.delay)
