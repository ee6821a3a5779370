"""Laws of a compliant contact: normal force from depth and its rate (D2.1 equations 9, 17 and 4.3.2).

All share one sign convention and one clamp: depth d > 0 inside, rate d' > 0 going in, the force f pushes along the
outward normal n of the touched object: F_user = f n, F_object = -f n.

The printed equations and their corrections:

- (9) `F' = (k d + b (v_O - v_HIP).n) n` is called the force on the object. With n outward and d > 0 it is the force on
  the user; as the force on the object its damper would generate pi b w A^2 per cycle instead of dissipating it. It also
  has no clamp, so that it pulls on the way out.
- (13, 15, 16) print depths that are negative inside: see `contact`.
- (17) `F1' = -(k_s d - b_s v_d.n) n` has the same fault: whichever way n points, its damper adds b_s (v_d.n)^2.
- (17) puts stiffnesses in series but adds dampings: two equal bodies would be damped four times too much.
- 4.3.2 prints `k dx + c dx * b dx'`: the product of depth and rate is Hunt and Crossley's damper with lam = c b.
"""

from __future__ import annotations

from mimics_app.compiled.kernel import kernel

__all__ = [
    "hunt_crossley",
    "pair_damping",
    "pair_force",
    "pair_stiffness",
    "spring_damper",
]


@kernel
def spring_damper(depth: float, rate: float, k: float, b: float) -> float:
    """Normal force [N] of (9), corrected: max(0, k d + b d') inside, 0 outside.

    Args:
        depth: Penetration d [m], positive inside.
        rate: d' [m/s], positive going in, from velocities and never from differenced depths.
        k: Stiffness [N/m].
        b: Damping [N s/m].
    """
    if depth <= 0.0:
        return 0.0
    return max(0.0, k * depth + b * rate)


@kernel
def hunt_crossley(depth: float, rate: float, k: float, lam: float, exponent: float) -> float:
    """Normal force [N] max(0, k d^n + lam d^n d') of Hunt & Crossley (1975); 4.3.2 is the case n = 1, lam = c b.

    Continuous at the surface: no step at first touch, and no pull in a free rebound.

    Args:
        depth: Penetration d [m], positive inside.
        rate: d' [m/s], positive going in.
        k: Stiffness [N/m^n].
        lam: Damping [N s/m^(n+1)].
        exponent: n, 1 for a flat punch, 1.5 for a Hertzian sphere.
    """
    if depth <= 0.0:
        return 0.0
    return max(0.0, (k + lam * rate) * depth**exponent)


@kernel
def pair_stiffness(k1: float, k2: float) -> float:
    """Stiffness [N/m] of two springs in series, (17): (1/k1 + 1/k2)^-1; with a rigid one (inf) that of the other."""
    return 1.0 / (1.0 / k1 + 1.0 / k2)


@kernel
def pair_damping(k1: float, b1: float, k2: float, b2: float) -> float:
    """Damping [N s/m] of two spring-dampers in series at low frequency: k_s^2 (b1/k1^2 + b2/k2^2).

    Exact, and equal to (1/b1 + 1/b2)^-1, where b1/k1 = b2/k2; otherwise the series is frequency dependent (3000 N/m
    with 12 N s/m on 1500 N/m with 1 N s/m: 1.78 N s/m falling to 0.92). With a rigid partner it is that of the other.
    (17) prints b1 + b2.
    """
    k = 1.0 / (1.0 / k1 + 1.0 / k2)
    share1 = k / k1
    share2 = k / k2
    return share1 * share1 * b1 + share2 * share2 * b2


@kernel
def pair_force(depth: float, approach: float, k: float, b: float) -> float:
    """Normal force [N] between two bodies, (17) corrected: max(0, k_s d + b_s v_d.n) with n from body 1 to body 2.

    F1 = -f n and F2 = +f n at one contact point, so that momentum is kept to the last digit.

    Args:
        depth: d = r1 + r2 - distance [m].
        approach: v_d.n = (v1 - v2).n [m/s] at the contact point, positive while approaching.
        k: `pair_stiffness` [N/m].
        b: `pair_damping` [N s/m].
    """
    return spring_damper(depth, approach, k, b)
