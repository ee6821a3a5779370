"""A device in a sampled contact with velocity filter, delay and arm, simulated and exact, for S17.

Each tick the device moves under the force, or follows the velocity, that leaves the delay line; the hand pulls at it
through its grip; position and filtered velocity are sampled; the contact's law gives the next force.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Mat, Vec
from mimics_app.lab.stability.growth import dies_away, note_peak
from mimics_app.lab.stability.linear import find_limit, hold, spectral_radius
from mimics_app.lab.stability.wall_loop import APART, DEPTH, LARGE, LONGEST, PRECISION, SHORTEST
from mimics_app.rendering.haptic.kernels.contact_law import spring_damper
from mimics_app.rendering.haptic.kernels.integrators import step_free

__all__ = ["LIMP", "Hand", "Loop", "exact_limit", "exact_matrix", "is_stable", "simulated_limit"]

_GRIP_STIFFNESS, _GRIP_DAMPING = 4000.0, 50.0
"""Grip of the simulated person [N/m], [N s/m]."""

_SLOW = 1e-10
"""Distance of a spectral radius from 1 within rounding."""

_STATES = 7
"""Position, velocity, last position, filtered speed, virtual speed, and place and speed of the hand."""


@dataclass(frozen=True, slots=True)
class Hand:
    """Arm of a person at the handle: mass [kg], damping [N s/m], stiffness [N/m]; without mass there is none."""

    mass: float = 0.0
    damping: float = 0.0
    stiffness: float = 0.0


LIMP = Hand()
"""No hand at the device."""


@dataclass(frozen=True, slots=True)
class Loop:
    """A loop without its contact.

    Attributes:
        mass: Mass of a device that takes forces, or virtual mass [kg].
        damping: Damping of that mass [N s/m].
        driven: Whether the device takes velocities.
        rate: Ticks per second [Hz].
        delay: Ticks between sampling and acting.
        filtering: Time constant of the velocity filter [s]; 0: none.
        lag: Lag of the velocity servo [s] > 0, of a device that takes velocities.
        hand: Hand at the handle.
    """

    mass: float
    damping: float
    driven: bool = False
    rate: float = 1000.0
    delay: int = 1
    filtering: float = 0.0
    lag: float = 2.65e-3
    hand: Hand = LIMP

    @property
    def filter_share(self) -> float:
        """Share of the difference that the filter takes in a tick."""
        return 1.0 - math.exp(-1.0 / (self.rate * self.filtering)) if self.filtering > 0.0 else 1.0

    @property
    def servo_share(self) -> float:
        """Share of the wanted velocity that the servo reaches in a tick."""
        return 1.0 - math.exp(-1.0 / (self.rate * self.lag))


@kernel
def _press(k: float, B: float, loop: Vec, delay: int, ticks: int, line: Vec, peaks: Vec) -> None:
    """Simulate the loop, released at a distance from rest.

    Args:
        k: Stiffness of the contact [N/m].
        B: Its damping [N s/m].
        loop: Mass, damping, driven, period, shares of filter and servo, mass, damping, stiffness of the hand.
        delay: Ticks between sampling and acting.
        ticks: Length of the run [ticks].
        line: Delay line, zeros, shape [delay + 1].
        peaks: Receives the peaks of the distance from rest by quarter of the run [m], shape [4], see `note_peak`.
    """
    m, b, driven, dt, filters, follows = loop[0], loop[1], loop[2], loop[3], loop[4], loop[5]
    peaks[:] = 0.0
    x, v, speed, virtual, hand, hand_v, pull = APART, 0.0, 0.0, 0.0, APART, 0.0, 0.0
    last = x
    for i in range(ticks):
        acts = line[i % (delay + 1)]
        if driven > 0.0:
            near = v + (acts - v) * follows
            x += 0.5 * dt * (v + near)
            v = near
        else:
            x, v = step_free(x, v, acts + pull, m, b, dt)
        if loop[6] > 0.0:
            pull = _GRIP_STIFFNESS * (hand - x) + _GRIP_DAMPING * (hand_v - v)
            hand_v += dt * (-loop[8] * hand - loop[7] * hand_v - pull) / loop[6]
            hand += dt * hand_v
        speed += filters * ((x - last) / dt - speed)
        last = x
        force = k * DEPTH - spring_damper(DEPTH + x, speed, k, B)
        if driven > 0.0:
            virtual += dt / m * (force + pull - b * virtual)
            force = virtual
        line[(i + delay + 1) % (delay + 1)] = force
        if note_peak(abs(x), i, ticks, LARGE, peaks):
            return


def _numbers(loop: Loop) -> Vec:
    hand = loop.hand
    return np.array(
        [loop.mass, loop.damping, float(loop.driven), 1.0 / loop.rate, loop.filter_share, loop.servo_share]
        + [hand.mass, hand.damping, hand.stiffness]
    )


def simulated_limit(loop: Loop, damping: float, soft: float, hard: float) -> float:
    """Return the largest stable stiffness at a damping by simulation [N/m], between a stable and an unstable one."""
    numbers = _numbers(loop)

    def dies(stiffness: float) -> bool:
        def run(ticks: int) -> Vec:
            peaks = np.zeros(4)
            _press(stiffness, damping, numbers, loop.delay, ticks, np.zeros(loop.delay + 1), peaks)
            return peaks

        return dies_away(run, SHORTEST, LONGEST)

    return find_limit(dies, soft, hard, PRECISION)


@cache
def _free(mass: float, damping: float, T: float) -> tuple[Mat, Mat]:
    """Return one tick of a mass with friction under a held force."""
    return hold(np.array([[0.0, 1.0], [0.0, -damping / mass]]), np.array([[0.0], [1.0 / mass]]), T)


def _move(loop: Loop, x: float, v: float, acts: float, pull: float) -> tuple[float, float]:
    """Return position and velocity of the device after a tick."""
    T = 1.0 / loop.rate
    if loop.driven:
        near = v + (acts - v) * loop.servo_share
        return x + 0.5 * T * (v + near), near
    A, held = _free(loop.mass, loop.damping, T)
    moved = A @ np.array([x, v]) + held[:, 0] * (acts + pull)
    return float(moved[0]), float(moved[1])


def _next(loop: Loop, K: float, B: float, state: Vec) -> Vec:
    """Return the state after a tick: see _STATES, the pull of the hand, and the commands under way, newest first."""
    x, v, last, speed, virtual, hand, hand_v, pull = state[: _STATES + 1]
    T, line = 1.0 / loop.rate, list(state[_STATES + 1 :])
    x, v = _move(loop, x, v, line[loop.delay], pull)
    pull = 0.0
    if loop.hand.mass > 0.0:
        arm = loop.hand
        pull = _GRIP_STIFFNESS * (hand - x) + _GRIP_DAMPING * (hand_v - v)
        hand_v += T * (-arm.stiffness * hand - arm.damping * hand_v - pull) / arm.mass
        hand += T * hand_v
    speed += loop.filter_share * ((x - last) / T - speed)
    force = -K * x - B * speed
    virtual = virtual + T / loop.mass * (force + pull - loop.damping * virtual) if loop.driven else 0.0
    without = (hand, hand_v) if loop.hand.mass > 0.0 else (0.0, 0.0)
    return np.array([x, v, x, speed, virtual, *without, pull, virtual if loop.driven else force, *line[:-1]])


def exact_matrix(loop: Loop, stiffness: float, damping: float) -> Mat:
    """Return one tick of the loop in a contact as a matrix, shape [9 + delay, 9 + delay]."""
    size = _STATES + 2 + loop.delay
    return np.array([_next(loop, stiffness, damping, unit) for unit in np.eye(size)]).T


def is_stable(loop: Loop, stiffness: float, damping: float) -> bool:
    """Whether a contact is stable by eigenvalues."""
    return spectral_radius(exact_matrix(loop, stiffness, damping)) < 1.0 - _SLOW


def exact_limit(loop: Loop, damping: float, soft: float, hard: float) -> float:
    """Return the largest stable stiffness at a damping by eigenvalues [N/m], between a stable and an unstable one."""
    return find_limit(lambda stiffness: is_stable(loop, stiffness, damping), soft, hard)
