"""Impulse F_imp of D2.1 4.3.2: applied "on contact", it "pushes the leg out"; the text has no formula for it.

    P = m (1 + e) |v_n|,     F_imp = P / (N T) over N ticks

m is the effective mass of the leg along the normal, v_n its speed into the object at first touch, e the restitution.
A spring that stores the impact would push the leg out a second time. Restitution therefore has one owner: without an
impulse it is the damping of the penalty force; with one the penalty spring begins at the depth that the leg has reached
when the impulse is spent, and this offset fades, so that a leg that stays is pushed to the surface.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from mimics_app.compiled.kernel import kernel

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import ImpulseRecord, ImpulseSettingsRecord

__all__ = ["IMPULSE", "IMPULSE_SETTINGS", "effective_mass", "impulse_force", "spring_depth"]

IMPULSE = np.dtype(
    [
        ("touching", np.int64),
        ("left", np.int64),  # ticks in which the impulse still acts
        ("force", np.float64),  # in each of them [N]
        ("offset", np.float64),  # depth at which the penalty spring begins [m]
    ],
    align=True,
)
"""Impulse of one contact; zeros are the initial state."""

IMPULSE_SETTINGS = np.dtype(
    [
        ("ticks", np.int64),  # over which the impulse is spread; 0: no impulse, the penalty owns the restitution
        ("restitution", np.float64),  # e, 0-1
        ("force_limit", np.float64),  # largest F_imp [N]; what is beyond it is lost
        ("fading", np.float64),  # time constant of the spring's offset [s]
    ],
    align=True,
)


@kernel
def effective_mass(slope_1: float, slope_2: float, m11: float, m12: float, m22: float) -> float:
    """Mass [kg] of a leg along a direction: 1 / (J_n M^-1 J_n^T).

    Args:
        slope_1: J_n, motion along the direction per motion of the first coordinate.
        slope_2: Likewise of the second.
        m11: Entries of the mass matrix M.
        m12: Likewise.
        m22: Likewise.
    """
    determinant = m11 * m22 - m12 * m12
    square = m22 * slope_1 * slope_1 - 2.0 * m12 * slope_1 * slope_2 + m11 * slope_2 * slope_2
    return determinant / square if square > 0.0 else math.inf


@kernel
def impulse_force(
    impulse: ImpulseRecord, settings: ImpulseSettingsRecord, depth: float, rate: float, mass: float, dt: float
) -> float:
    """F_imp [N] of this tick along the outward normal, once per contact and never for a leg that leaves.

    Args:
        impulse: IMPULSE record, advanced.
        settings: IMPULSE_SETTINGS record.
        depth: Penetration [m], positive inside.
        rate: Its rate [m/s], positive going in.
        mass: Effective mass along the normal [kg].
        dt: Tick [s].
    """
    if depth <= 0.0 and impulse.left == 0:
        impulse.touching, impulse.offset = 0, 0.0
        return 0.0
    if impulse.touching == 0:
        impulse.touching = 1
        if settings.ticks > 0 and rate > 0.0:
            impulse.left = settings.ticks
            wanted = mass * (1.0 + settings.restitution) * rate / (settings.ticks * dt)
            impulse.force = min(settings.force_limit, wanted)
    if impulse.left > 0:
        impulse.left -= 1
        impulse.offset = max(0.0, depth)
        return impulse.force
    impulse.offset = min(depth, impulse.offset * math.exp(-dt / settings.fading))
    return 0.0


@kernel
def spring_depth(impulse: ImpulseRecord, depth: float) -> float:
    """Depth [m] for the penalty force of this tick; call after `impulse_force`."""
    return max(0.0, depth - impulse.offset)
