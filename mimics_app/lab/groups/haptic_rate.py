"""Rate of a sampled wall: the energy it generates in each tap, against the cost of its ticks.

A tap of speed v and depth d on a spring K that is sampled every T and held generates K T v d (see `haptic.taps`),
whatever device is behind it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.lab.haptic.face_rules import rate_of_depth
from mimics_app.lab.haptic.taps import observed_leak
from mimics_app.lab.probe import shortest_us
from mimics_app.lab.rivals import Probes, Rival, compare
from mimics_app.rendering.haptic.kernels.contact import wall
from mimics_app.rendering.haptic.kernels.contact_law import spring_damper
from mimics_app.rendering.haptic.kernels.contact_records import CONTACT
from mimics_app.rendering.haptic.kernels.passivity import OBSERVER, observe

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import ContactRecord, ObserverRecord

__all__ = ["DEPTH", "RATES", "SPEED", "STIFFNESS", "tap_leak"]


RATES = (60, 250, 500, 1000, 2500, 4000)
"""Ticks per second [Hz]: a picture, half the limit of D2.1, its limit (4.3.1), ours, the HapticMaster, 4 kHz."""

STIFFNESS = 2000.0
"""Of the wall [N/m], as the tunnel's."""

SPEED = 0.2
"""Of the tap [m/s]."""

DEPTH = 5e-3
"""Of the tap [m]."""

_OURS = 1000
_UP = 1e-3

_PLACES = 4
"""Number of depths in a sequence of ticks inside the wall."""


def tap_leak(rate: int) -> float:
    """Return the energy that the wall generates in a tap [J], mean over the phases of the ticks; K T v d in theory."""
    return observed_leak(SPEED, DEPTH, STIFFNESS, rate)[0]


@kernel
def _stay(ticks: int, k: float, contact: ContactRecord, observer: ObserverRecord) -> float:
    """Run ticks inside the wall: shape, law and passivity observer of the loop."""
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


compare(
    __name__,
    f"a wall of {STIFFNESS:g} N/m tapped {DEPTH * 1e3:g} mm deep at {SPEED:g} m/s; cost per second of touch, "
    "error: energy it generates per tap (K T v d)",
    "J",
    [
        Rival(
            f"{rate} Hz",
            f"wall, spring and observer of the loop every {1e3 / rate:.3g} ms",
            f"stable up to K = 2 b / T: {2 * 5 * rate:g} N/m with b = 5 N s/m",
            {} if rate == _OURS else None,
            (rate,),
        )
        for rate in RATES
    ],
    Probes(_cost_us, tap_leak),
    default=f"{_OURS} Hz",
)
