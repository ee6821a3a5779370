"""Taps on a sampled spring: a point enters a wall at constant speed, turns, and leaves as fast.

The force of each tick is held until the next, too small on the way in and too large on the way out: the wall generates
K T v d (Gillespie & Cutkosky 1996).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.rendering.haptic.kernels.contact_law import spring_damper
from mimics_app.rendering.haptic.kernels.passivity import OBSERVER, observe

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import ObserverRecord

__all__ = ["observed_leak"]

_PHASES = 400
"""Phases of the ticks over which a mean is taken."""

_OUTSIDE = 4
"""Ticks of a tap before and after the touch."""


@kernel
def _tap(
    speed: float, depth: float, k: float, dt: float, phase: float, late: int, observer: ObserverRecord
) -> tuple[float, float]:
    """Return the energy that a wall takes in a tap [J]: by the passivity observer, and by summing T f v.

    The first tick falls `phase` of a tick after the touch; `late` ticks delay the force, as a fault of the loop.
    """
    position = np.zeros(3)
    push = np.zeros(3)
    line = np.zeros(late + 1)
    taken = 0.0
    naive = 0.0
    ticks = int(2.0 * depth / (speed * dt)) + _OUTSIDE + late
    for i in range(ticks):
        t = (i - 1 + phase) * dt
        going_in = speed * t <= depth
        x = speed * t if going_in else 2.0 * depth - speed * t
        line[i % (late + 1)] = spring_damper(x, 0.0, k, 0.0)
        position[2] = -x
        push[2] = line[(i + 1) % (late + 1)]
        taken = observe(observer, position, push)
        naive += dt * push[2] * (speed if going_in else -speed)
    return taken, naive


def observed_leak(
    speed: float, depth: float, stiffness: float = 2000.0, rate: float = 1000.0, late: int = 0
) -> tuple[float, float]:
    """Return the energy that a sampled spring generates in a tap [J], mean over the phases of the ticks.

    Args:
        speed: Speed of the hand [m/s], in and out.
        depth: Depth at which it turns [m].
        stiffness: Stiffness of the wall [N/m].
        rate: Ticks per second [Hz].
        late: Delay of the force [ticks].

    Returns:
        (by the passivity observer, by the sum of T f v).
    """
    counted = np.zeros(2)
    for i in range(_PHASES):
        observer = np.zeros(1, OBSERVER)[0]
        counted += _tap(speed, depth, stiffness, 1.0 / rate, (i + 0.5) / _PHASES, late, observer)
    return float(-counted[0] / _PHASES), float(-counted[1] / _PHASES)
