"""Passivity controller: dissipates the energy that a rendered contact has made (after Hannaford & Ryu 2002).

A contact may give back what it took and no more. Its credit counts the exact work of held forces on what they act on:

    impedance    a device that takes forces: the device itself, E -= F_{k-1}.(x_k - x_{k-1})
    admittance   a device that takes velocities: the virtual mass, which the force moves before the device follows

When the coming tick would overdraw the credit, a damper -E / (T v^2) along the contact's force takes what is missing,
in parallel with the contact, which it never makes pull: the factor on the force is 0 at least. A debt could only be
paid by a pull, so none may arise: the tick is predicted with the velocity at its middle (`middle_velocity`).

Hannaford and Ryu put a mobility -E / (T f^2) in series there. It would show only after the servo's lag, and at the
measured position there is nothing to see: a wall far beyond its limit swings up by the energy that the lag feeds into
the virtual mass, while it takes energy from the device that follows.
"""

from __future__ import annotations

from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.kernel import kernel
from mimics_app.rendering.haptic.kernels.vectors import norm

__all__ = ["contact_scale", "limited_credit", "middle_velocity"]


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
def middle_velocity(v: Vec, force: Vec, hand: Vec, mass: float, dt: float, out: Vec) -> None:
    """Velocity of a virtual mass in the middle of the coming tick, which makes force times displacement exact.

    With the whole contact force: what it accelerates outwards it is charged for, before it is scaled. Virtual damping
    is left out: it only brakes.

    Args:
        v: Now [m/s], shape [3].
        force: All virtual force [N], shape [3], same frame.
        hand: The person's [N], shape [3], same frame.
        mass: [kg].
        dt: Tick [s].
        out: Receives it [m/s], shape [3].
    """
    for i in range(3):
        out[i] = v[i] + 0.5 * dt * (force[i] + hand[i]) / mass


@kernel
def contact_scale(credit: float, force: Vec, v: Vec, dt: float, most: float) -> float:
    """Factor >= 0 on the contact's force, which adds a damper alpha along it; 1 while the credit lasts.

    Above 1 only on the way in with a debt: the damper then takes more than the contact does.

    Args:
        credit: Energy the contact may still give [J]; below 0 it owes.
        force: Of the contact on the user [N], shape [3].
        v: Velocity of what it acts on in the coming tick [m/s], shape [3], same frame.
        dt: Tick [s].
        most: Largest alpha [N s/m].
    """
    size = norm(force)
    lacking = _lacking(credit, force, v, dt)
    if not (lacking > 0.0 and size > 0.0):
        return 1.0
    along = (force[0] * v[0] + force[1] * v[1] + force[2] * v[2]) / size
    if along == 0.0:
        return 1.0
    alpha = min(most, lacking / (dt * along * along))
    return max(0.0, 1.0 - alpha * along / size)
