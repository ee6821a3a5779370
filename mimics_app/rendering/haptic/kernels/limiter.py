"""Limits of forces and joint velocities, last stage before the device: outputs are finite for every input."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.maths.vec import all_finite, copy, dot, fill, scale

__all__ = ["brake_at_limits", "decay", "lever_of", "limit_force", "limit_held", "limit_joints", "limit_torques"]

Limits = NDArray[np.float64] | NDArray[np.float32]

_BRAKE_TIME = 0.05
"""Time constant with which a joint may approach its limit [s]: speed <= room / time."""

_SETTLING_TIME = 0.02
"""Time constant of the decay of a command in a stop state [s]."""

_SMALLEST_FORCE = 1e-290
"""Magnitude below which a force becomes zero [N]: denormal components would change its direction."""

_STANDSTILL = 1e-6
"""Velocity below which a decaying command becomes zero [m/s, rad/s]."""

_ROUNDING = 1e-12
"""Relative change up to which a limited command counts as unchanged [-]."""


@kernel
def _usable(limit: float) -> bool:
    """Whether a limit is finite and not negative."""
    return math.isfinite(limit) and limit >= 0.0


@kernel
def limit_held(v: Vec, power_limit: float, f: Vec) -> float:
    """Scale a force [N] to |f.v| <= power_limit [W]; return the factor used, 0-1."""
    total = 1.0
    for _ in range(2):  # the first factor may be too small for all its digits
        power = abs(dot(f, v))
        if power <= power_limit:
            break
        factor = power_limit / power if math.isfinite(power) and _usable(power_limit) else 0.0
        scale(f, factor)
        total *= factor
    return total


@kernel
def _largest(a: Vec) -> float:
    """Largest magnitude of the components of a."""
    return max(abs(a[0]), abs(a[1]), abs(a[2]))


@kernel
def _approach(wanted: Vec, largest: float, reach: float, rise_limit: float, f: Vec, shares: Vec) -> None:
    """Move f [N] towards the target (wanted / largest) reach, at most `rise_limit` [N] from where a fall alone leads.

    A fall leads to the point nearest to the target between zero and f. `largest` is that of wanted's components.
    """
    whole = max(reach, _largest(f))
    if not whole > 0.0:
        return
    along, square = 0.0, 0.0
    for i in range(3):
        along += (f[i] / whole) * (wanted[i] / largest * (reach / whole))
        square += (f[i] / whole) ** 2
    kept = min(1.0, max(0.0, along / square)) if square > 0.0 else 0.0
    gap = 0.0  # over `whole`
    for i in range(3):
        gap += (wanted[i] / largest * (reach / whole) - kept * (f[i] / whole)) ** 2
    gap = math.sqrt(gap)
    limited = whole * gap > rise_limit
    shares[1] = rise_limit / (whole * gap) if limited else 1.0
    shares[0] = kept * (1.0 - shares[1])
    for i in range(3):
        way = (wanted[i] / largest * (reach / whole) - kept * (f[i] / whole)) / gap if limited else 0.0
        f[i] = kept * f[i] + rise_limit * way if limited else wanted[i] / largest * reach


@kernel
def limit_force(
    wanted: Vec, ramp: float, force_limit: float, rise_limit: float, v: Vec, power_limit: float, f: Vec, shares: Vec
) -> bool:
    """Limit magnitude, change and power of a force.

    The change is that of the vector, not of its length: f stays within `rise_limit` of the segment from zero to the
    force of the last tick. A fall towards zero is free; a turn and a reversal are not.

    Args:
        wanted: Force requested [N], shape [3], any frame.
        ramp: Soft-start factor, clipped to [0, 1].
        force_limit: Largest magnitude [N].
        rise_limit: Largest change in this tick [N]; falling is free.
        v: Velocity of the user [m/s], shape [3], same frame.
        power_limit: Largest |f.v|, generated or absorbed [W].
        f: On entry the force of the last tick, on exit that of this one [N].
        shares: Out: f is shares[0] times the force of the last tick plus shares[1] times the wanted one.

    Returns:
        False when an input is not usable (NaN, infinite, a negative limit); f is then zero.
    """
    shares[0], shares[1] = 0.0, 0.0
    if not (
        all_finite(wanted)
        and math.isfinite(ramp)
        and all_finite(f)
        and _usable(force_limit)
        and _usable(rise_limit)
        and all_finite(v)
        and _usable(power_limit)
    ):
        fill(f, 0.0)
        return False
    largest = _largest(wanted)
    if largest == 0.0 or ramp <= 0.0:
        fill(f, 0.0)
        return True
    length = 0.0
    for i in range(3):
        length += (wanted[i] / largest) ** 2
    length = math.sqrt(length)  # of wanted / largest, 1 to 1.8
    reach = min(min(1.0, ramp) * largest, force_limit / length)
    _approach(wanted, largest, reach, rise_limit, f, shares)
    shares[1] *= reach / largest
    factor = limit_held(v, power_limit, f)
    shares[0] *= factor
    shares[1] *= factor
    if not _largest(f) > _SMALLEST_FORCE:
        fill(f, 0.0)
        shares[0], shares[1] = 0.0, 0.0
    return True


@kernel
def lever_of(jacobian: Vec, rows: int, joints: int, joint: int) -> float:
    """Lever arm of a joint to the points of contact, their way per its motion [m; 1 for a joint that shifts them]."""
    square = 0.0
    for row in range(rows):
        square += jacobian[row * joints + joint] ** 2
    return math.sqrt(square)


@kernel
def limit_torques(wanted: Vec, jacobian: Vec, rows: int, force_limit: float, rise_limit: float, tau: Vec) -> None:
    """Limit the torques of a drive by the forces they make at the points of contact, each over its joint's lever arm.

    Args:
        wanted: Torques requested [N, N m], shape [joints].
        jacobian: Jacobian of all points, row by row.
        rows: Number of its rows.
        force_limit: Largest root of the sum of their squares [N].
        rise_limit: Largest change of each in this tick [N]; falling towards zero is free.
        tau: On entry the torques of the last tick, on exit those of this one, shape [joints].
    """
    joints, square = tau.shape[0], 0.0
    for j in range(joints):
        lever = lever_of(jacobian, rows, joints, j)
        free = min(max(wanted[j], min(0.0, tau[j])), max(0.0, tau[j]))  # what a fall alone reaches
        rise = rise_limit * lever
        tau[j] = free + min(rise, max(-rise, wanted[j] - free))
        square += (tau[j] / lever) ** 2 if lever > 0.0 else 0.0
    if square > force_limit * force_limit:
        scale(tau, force_limit / math.sqrt(square))


@kernel
def brake_at_limits(q: Vec, lowest: Vec, highest: Vec, dq: Vec) -> bool:
    """Slow joint velocities towards a joint limit, to zero at the limit; return whether any was slowed."""
    braked = False
    for i in range(dq.shape[0]):
        room = highest[i] - q[i] if dq[i] > 0.0 else q[i] - lowest[i]
        fastest = max(0.0, room) / _BRAKE_TIME
        if dq[i] > fastest:
            dq[i] = fastest
            braked = True
        elif dq[i] < -fastest:
            dq[i] = -fastest
            braked = True
    return braked


@kernel
def _joint_share(change: Vec, limits: Limits, factor: float) -> float:
    """Largest share 0-1 of a change of the joints within every joint's limit times `factor`."""
    share = 1.0
    for i in range(change.shape[0]):
        limit = limits[i] * factor
        if abs(change[i]) > limit:
            share = min(share, limit / abs(change[i]))
    return share


