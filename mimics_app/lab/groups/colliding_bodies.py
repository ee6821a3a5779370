"""Integrators of colliding bodies, with their cost and error.

Cost: one tick of boxes at rest on a floor, all awake, with four points of contact
and friction each. Error: restitution of a ball of 0.2 kg dropped on 2 kN/m at zeta = 0.3 and 1 ms against the closed
form of a contact without tension, the largest over the phases of the tick at impact.

Two or four steps per tick halve and quarter the error at two and four times the cost. They are yardsticks: the error at
1 ms is below the perceptible difference of a bounce, and a stiffer contact is limited by the device's own tick.
"""

from __future__ import annotations

import math

import numpy as np

from mimics_app.contracts.loop.haptic_objects import ObjectIntegrator
from mimics_app.lab.groups.contact_law import restitution_spring_damper
from mimics_app.lab.haptic.body_worlds import new_world, rest_on_floor
from mimics_app.lab.haptic.probe import SIZES, reference_us
from mimics_app.lab.probe import shortest_us
from mimics_app.lab.rivals import Growth, Probes, Rival, compare

__all__: list[str] = []


_MASS, _STIFFNESS, _ZETA, _SPEED = 0.2, 2000.0, 0.3, 0.3
_PHASES = 8
_SETTLING_TICKS = 500
_TICKS = 20_000

_METHODS: dict[str, tuple[ObjectIntegrator, int]] = {
    "semi-implicit": (ObjectIntegrator.SEMI_IMPLICIT, 1),
    "explicit": (ObjectIntegrator.EXPLICIT, 1),
    "exact drag": (ObjectIntegrator.EXACT_DRAG, 1),
    "implicit midpoint": (ObjectIntegrator.IMPLICIT_MIDPOINT, 1),
    "semi-implicit, 2 steps": (ObjectIntegrator.SEMI_IMPLICIT, 2),
    "semi-implicit, 4 steps": (ObjectIntegrator.SEMI_IMPLICIT, 4),
}
"""Integrator and steps per tick, by method."""


def _bounce(method: str, phase: float) -> float:
    """Return the restitution of the ball with the impact at a phase 0..1 of the tick."""
    integrator, steps = _METHODS[method]
    world = new_world(1, 2, dt=1e-3 / steps)
    damping = 2.0 * _ZETA * math.sqrt(_STIFFNESS * _MASS)
    world.add_floor(stiffness=1e15, damping=0.0)
    world.add_ball(
        mass=_MASS,
        surface={"stiffness": _STIFFNESS, "damping": damping},
        position=(0.0, 0.02 + phase * _SPEED * 1e-3, 0.0),
        velocity=(0.0, -_SPEED, 0.0),
        integrator=integrator,
    )
    for _ in range(500 * steps):
        world.run(1)
        if world.motions[0]["position"][1] > 0.02 and world.motions[0]["velocity"][1] > 0.0:
            break
    return float(world.motions[0]["velocity"][1]) / _SPEED


def _bounce_error(method: str) -> float:
    """Return the largest difference of the restitution from the closed form over the phases of the impact."""
    exact = restitution_spring_damper(_ZETA)
    return max(abs(_bounce(method, float(phase)) - exact) for phase in np.arange(1, _PHASES + 1) / _PHASES)


def _step_us(method: str, bodies: int) -> float:
    """Return the cost of a tick of boxes at rest on a floor [us]."""
    integrator, steps = _METHODS[method]
    world = rest_on_floor(bodies, integrator=integrator)
    world.dt /= steps
    world.run(_SETTLING_TICKS)
    ticks = max(20, _TICKS // bodies)
    return shortest_us(lambda: world.run(ticks * steps), ticks)


compare(
    __name__,
    "a tick of boxes on a floor; error: restitution of a ball of 0.2 kg at zeta = 0.3, 2 kN/m and 1 ms",
    "restitution",
    [
        Rival(
            "semi-implicit",
            "velocity first, the place with the new velocity: keeps a stack without any damper",
            "m > n (h^2 k + 2 h b)/4",
            {"integrator": "semi_implicit"},
        ),
        Rival("explicit", "Euler: both from the old state", "contacts with b > k h", {"integrator": "explicit"}),
        Rival(
            "exact drag",
            "(11) solved under a held force: exact in free flight, with and without drag",
            "contacts with b > k h/2",
            {"integrator": "exact_drag"},
        ),
        Rival(
            "implicit midpoint",
            "mean of old and new velocity: exact in free fall",
            "contacts with b > k h/2",
            {"integrator": "implicit_midpoint"},
        ),
        Rival(
            "semi-implicit, 2 steps",
            "collisions and motion twice a tick",
            "a fourth of the mass, or four times the stiffness",
        ),
        Rival("semi-implicit, 4 steps", "collisions and motion four times a tick", "a sixteenth of the mass"),
    ],
    Probes(_step_us, _bounce_error, reference_us),
    default="semi-implicit",
    growth=Growth(work="moving bodies", sizes=SIZES),
)
