"""Limits of forces and joint velocities, last stage before the device: outputs are finite for every input."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.kernel import kernel
from mimics_app.rendering.haptic.kernels.vectors import all_finite, copy, fill, norm, scale

__all__ = ["brake_at_limits", "limit_force", "limit_held", "limit_joints", "settle"]

Limits = NDArray[np.float64] | NDArray[np.float32]

_BRAKE_TIME = 0.05
"""Time constant with which a joint may approach its limit [s]: speed <= room / time."""

_SETTLE_TIME = 0.02
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
def limit_force(
    wanted: Vec, ramp: float, force_limit: float, rise_limit: float, v: Vec, power_limit: float, f: Vec
) -> bool:
    """Limit the magnitude of the wanted virtual force; its direction is kept.

    Args:
        wanted: Force requested by the virtual environment [N], shape [3], any frame.
        ramp: Soft-start factor, clipped to [0, 1].
        force_limit: Largest magnitude [N].
        rise_limit: Largest rise of the magnitude in this tick [N]; falling is free.
        v: Velocity of the user [m/s], shape [3], same frame.
        power_limit: Largest |f.v|, generated or absorbed [W].
        f: On entry the force of the last tick, on exit that of this one [N].

    Returns:
        False when an input is not usable (NaN, infinite, a negative limit); f is then zero.
    """
    last = norm(f)
    if not (
        all_finite(wanted)
        and math.isfinite(ramp)
        and math.isfinite(last)
        and _usable(force_limit)
        and _usable(rise_limit)
        and all_finite(v)
        and _usable(power_limit)
    ):
        fill(f, 0.0)
        return False
    largest = max(abs(wanted[0]), abs(wanted[1]), abs(wanted[2]))
    if largest == 0.0 or ramp <= 0.0:
        fill(f, 0.0)
        return True
    for i in range(3):
        f[i] = wanted[i] / largest
    share = norm(f)
    magnitude = min(min(1.0, ramp) * min(largest * share, force_limit), last + rise_limit)
    for i in range(3):
        f[i] /= share
    along = abs(f[0] * v[0] + f[1] * v[1] + f[2] * v[2])
    if magnitude * along > power_limit:
        magnitude = power_limit / along
    if magnitude < _SMALLEST_FORCE:
        magnitude = 0.0
    scale(f, magnitude)
    return True


@kernel
def limit_held(v: Vec, power_limit: float, f: Vec) -> float:
    """Scale a force held from an earlier tick [N] to |f.v| <= power_limit [W]; return the factor used, 0-1."""
    power = abs(f[0] * v[0] + f[1] * v[1] + f[2] * v[2])
    if power <= power_limit:
        return 1.0
    factor = power_limit / power if math.isfinite(power) and _usable(power_limit) else 0.0
    scale(f, factor)
    return factor


@kernel
def brake_at_limits(q: Vec, lowest: Vec, highest: Vec, dq: Vec) -> bool:
    """Slow joint velocities towards a joint limit, to zero at the limit; return whether any was slowed."""
    braked = False
    for i in range(dq.shape[0]):
        room_up = max(0.0, highest[i] - q[i]) / _BRAKE_TIME
        room_down = max(0.0, q[i] - lowest[i]) / _BRAKE_TIME
        if dq[i] > room_up:
            dq[i] = room_up
            braked = True
        elif dq[i] < -room_down:
            dq[i] = -room_down
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
def settle(command: Vec, dt: float) -> None:
    """Let the command decay for one tick, in the end to exactly zero: the motion of every stop state."""
    for i in range(command.shape[0]):
        command[i] /= 1.0 + dt / _SETTLE_TIME
        if not abs(command[i]) > _STANDSTILL:
            command[i] = 0.0
