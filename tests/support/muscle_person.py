"""A person of another structure than the presets: antagonist muscles with first-order activation at hip and knee.

Each joint has a flexor and an extensor. Activation a follows the nerve u in first order, with time constants of its
own for rising and falling; the force is a F f_l(l) f_v(v) with a parabola of the length and Hill's hyperbola of the
speed; the moment arm is constant. What it knows of the product is the angle of a joint and its speed.
"""

from __future__ import annotations

import numpy as np

from mimics_app.compiled.kernel import kernel

__all__ = ["ACTIVATIONS", "PRESSING", "RELAXED", "muscle_torques"]

ACTIVATIONS = 4
"""Muscles: hip flexor, hip extensor, knee flexor, knee extensor."""

RELAXED = np.zeros(ACTIVATIONS)
PRESSING = np.array([0.3, 0.0, 0.0, 0.35])
"""Nerves of a person who pushes the foot forward."""

RISE, FALL = 0.015, 0.050
"""Time constants of activation [s]."""

STRONGEST = np.array([2400.0, 3600.0, 2800.0, 4200.0])
ARM = np.array([0.045, 0.060, 0.035, 0.042])
LONGEST, FASTEST, HILL = 0.9, 9.0, 0.25
"""Half width of the force-length parabola [rad], greatest speed of shortening [rad/s], Hill's a/F."""

OPTIMUM = np.array([0.3, 0.3, 0.9, 0.9])
"""Angles at which the muscles are strongest [rad]."""


@kernel
def muscle_torques(activation, nerve, q, dq, dt, tau):
    """Set the torques of hip and knee [N m], shape [2], and advance the activation, shape [4], by a tick of dt [s]."""
    for joint in range(2):
        tau[joint] = 0.0
        for side in range(2):
            k = 2 * joint + side
            lag = RISE if nerve[k] > activation[k] else FALL
            activation[k] += dt / lag * (nerve[k] - activation[k])
            shorten = dq[joint] if side == 0 else -dq[joint]
            length = max(0.0, 1.0 - ((q[joint] - OPTIMUM[k]) / LONGEST) ** 2)
            v = min(1.0, max(-1.0, shorten / FASTEST))
            speed = (1.0 - v) / (1.0 + v / HILL) if v >= 0.0 else 1.5 - 0.5 * (1.0 + v) / (1.0 - 7.56 * v)
            force = activation[k] * STRONGEST[k] * length * speed
            tau[joint] += force * ARM[k] if side == 0 else -force * ARM[k]
