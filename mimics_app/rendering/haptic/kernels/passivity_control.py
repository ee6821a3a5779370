"""Passivity controller: takes back the energy that a rendered contact has made (after Hannaford & Ryu 2002).

A contact may give back what it took and no more. Its credit counts the exact work of held forces on what they act on:

    impedance    a device that is told forces: the device itself, E -= F_{k-1}.(x_k - x_{k-1})
    admittance   a device that is told velocities: the virtual mass, which the force moves before the device follows

When the coming tick would overdraw the credit, a damper -E / (T v^2) along the contact's force takes what is missing:
in the first form in parallel with the contact, which it never makes pull; in the second as virtual damping of the mass.
Hannaford and Ryu put a mobility -E / (T f^2) in series there. It would show only after the servo's lag, and at the
measured position there is nothing to see: a wall far beyond its limit swings up by the energy that the lag feeds into
the virtual mass, while it takes energy from the device that follows.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.kernel import kernel
from mimics_app.rendering.haptic.kernels.vectors import norm

__all__ = ["contact_scale", "limited_credit"]

Vec = NDArray[np.float64]


@kernel
def limited_credit(credit: float, stored: float) -> float:
    """Credit [J], at most what the contact's springs can hold [J].

    Energy that was lost in dampers or friction is gone; kept as credit it would hide what is made later.
    """
    return min(credit, stored)


@kernel
def _lacking(credit: float, force: Vec, v: Vec, dt: float) -> float:
    """Energy [J] by which the coming tick would overdraw the credit: power given times tick, less credit."""
    return (force[0] * v[0] + force[1] * v[1] + force[2] * v[2]) * dt - credit


@kernel
def contact_scale(credit: float, force: Vec, v: Vec, dt: float, most: float, least: float) -> float:
    """Factor on the contact's force, which adds a damper alpha along it; 1 while the credit lasts.

    Args:
        credit: Energy the contact may still give [J]; below 0 it owes.
        force: Of the contact on the user [N], shape [3].
        v: Velocity of what it acts on [m/s], shape [3], same frame.
        dt: Tick [s].
        most: Largest alpha [N s/m].
        least: Smallest factor: 0, or below where the contact may hold back.
    """
    size = norm(force)
    lacking = _lacking(credit, force, v, dt)
    if not (lacking > 0.0 and size > 0.0):
        return 1.0
    along = (force[0] * v[0] + force[1] * v[1] + force[2] * v[2]) / size
    if along == 0.0:
        return 1.0
    alpha = min(most, lacking / (dt * along * along))
    return max(least, 1.0 - alpha * along / size)
