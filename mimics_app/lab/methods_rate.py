"""How often a wall is felt: the energy a sampled wall gives away at every tap, against what the ticks cost.

A point goes in at constant speed v to depth d and out again. The force of a spring sampled every T and held is too
small on the way in and too large on the way out: the wall gives K T v d away (Gillespie & Cutkosky 1996), whatever
device is behind it. The tap is rendered by the functions of the loop: shape, law, and passivity observer.

Importing this module registers the group.
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.kernel import kernel
from mimics_app.contracts.methods import Group, Method, registry
from mimics_app.contracts.probe import reference_us, shortest_us
from mimics_app.rendering.haptic.kernels.contact import rate_of_depth, wall
from mimics_app.rendering.haptic.kernels.contact_law import spring_damper
from mimics_app.rendering.haptic.kernels.contact_records import CONTACT
from mimics_app.rendering.haptic.kernels.passivity import OBSERVER, observe

if TYPE_CHECKING:
    from mimics_app.contracts.record_types import ContactRecord, ObserverRecord, Table

__all__ = ["DEPTH", "GROUP", "RATES", "SPEED", "STIFFNESS", "tap_leak"]

Vec = NDArray[np.float64]

GROUP = "haptic rate"

RATES = (60, 250, 500, 1000, 2500, 4000)
"""Ticks per second [Hz]: a picture, half the seed's limit, the seed's limit (4.3.1), ours, the HapticMaster, 4 kHz."""

STIFFNESS = 2000.0
"""Of the wall [N/m], as the tunnel's."""

SPEED = 0.2
"""Of the tap [m/s]."""

DEPTH = 5e-3
"""Of the tap [m]."""

_PHASES = 97
_OURS = 1000
_UP = 1e-3

_PLACES = 4
"""Depths that a touch goes through."""


@kernel
def _tap(rate: int, phase: float, k: float, contact: ContactRecord, observer: ObserverRecord) -> float:
    """Energy given away by the wall in one tap [J]; the first tick falls `phase` of a tick after the touch."""
    dt = 1.0 / rate
    ticks = int(2.0 * DEPTH / SPEED * rate) + 3
    p, v, force = np.zeros(3), np.zeros(3), np.zeros(3)
    energy = 0.0
    for i in range(ticks):
        t = (i - 1 + phase) * dt
        turn = DEPTH / SPEED
        p[2] = SPEED * abs(t - turn) - DEPTH
        v[2] = SPEED if t > turn else -SPEED
        wall(p, contact)
        force[2] = spring_damper(contact.depth, rate_of_depth(v, contact), k, 0.0)
        energy = observe(observer, p, force)
    return -energy


@kernel
def _taps(rate: int, phases: int, k: float, contact: ContactRecord, observers: Table[ObserverRecord]) -> float:
    """Mean over evenly spread phases [J]."""
    total = 0.0
    for i in range(phases):
        total += _tap(rate, (i + 0.5) / phases, k, contact, observers[i])
    return total / phases


def tap_leak(rate: int) -> float:
    """Energy the wall gives away at one tap [J], mean over where in a tick the touch falls; K T v d in theory."""
    return _taps(rate, _PHASES, STIFFNESS, np.zeros(1, CONTACT)[0], np.zeros(_PHASES, OBSERVER))


@kernel
def _stay(ticks: int, k: float, contact: ContactRecord, observer: ObserverRecord) -> float:
    """Ticks in the wall: what one second of touch costs."""
    p, v, force = np.zeros(3), np.zeros(3), np.zeros(3)
    energy = 0.0
    for i in range(ticks):
        p[2] = -_UP * (1 + i % _PLACES)
        wall(p, contact)
        force[2] = spring_damper(contact.depth, rate_of_depth(v, contact), k, 0.0)
        energy = observe(observer, p, force)
    return energy


def _cost_us(rate: int) -> float:
    """Cost of one simulated second of touch [us]."""
    contact, observer = np.zeros(1, CONTACT)[0], np.zeros(1, OBSERVER)[0]
    return shortest_us(lambda: _stay(100 * rate, STIFFNESS, contact, observer), 100)


registry.describe(
    Group(
        name=GROUP,
        what=f"a wall of {STIFFNESS:g} N/m tapped {DEPTH * 1e3:g} mm deep at {SPEED:g} m/s; cost per second of touch, "
        "error: energy it gives away per tap (K T v d)",
        unit="J",
        work="",
        reference=reference_us,
    )
)
for _rate in RATES:
    registry.register(
        Method(
            group=GROUP,
            name=f"{_rate} Hz",
            source=f"wall, spring and observer of the loop every {1e3 / _rate:.3g} ms",
            cost=partial(_cost_us, _rate),
            error=partial(tap_leak, _rate),
            unit="J",
            valid_range=f"stable up to K = 2 b / T: {2 * 5 * _rate:g} N/m with b = 5 N s/m",
            settings={} if _rate == _OURS else None,
            default=_rate == _OURS,
        )
    )
