"""What is done to a contact law to find it out: a bounce, a cycle of a sine inside the contact, a bounce of a pair."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from mimics_app.rendering.haptic.kernels.contact import pair_spheres
from mimics_app.rendering.haptic.kernels.contact_law import pair_force
from mimics_app.rendering.haptic.kernels.contact_records import CONTACT
from mimics_app.rendering.haptic.kernels.integrators import step_semi_implicit
from mimics_app.rendering.haptic.kernels.passivity import OBSERVER, observe

Law = Callable[[float, float], float]
"""Normal force [N] from depth [m] and rate of depth [m/s]."""


@dataclass(frozen=True)
class Bounce:
    """Restitution, contact time [s] and greatest depth [m]."""

    restitution: float
    time: float
    depth: float


def bounce(law: Law, mass: float, speed: float, dt: float, phase: float = 0.0, most: int = 1_000_000) -> Bounce:
    """A free mass flies into a fixed contact; `phase` 0..1 is where between two ticks it meets the surface."""
    depth, rate, deepest, ticks = -phase * speed * dt, speed, 0.0, 0
    for _ in range(most):
        depth, rate = step_semi_implicit(depth, rate, -law(depth, rate), mass, 0.0, 0.0, dt)
        deepest = max(deepest, depth)
        ticks += depth > 0.0
        if deepest > 0.0 and depth <= 0.0:
            break
    return Bounce(-rate / speed, ticks * dt, deepest)


def angle_factor(zeta: float) -> float:
    """The a of equations (9): arccos(zeta)/sqrt(1 - zeta^2), arccosh beyond 1, and their common limit 1."""
    if zeta == 1.0:
        return 1.0
    turned = math.acos(zeta) if zeta < 1.0 else math.acosh(zeta)
    return turned / math.sqrt(abs(1.0 - zeta * zeta))


def energy_of_cycle(law: Law, frequency: float, amplitude: float, dt: float, depth: float) -> float:
    """Energy [J] taken from a user who moves as a sine about `depth` for one cycle; each tick holds its force."""
    observer = np.zeros(1, OBSERVER)[0]
    w = 2.0 * math.pi * frequency
    ticks = round(1.0 / (frequency * dt))
    energy = 0.0
    for tick in range(ticks + 1):
        d = depth + amplitude * math.sin(w * tick * dt)
        rate = amplitude * w * math.cos(w * tick * dt)
        # Outward is +x: going in is moving towards -x, and the force on the user points to +x.
        energy = observe(observer, np.array([-d, 0.0, 0.0]), np.array([law(d, rate), 0.0, 0.0]))
    return energy


@dataclass(frozen=True)
class PairBounce:
    """Velocities after the bounce [m/s, shape 3], contact time [s], and the extremes of what should be kept."""

    v1: np.ndarray
    v2: np.ndarray
    time: float
    depth: float
    energy: np.ndarray
    momentum: np.ndarray
    spin: np.ndarray


@dataclass(frozen=True)
class Pair:
    """Two spheres: masses [kg], radii [m], contact stiffness [N/m] and damping [N s/m]."""

    m1: float = 0.3
    m2: float = 0.7
    r1: float = 0.03
    r2: float = 0.05
    k: float = 2000.0
    b: float = 0.0

    @property
    def reduced(self) -> float:
        """Reduced mass [kg]."""
        return self.m1 * self.m2 / (self.m1 + self.m2)

    @property
    def zeta(self) -> float:
        """Damping ratio of the contact."""
        return self.b / (2.0 * math.sqrt(self.k * self.reduced))


def bounce_pair(pair: Pair, v1, v2, normal, dt: float, law=pair_force, most: int = 200_000) -> PairBounce:
    """Two spheres that touch at the start, body 2 in direction `normal` of body 1, until they part."""
    normal = np.asarray(normal, float) / np.linalg.norm(normal)
    v1, v2 = np.array(v1, float), np.array(v2, float)
    p1, p2 = np.array([0.1, -0.2, 0.3]), np.array([0.1, -0.2, 0.3]) + (pair.r1 + pair.r2) * normal
    contact, force = np.zeros(1, CONTACT)[0], np.zeros(3)
    touched, deepest, ticks, energies, momenta, spins = False, 0.0, 0, [], [], []
    for _ in range(most):
        touching = pair_spheres(p1, v1, pair.r1, p2, v2, pair.r2, pair.k, pair.b, contact, force)
        if law is not pair_force:
            n = contact["normal"]
            force[:] = law(float(contact["depth"]), float((v1 - v2) @ n), pair.k, pair.b) * n
        if touched and not touching:
            break
        touched = touched or touching
        ticks += touching
        deepest = max(deepest, float(contact["depth"]))
        v1 -= force * (dt / pair.m1)
        v2 += force * (dt / pair.m2)
        p1 += v1 * dt
        p2 += v2 * dt
        energies.append(0.5 * pair.m1 * v1 @ v1 + 0.5 * pair.m2 * v2 @ v2 + 0.5 * pair.k * float(contact["depth"]) ** 2)
        momenta.append(pair.m1 * v1 + pair.m2 * v2)
        spins.append(pair.m1 * np.cross(p1, v1) + pair.m2 * np.cross(p2, v2))
    return PairBounce(v1, v2, ticks * dt, deepest, np.array(energies), np.array(momenta), np.array(spins))
