"""Contact laws, with their cost and error.

A free mass of 0.2 kg bounces on 2 kN/m at 1 ms; error of its restitution against the closed form of a contact without
tension, the largest over the phases of the tick at impact.
"""

from __future__ import annotations

import math

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import F8
from mimics_app.lab.haptic.printed_equations import spring_damper_printed
from mimics_app.lab.haptic.probe import SIZES, reference_us
from mimics_app.lab.probe import shortest_us
from mimics_app.lab.rivals import Growth, Probes, Rival, compare
from mimics_app.rendering.haptic.kernels.contact_law import hunt_crossley, spring_damper
from mimics_app.rendering.haptic.kernels.integrators import step_semi_implicit

__all__ = [
    "bounce",
    "restitution_hunt_crossley",
    "restitution_spring_damper",
]


_RIVALS = (
    Rival("(9) printed", "spring and damper without clamp: pulls on the way out", "demonstration"),
    Rival(
        "(9) clamped",
        "max(0, k d + b d')",
        "(h^2 k + 2 h b) < 4 m; force steps by b v at first touch",
        {"law": "spring_damper"},
    ),
    Rival(
        "Hunt-Crossley, n = 1",
        "max(0, k d + lam d d') (Hunt & Crossley 1975), what 4.3.2 prints",
        "h^2 k < 4 m; no step at first touch",
        {"law": "hunt_crossley", "exponent": 1.0},
    ),
    Rival(
        "Hunt-Crossley, n = 1.5",
        "max(0, k d^1.5 + lam d^1.5 d'): Hertz's sphere with Hunt and Crossley's damper",
        "stiffness grows with depth: check h^2 k' < 4 m at the greatest depth",
        {"law": "hunt_crossley", "exponent": 1.5},
    ),
)
"""In the order of their numbers in the compiled loops; a scene cannot request a law that pulls."""

_NUMBERS = {rival.name: number for number, rival in enumerate(_RIVALS)}

_MASS = 0.2  # [kg]
_STIFFNESS = 2000.0  # [N/m], or [N/m^n] / sqrt(1 mm) for n = 1.5
_HERTZ = 2000.0 / math.sqrt(1e-3)  # [N/m^1.5]: as stiff as the others at 1 mm
_SPEED = 0.1  # [m/s]
_ZETA = 0.3
_DAMPING = 2.0 * _ZETA * math.sqrt(_STIFFNESS * _MASS)  # [N s/m]
_U = 0.5  # lam v0 / k of Hunt and Crossley: about the same restitution as zeta = 0.3
_DT = 1e-3
_PHASES = 16
_MOST_STEPS = 10_000_000
_CALLS = 20_000

_HERTZIAN = 1.5
"""Exponent of Hertz's sphere."""

_MIDDLE = 1e-3
"""Mean depth of pressed contacts [m]."""


@kernel
def _force(number: int, depth: float, rate: float) -> float:
    if number == 0:
        return spring_damper_printed(depth, rate, _STIFFNESS, _DAMPING)
    if number == 1:
        return spring_damper(depth, rate, _STIFFNESS, _DAMPING)
    if number == 2:
        return hunt_crossley(depth, rate, _STIFFNESS, _U * _STIFFNESS / _SPEED, 1.0)
    return hunt_crossley(depth, rate, _HERTZ, _U * _HERTZ / _SPEED, _HERTZIAN)


@kernel
def _bounce(number: int, outside: float, dt: float) -> float:
    depth, rate = -outside, _SPEED
    touched = False
    for _ in range(_MOST_STEPS):
        touched = touched or depth > 0.0
        if touched and depth <= 0.0:
            break
        depth, rate = step_semi_implicit(depth, rate, -_force(number, depth, rate), _MASS, 0.0, 0.0, dt)
    return -rate / _SPEED


def bounce(law: str, phase: float = 0.0, dt: float = _DT) -> float:
    """Return the restitution, speed after over speed before, of the probe mass under a law.

    Args:
        law: Name of the law.
        phase: Time of the impact between two ticks, 0 to 1 (1: just before the next).
        dt: Tick [s].
    """
    return _bounce(_NUMBERS[law], phase * _SPEED * dt, dt)


def restitution_spring_damper(zeta: float) -> float:
    """Return the restitution of (9) clamped: exp(-2 zeta a), a = arccos(zeta)/sqrt(1 - zeta^2); above 1 by arccosh."""
    if zeta == 1.0:
        return math.exp(-2.0)
    a = math.acos(zeta) if zeta < 1.0 else math.acosh(zeta)
    return math.exp(-2.0 * zeta * a / math.sqrt(abs(1.0 - zeta * zeta)))


def restitution_hunt_crossley(u: float) -> float:
    """Return e in 0..1 with (1 + e) u = ln((1 + u)/(1 - e u)), u = lam v0/k > 0, for any exponent and mass."""
    low, high = 0.0, min(1.0, (1.0 - 1e-15) / u)
    for _ in range(200):
        e = 0.5 * (low + high)
        if (1.0 + e) * u > math.log((1.0 + u) / (1.0 - e * u)):
            low = e
        else:
            high = e
    return 0.5 * (low + high)


def _restitution_error(law: str, dt: float = _DT) -> float:
    """Return the largest difference of the restitution from the closed form over the phases of the impact."""
    exact = restitution_spring_damper(_ZETA) if law.startswith("(9)") else restitution_hunt_crossley(_U)
    return max(abs(bounce(law, phase / _PHASES, dt) - exact) for phase in range(_PHASES))


@kernel
def _press(number: int, ticks: int, depth: F8, rate: F8, total: F8) -> None:
    """Run ticks of contacts with changing depths, so that the compiler cannot hoist work out of the loop."""
    for _ in range(ticks):
        for i in range(depth.shape[0]):
            total[i] += _force(number, depth[i], rate[i])
            depth[i] = _MIDDLE + 0.5 * (depth[i] - _MIDDLE)


def _cost_us(law: str, contacts: int) -> float:
    ticks = max(1, _CALLS // contacts)
    depth, rate, total = np.full(contacts, 2e-3), np.full(contacts, 0.01), np.zeros(contacts)
    return shortest_us(lambda: _press(_NUMBERS[law], ticks, depth, rate, total), ticks)


compare(
    __name__,
    "normal force of a contact; error: restitution of 0.2 kg at 1 ms against a contact that only pushes",
    "restitution",
    _RIVALS,
    Probes(_cost_us, _restitution_error, reference_us),
    default="(9) clamped",
    growth=Growth(work="contacts", sizes=SIZES),
)