@kernel
def limit_joints(last: Vec, velocity: Limits, acceleration: Limits, each: bool, dt: float, step: Vec, dq: Vec) -> bool:
    """Limit joint velocities, and their change since the last tick, to the limits of every joint.

    Args:
        last: Joint velocities commanded in the last tick.
        velocity: Largest velocity per joint [m/s, rad/s].
        acceleration: Largest acceleration per joint [m/s^2, rad/s^2].
        each: True: every joint is clamped separately, as by the mask of D2.1 4.2.7, which changes the direction; False:
            all are scaled by one factor, which keeps it.
        dt: Tick [s].
        step: Scratch, as long as dq.
        dq: Joint velocities, updated.

    Returns:
        Whether anything was limited.
    """
    before = 0.0
    after = 0.0
    size = dq.shape[0]
    for i in range(size):
        before += abs(dq[i])
        step[i] = dq[i]
    share = _joint_share(step, velocity, 1.0)
    for i in range(size):
        wish = min(velocity[i], max(-velocity[i], dq[i])) if each else share * dq[i]
        step[i] = wish - last[i]
    near = _joint_share(step, acceleration, dt)
    for i in range(size):
        limit = acceleration[i] * dt
        change = min(limit, max(-limit, step[i])) if each else near * step[i]
        limited = last[i] + change
        after += abs(limited - dq[i])
        step[i] = limited
    if not after > _ROUNDING * before:
        return False
    copy(step, dq)
    return True


@kernel
def decay(command: Vec, dt: float) -> None:
    """Let the command decay for one tick, in the end to exactly zero: the motion of every stop state."""
    for i in range(command.shape[0]):
        command[i] /= 1.0 + dt / _SETTLING_TIME
        if not abs(command[i]) > _STANDSTILL:
            command[i] = 0.0
