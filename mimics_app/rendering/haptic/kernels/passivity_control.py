"""Passivity controller: a rendered contact returns no more energy than it took, from its begin to its end.

Its credit counts the exact work of held forces:

    impedance    a device that takes forces: the device itself, E -= F_{k-1}.(x_k - x_{k-1})
    admittance   a device that takes velocities: the virtual mass, which the force moves before the device follows

The force is bounded to that of a spring which stores the credit, F^2 <= 2 k E (`stored_share`; in the manner of Kim &
Ryu 2010): what is missing is spread over the way out. When the coming tick would still overdraw the credit, a damper
-E / (T v^2) along the contact's force (Hannaford & Ryu 2002) dissipates the difference (`contact_scale`).

Both take from the force and never add: the factor is within 0 and 1, so that the contact neither pulls nor pushes
harder than the virtual one. A debt could be paid by more force only, so none may arise: the tick is predicted with the
velocity at its midpoint (`middle_velocity`).

Hannaford and Ryu put a mobility -E / (T f^2) in series under admittance. It would act only after the lag of the servo,
and cannot be observed at the measured position: a wall far beyond its limit becomes unstable by the energy that the lag
feeds into the virtual mass, while it takes energy from the device that follows.
"""

from __future__ import annotations

import math

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.maths.vec import dot, norm

__all__ = ["contact_scale", "middle_velocity", "stored_share"]


@kernel
def stored_share(energy: float, spring: float, force: float, depth: float, step: float) -> float:
    """Share 0-1 of a contact's force with which it returns its energy with the slope of its spring, without a step.

    A spring of k stores F^2 / (2 k), so that F^2 <= 2 k E bounds the force. What the damper will take at the present
    speed need not be stored, nor what the force held over half a tick takes on the way in; on the way out it gives it.

    Args:
        energy: The contact may still give [J].
        spring: Force of its springs [N].
        force: Its whole virtual force, with the damper's [N].
        depth: Of the contact [m].
        step: Motion out of it in the coming tick [m].
    """
    pushed = min(spring, force)
    needed = depth * (pushed - 0.5 * spring) + 0.5 * pushed * step
    return math.sqrt(max(0.0, energy) / needed) if energy < needed else 1.0


@kernel
def middle_velocity(v: Vec, force: Vec, hand: Vec, mass: float, dt: float, out: Vec) -> None:
    """Set out to the velocity of a virtual mass at the midpoint of the coming tick: its work is then exact.

    The unscaled contact force is used, so that the contact is charged for the motion it accelerates. Virtual damping is
    left out: it only dissipates.

    Args:
        v: Present velocity [m/s], shape [3].
        force: Sum of the virtual forces [N], shape [3], same frame.
        hand: Force of the person's hand [N], shape [3], same frame.
        mass: Virtual mass [kg].
        dt: Tick [s].
        out: Receives the velocity [m/s], shape [3].
    """
    for i in range(3):
        out[i] = v[i] + 0.5 * dt * (force[i] + hand[i]) / mass


@kernel
def contact_scale(credit: float, force: Vec, v: Vec, dt: float, max_damping: float) -> float:
    """Factor 0-1 on the contact's force, which adds a damper alpha along it; 1 while the credit lasts, and moving in.

    Args:
        credit: Energy the contact may still give [J]; below 0: debt.
        force: Force of the contact on the user [N], shape [3].
        v: Velocity of virtual mass or device in the coming tick [m/s], shape [3], same frame.
        dt: Tick [s].
        max_damping: Largest alpha [N s/m].
    """
    size = norm(force)
    overdraft = dot(force, v) * dt - credit  # [J] in the coming tick
    if not (overdraft > 0.0 and size > 0.0):
        return 1.0
    along = dot(force, v) / size
    if along <= 0.0:
        return 1.0
    alpha = min(max_damping, overdraft / (dt * along * along))
    return max(0.0, 1.0 - alpha * along / size)
