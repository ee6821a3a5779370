"""Laws of friction that the loop does not use, rivals of `kernels.friction`.

All take the clamped normal force F_N >= 0 and write the force ON the moving body [N] into `out`, shape [1] or [2]; all
vectors have out's shape and the same frame.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import FrictionRecord

__all__ = ["Bristles", "karnopp", "lugre_explicit", "lugre_implicit", "regularised", "sliding_speed"]


class Bristles(NamedTuple):
    """Numbers of the LuGre law.

    Attributes:
        mu: Coefficient while sliding fast.
        mu_static: Coefficient while hardly sliding.
        stribeck: Speed [m/s] > 0 of the change between the two.
        stiffness: s0 [N/m] of the bristles.
        damping: s1 [N s/m] of the bristles.
    """

    mu: float
    mu_static: float
    stribeck: float
    stiffness: float
    damping: float


@kernel
def sliding_speed(a: Vec) -> float:
    """Return the Euclidean length of a vector of one or two components."""
    total = 0.0
    for i in range(a.shape[0]):
        total += a[i] * a[i]
    return math.sqrt(total)


@kernel
def regularised(v: Vec, normal_force: float, mu: float, threshold: float, out: Vec) -> None:
    """Coulomb friction, linear below a threshold, 4.3.2 with the right sign: F = -mu F_N v / max(|v|, v_th).

    Below the threshold it is a damper of mu F_N / v_th, stable in a tick h on a mass m while h mu F_N < 2 m v_th (and
    without chatter while < 1).

    Args:
        v: Sliding velocity [m/s].
        normal_force: F_N [N] >= 0.
        mu: Coefficient of friction.
        threshold: v_th [m/s] > 0.
        out: Receives the force on the body [N].
    """
    gain = -mu * normal_force / max(sliding_speed(v), threshold)
    for i in range(out.shape[0]):
        out[i] = gain * v[i]


@kernel
def karnopp(
    v: Vec,
    load: Vec,
    normal_force: float,
    mu: float,
    mu_static: float,
    threshold: float,
    state: FrictionRecord,
    out: Vec,
) -> None:
    """Karnopp (1985): within +-threshold the body counts as at rest and the load is cancelled up to mu_static F_N.

    While `state.sticking` is set the caller sets the velocity to 0, as the model does. It needs the load, hence a
    device with a force sensor.

    Args:
        v: Sliding velocity [m/s].
        load: All other tangential forces on the body [N].
        normal_force: F_N [N] >= 0.
        mu: Coefficient while sliding.
        mu_static: Coefficient while at rest, >= mu.
        threshold: Half width of the stiction band [m/s].
        state: Record of `FRICTION`.
        out: Receives the force on the body [N].
    """
    speed = sliding_speed(v)
    pull = sliding_speed(load)
    state.sticking = speed <= threshold and pull <= mu_static * normal_force
    if state.sticking:
        for i in range(out.shape[0]):
            out[i] = -load[i]
    elif speed > threshold:
        for i in range(out.shape[0]):
            out[i] = -mu * normal_force * v[i] / speed
    else:
        for i in range(out.shape[0]):
            out[i] = -mu * normal_force * load[i] / pull


@kernel
def _stribeck(speed: float, normal_force: float, bristles: Bristles) -> float:
    """g(v) [N]: the friction of steady sliding, from mu_static F_N at rest down to mu F_N."""
    ratio = speed / bristles.stribeck
    return normal_force * (bristles.mu + (bristles.mu_static - bristles.mu) * math.exp(-ratio * ratio))


@kernel
def lugre_explicit(v: Vec, normal_force: float, bristles: Bristles, dt: float, state: FrictionRecord, out: Vec) -> None:
    """LuGre bristles (Canudas de Wit et al. 1995), z' = v - s0 |v| z / g(v), by explicit Euler.

    Stable only for dt < 2 g(v) / (s0 |v|): 20 us at s0 = 1e5 N/m, g = 1 N, v = 1 m/s.

    Args:
        v: Sliding velocity [m/s].
        normal_force: F_N [N] >= 0; 0 ends the contact.
        bristles: Numbers of the law.
        dt: Tick [s].
        state: Record of `FRICTION`.
        out: Receives the force on the body -(s0 z + s1 z') [N].
    """
    if normal_force <= 0.0:
        _no_bristles(state, out)
        return
    speed = sliding_speed(v)
    decay = bristles.stiffness * speed / _stribeck(speed, normal_force, bristles)
    for i in range(out.shape[0]):
        z_rate = v[i] - decay * state.bristle[i]
        state.bristle[i] += dt * z_rate
        out[i] = -(bristles.stiffness * state.bristle[i] + bristles.damping * z_rate)


@kernel
def lugre_implicit(v: Vec, normal_force: float, bristles: Bristles, dt: float, state: FrictionRecord, out: Vec) -> None:
    """LuGre bristles by implicit Euler in z: z = (z + dt v) / (1 + dt s0 |v| / g(v)), stable in any tick.

    Arguments and result as `lugre_explicit`.
    """
    if normal_force <= 0.0:
        _no_bristles(state, out)
        return
    speed = sliding_speed(v)
    decay = bristles.stiffness * speed / _stribeck(speed, normal_force, bristles)
    for i in range(out.shape[0]):
        before = state.bristle[i]
        after = (before + dt * v[i]) / (1.0 + dt * decay)
        state.bristle[i] = after
        out[i] = -(bristles.stiffness * after + bristles.damping * (after - before) / dt)


@kernel
def _no_bristles(state: FrictionRecord, out: Vec) -> None:
    """Relax the bristles, without force."""
    for i in range(out.shape[0]):
        state.bristle[i] = 0.0
        out[i] = 0.0
