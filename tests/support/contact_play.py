"""What is done to a contact law to find it out: a bounce, a cycle of a sine inside the contact, a bounce of a pair."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from mimics_app.rendering.haptic.kernels.integrators import step_semi_implicit
from mimics_app.rendering.haptic.kernels.passivity import OBSERVER, observe
from tests.support.body_play import new_play

Law = Callable[[float, float], float]
"""Normal force [N] from depth [m] and rate of depth [m/s]."""

PairLaw = Callable[[float, float, float, float], float]
"""Likewise, with stiffness [N/m] and damping [N s/m]."""


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
    def masses(self) -> np.ndarray:
        """Of both [kg], shape [2]."""
        return np.array([self.m1, self.m2])

    @property
    def reduced(self) -> float:
        """Reduced mass [kg]."""
        return self.m1 * self.m2 / (self.m1 + self.m2)

    @property
    def zeta(self) -> float:
        """Damping ratio of the contact."""
        return self.b / (2.0 * math.sqrt(self.k * self.reduced))


class _InTheLoop:
    """The two balls as the loop collides them."""

    def __init__(self, pair: Pair, places: np.ndarray, velocities: np.ndarray, dt: float) -> None:
        self.play = new_play(dt=dt)
        surface = {"stiffness": 2.0 * pair.k, "damping": 2.0 * pair.b}  # two of them in series: k and b
        for radius, mass, place, velocity in zip((pair.r1, pair.r2), pair.masses, places, velocities, strict=True):
            self.play.add_ball(radius, mass, surface, position=place, velocity=velocity)

    def step(self) -> tuple[np.ndarray, np.ndarray, bool]:
        """One tick: places [m], velocities [m/s], and whether they touch."""
        self.play.run(1)
        motions = self.play.motions[:2]
        return motions["centre"].copy(), motions["velocity"].copy(), bool(self.play.work.pairs[0]["touching"])


class _ByLaw:
    """The two balls with a law of their own: force [N] from depth, rate of depth, k and b."""

    def __init__(self, pair: Pair, places: np.ndarray, velocities: np.ndarray, dt: float, law: PairLaw) -> None:
        self.pair, self.dt, self.law = pair, dt, law
        self.p, self.v = places.copy(), velocities.copy()

    def step(self) -> tuple[np.ndarray, np.ndarray, bool]:
        way = self.p[1] - self.p[0]
        depth, n = self.pair.r1 + self.pair.r2 - np.linalg.norm(way), way / np.linalg.norm(way)
        touching = bool(depth > 0.0)
        rate = float((self.v[0] - self.v[1]) @ n)
        force = self.law(float(depth), rate, self.pair.k, self.pair.b) if touching else 0.0
        self.v += np.outer([-1.0, 1.0], force * n) * self.dt / self.pair.masses[:, None]
        self.p += self.v * self.dt
        return self.p.copy(), self.v.copy(), touching


def bounce_pair(pair: Pair, v1, v2, normal, dt: float, law: PairLaw | None = None, most: int = 200_000) -> PairBounce:
    """Two spheres that touch at the start, body 2 in direction `normal` of body 1, until they part.

    By the kernels of the loop, or by another law.
    """
    normal = np.asarray(normal, float) / np.linalg.norm(normal)
    p = np.array([0.1, -0.2, 0.3]) + np.outer([0.0, pair.r1 + pair.r2], normal)
    v, m = np.array([v1, v2], float), pair.masses
    balls = _InTheLoop(pair, p, v, dt) if law is None else _ByLaw(pair, p, v, dt, law)
    touched, deepest, ticks, energies, momenta, spins = False, 0.0, 0, [], [], []
    for _ in range(most):
        depth = max(0.0, pair.r1 + pair.r2 - float(np.linalg.norm(p[1] - p[0])))
        after, faster, touching = balls.step()
        if touched and not touching:
            break
        p, v = after, faster
        touched = touched or touching
        ticks += touching
        deepest = max(deepest, depth)
        energies.append(0.5 * m @ (v * v).sum(axis=1) + 0.5 * pair.k * depth**2)
        momenta.append(m @ v)
        spins.append((m[:, None] * np.cross(p, v)).sum(axis=0))
    return PairBounce(v[0], v[1], ticks * dt, deepest, np.array(energies), np.array(momenta), np.array(spins))
