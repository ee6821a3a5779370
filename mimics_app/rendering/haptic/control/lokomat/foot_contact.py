"""Force of an object on the foot in pure impedance control (D2.1 4.3.2): impulse, penalty and friction.

    F = (F_imp + F_penal) n + F_fric,     tau = J^T F

F_penal is Hunt and Crossley's, which the text prints as k dx + c dx * b dx' (lam = c b). The friction is the anchor of
`kernels.friction`, since the text promises stiction; the printed law, without its minus sign and without clamp, can be
chosen for simulated devices: it drives the foot.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.rendering.haptic.control.lokomat.contact_impulse import (
    IMPULSE,
    IMPULSE_SETTINGS,
    impulse_force,
    spring_depth,
)
from mimics_app.rendering.haptic.kernels.contact_law import hunt_crossley
from mimics_app.rendering.haptic.kernels.contact_records import FRICTION
from mimics_app.rendering.haptic.kernels.friction import hayward_armstrong

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import FootContactRecord, FootSettingsRecord

__all__ = ["FOOT_CONTACT", "FOOT_SETTINGS", "push_foot"]

FOOT_SETTINGS = np.dtype(
    [
        ("stiffness", np.float64),  # k [N/m]
        ("damping", np.float64),  # lam = c b [N s/m^2]
        ("friction", np.float64),  # mu
        ("anchor", np.float64),  # stiffness of the friction's anchor [N/m]
        ("threshold", np.float64),  # v_threshold of the printed friction [m/s], > 0
        ("as_printed", np.int64),
        ("impulse", IMPULSE_SETTINGS),
    ],
    align=True,
)

FOOT_CONTACT = np.dtype(
    [
        ("impulse", IMPULSE),
        ("friction", FRICTION),
        ("way", np.float64, (1,)),  # path of the foot along the surface [m]
        ("drag", np.float64, (1,)),  # friction along it [N]
        ("normal_force", np.float64),  # [N] >= 0
    ],
    align=True,
)
"""Contact of one foot; zeros are the initial state."""

_EXPONENT = 1.0
"""Exponent n of the depth: 4.3.2 prints 1."""


@kernel
def push_foot(
    contact: FootContactRecord,
    settings: FootSettingsRecord,
    depth: float,
    normal: Vec,
    velocity: Vec,
    mass: float,
    dt: float,
    force: Vec,
) -> None:
    """Set the force of an object on the foot.

    Args:
        contact: FOOT_CONTACT record, advanced.
        settings: FOOT_SETTINGS record.
        depth: Penetration [m], positive inside.
        normal: Outward normal in the plane of the leg (x, z), shape [2].
        velocity: Velocity of the foot relative to the object (x, z) [m/s], shape [2].
        mass: Effective mass of the leg along the normal [kg], see `effective_mass`.
        dt: Tick [s].
        force: Out: force on the foot (x, z) [N], shape [2].
    """
    rate = -(normal[0] * velocity[0] + normal[1] * velocity[1])
    speed = normal[1] * velocity[0] - normal[0] * velocity[1]
    contact.way[0] += speed * dt
    if settings.as_printed == 1:
        _push_printed(contact, settings, depth, rate, speed)
    else:
        pulse = impulse_force(contact.impulse, settings.impulse, depth, rate, mass, dt)
        spring = spring_depth(contact.impulse, depth)
        contact.normal_force = pulse + hunt_crossley(spring, rate, settings.stiffness, settings.damping, _EXPONENT)
        hayward_armstrong(
            contact.way, contact.normal_force, settings.friction, settings.anchor, contact.friction, contact.drag
        )
    force[0] = contact.normal_force * normal[0] + contact.drag[0] * normal[1]
    force[1] = contact.normal_force * normal[1] - contact.drag[0] * normal[0]


@kernel
def _push_printed(
    contact: FootContactRecord, settings: FootSettingsRecord, depth: float, rate: float, speed: float
) -> None:
    """The penalty without clamp, and the friction along the velocity instead of against it."""
    inside = max(0.0, depth)
    contact.normal_force = (settings.stiffness + settings.damping * rate) * inside
    contact.drag[0] = settings.friction * contact.normal_force * speed / max(abs(speed), settings.threshold)
