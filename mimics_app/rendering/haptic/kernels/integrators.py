"""One step of m x'' + b x' + k x = f under a held force f: methods with one signature.

Each takes (x, v, f, m, b, k, dt) and returns (x, v) one step later. They differ in the amplification |lambda| of a free
oscillation (b = 0); with w = sqrt(k/m) and h the step it is

    explicit         sqrt(1 + (h w)^2)      always grows; with damping stable for h < b/k
    semi_implicit    1 for h w < 2          stable for h^2 k/m + 2 h b/m < 4
    midpoint         1                      any step; the phase lags
    exact            1                      the matrix exponential: any step, no error while f, m, b, k are constant

`step_free` is the exact step of (11), which has no spring.
"""

from __future__ import annotations

import math

from mimics_app.compiled.kernel import kernel

__all__ = [
    "free_responses",
    "step_exact",
    "step_explicit",
    "step_free",
    "step_midpoint",
    "step_semi_implicit",
]

_NEARLY_CRITICAL = 0.1
"""Square of the hyperbolic angle per step above which the two decay rates are computed separately [-]."""

_TERMS = 22
"""End of the Taylor series of a step: the last term is below rounding for arguments below 1."""


@kernel
def step_explicit(x: float, v: float, f: float, m: float, b: float, k: float, dt: float) -> tuple[float, float]:
    """Explicit Euler: position and velocity from the old state.

    Args:
        x: Position [m].
        v: Velocity [m/s].
        f: Force [N], held over the step.
        m: Mass [kg] > 0.
        b: Damping [N s/m].
        k: Stiffness [N/m].
        dt: Step [s].
    """
    return x + dt * v, v + dt * (f - b * v - k * x) / m


@kernel
def step_semi_implicit(x: float, v: float, f: float, m: float, b: float, k: float, dt: float) -> tuple[float, float]:
    """Semi-implicit (symplectic) Euler: velocity first, then the position with the new velocity. As `step_explicit`."""
    v += dt * (f - b * v - k * x) / m
    return x + dt * v, v


@kernel
def step_midpoint(x: float, v: float, f: float, m: float, b: float, k: float, dt: float) -> tuple[float, float]:
    """Implicit midpoint: acceleration of the mean of old and new state, in closed form. As `step_explicit`."""
    half = 0.5 * dt
    mean = (m * v + half * (f - k * x)) / (m + half * b + half * half * k)
    return x + dt * mean, 2.0 * mean - v


@kernel
def step_exact(x: float, v: float, f: float, m: float, b: float, k: float, dt: float) -> tuple[float, float]:
    """Exact step under a held force (zero-order hold): the matrix exponential in closed form. As `step_explicit`.

    With S the impulse response and P its integral, x = x0 + v0 S + (f - k x0)/m P, v = v0 S' + (f - k x0)/m S: without
    a division by k, a missing spring or damper is no special case.
    """
    p, s, s_rate = _responses(b / m * dt, k / m * dt * dt)
    pull = (f - k * x) / m
    return x + dt * (v * s + dt * pull * p), v * s_rate + dt * pull * s


@kernel
def _responses(damping: float, stiffness: float) -> tuple[float, float, float]:
    """(P/h^2, S/h, S') of y'' + (damping/h) y' + (stiffness/h^2) y = 0 at h, S the solution with S(0)=0, S'(0)=1."""
    a = 0.5 * damping
    square = stiffness - a * a
    if abs(damping) < 1.0 and abs(stiffness) < 1.0:
        return _responses_by_series(damping, stiffness)
    if square < -_NEARLY_CRITICAL:
        fast = a + math.sqrt(-square)
        slow = stiffness / fast  # not a - sqrt(...): that difference cancels for a weak spring
        gap = fast - slow
        lag = -math.expm1(-slow) / slow if slow != 0.0 else 1.0
        p = (lag + math.expm1(-fast) / fast) / gap
        s = (math.exp(-slow) - math.exp(-fast)) / gap
        return p, s, (fast * math.exp(-fast) - slow * math.exp(-slow)) / gap
    decay = math.exp(-a)
    if square > 0.0:
        angle = math.sqrt(square)
        cosine, sinc = math.cos(angle), math.sin(angle) / angle
    else:
        angle = math.sqrt(-square)
        cosine, sinc = math.cosh(angle), math.sinh(angle) / angle if angle > 0.0 else 1.0
    s = decay * sinc
    s_rate = decay * (cosine - a * sinc)
    return (1.0 - s_rate - damping * s) / stiffness, s, s_rate


@kernel
def _responses_by_series(damping: float, stiffness: float) -> tuple[float, float, float]:
    """`_responses` by their Taylor series, for arguments below 1; the omitted terms are below rounding."""
    before, now = 0.0, 1.0
    p = s = s_rate = 0.0
    weight = 1.0  # 1 / (n - 2)!
    for n in range(2, _TERMS):
        s_rate += now * weight
        s += now * weight / (n - 1)
        p += now * weight / (n * (n - 1))
        before, now = now, -damping * now - stiffness * before
        weight /= n - 1
    return p, s, s_rate


@kernel
def free_responses(m: float, b: float, dt: float) -> tuple[float, float, float]:
    """(p, s, a) of (11): x+ = x + dt (s v + p dt f/m), v+ = a v + s dt f/m, exact under a held force.

    Args:
        m: Mass [kg] > 0.
        b: Damping [N s/m] >= 0; without it (1/2, 1, 1).
        dt: Step [s].
    """
    if b == 0.0:
        return 0.5, 1.0, 1.0
    return _responses(b / m * dt, 0.0)


@kernel
def step_free(x: float, v: float, f: float, m: float, b: float, dt: float) -> tuple[float, float]:
    """Exact step of (11), m x'' = f - b x', under a held force; m = inf is a fixed body.

    The velocity approaches f/b as exp(-b t/m), and is linear in time for b = 0. F_virt of (11) is the force on the
    OBJECT: minus the force on the user.
    """
    return step_exact(x, v, f, m, b, 0.0, dt)
