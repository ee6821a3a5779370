"""Laws of the effects: each fills `memory.force` from memory.p and memory.v, the motion relative to its place.

Every spring here is the gradient of a potential and every damper dissipates, so that both are passive. Only guidance,
vibration, constant forces and force fields are active, by at most their force times the displacement.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.maths.vec import clamp_norm, copy, norm

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import EffectMemoryRecord, EffectRecord

__all__ = [
    "add_bounded",
    "bound",
    "brake",
    "is_within",
    "magnet",
    "pull_back",
    "push",
    "shake",
    "spring",
    "stick_and_slip",
]


_SMALLEST = 1e-12
"""Distance from its place below which a spring has no direction and no force [m]."""


@kernel
def is_within(effect: EffectRecord, memory: EffectMemoryRecord) -> bool:
    """True inside the radius of the effect; a radius of 0 has no limit."""
    return effect.radius <= 0.0 or norm(memory.p) <= effect.radius


@kernel
def bound(force: Vec, limit: float) -> None:
    """Shorten a force to a limit [N]; 0: no limit."""
    if limit > 0.0:
        clamp_norm(force, limit)


@kernel
def add_bounded(force: Vec, damper: Vec, limit: float) -> None:
    """Add a damper's force to a spring's, with the sum within a limit [N]; 0: no limit.

    The spring is shortened to the limit first, which keeps it the gradient of a potential; then the largest share of
    the damper within the limit is added. So the limit is passive; shortening the sum could generate energy.
    """
    bound(force, limit)
    share = 1.0
    if limit > 0.0:
        a, b, c = 0.0, 0.0, -limit * limit
        for i in range(3):
            a += damper[i] * damper[i]
            b += force[i] * damper[i]
            c += force[i] * force[i]
        if a > 0.0:
            share = min(1.0, max(0.0, (-b + math.sqrt(max(0.0, b * b - a * min(c, 0.0)))) / a))
    for i in range(3):
        force[i] += share * damper[i]


@kernel
def spring(effect: EffectRecord, memory: EffectMemoryRecord) -> None:
    """Spring with dead band: F = -k (r - dead band) p/r - b v outside of it."""
    r = norm(memory.p)
    beyond = r - effect.slip
    if beyond <= 0.0 or r < _SMALLEST or not is_within(effect, memory):
        return
    for i in range(3):
        memory.force[i] = -memory.stiffness * beyond * memory.p[i] / r
        memory.damper[i] = -effect.damping * memory.v[i]
    add_bounded(memory.force, memory.damper, memory.size)
    memory.held = 1


@kernel
def brake(effect: EffectRecord, memory: EffectMemoryRecord) -> None:
    """Viscosity: F = -b v."""
    if not is_within(effect, memory):
        return
    for i in range(3):
        memory.force[i] = -effect.damping * memory.v[i]
    bound(memory.force, memory.size)
    memory.held = 1


@kernel
def push(effect: EffectRecord, memory: EffectMemoryRecord) -> None:
    """Constant force: F = f e."""
    if is_within(effect, memory):
        for i in range(3):
            memory.force[i] = memory.size * effect.direction[i]


@kernel
def magnet(effect: EffectRecord, memory: EffectMemoryRecord) -> None:
    """Magnet: F = -min(k r, f (1 - r/R)) p/r - b (1 - r/R) v, continuous, 0 at R."""
    r = norm(memory.p)
    if r >= effect.radius:
        return
    fade = 1.0 - r / effect.radius
    pull = min(memory.stiffness * r, max(0.0, memory.size) * fade)
    for i in range(3):
        toward = -memory.p[i] / r if r >= _SMALLEST else 0.0
        memory.force[i] = pull * toward - effect.damping * fade * memory.v[i]
    memory.held = 1


@kernel
def shake(effect: EffectRecord, memory: EffectMemoryRecord, t: float) -> None:
    """Vibration: F = a sin(2 pi f t) e."""
    if is_within(effect, memory):
        phase = effect.frequency * t
        now = memory.size * math.sin(2.0 * math.pi * (phase - math.floor(phase)))
        for i in range(3):
            memory.force[i] = now * effect.direction[i]


@kernel
def stick_and_slip(effect: EffectRecord, local: Vec, memory: EffectMemoryRecord) -> None:
    """Stick-slip: F = -k (x - w), w jumps to x at the distance `slip`; the energy of the spring is lost each time.

    Args:
        effect: EFFECT record.
        local: x from the effect's place, in the frame of the anchor [m], shape [3].
        memory: EFFECT_MEMORY record; `force` is set in that frame.
    """
    if not is_within(effect, memory):
        memory.sticking = 0
        return
    away = 0.0
    for i in range(3):
        gap = local[i] - memory.anchor[i]
        away += gap * gap
    if memory.sticking == 0 or away > effect.slip * effect.slip:
        copy(local, memory.anchor)
    memory.sticking = 1
    for i in range(3):
        memory.force[i] = -memory.stiffness * (local[i] - memory.anchor[i])
    memory.held = 1


@kernel
def _wall(depth: float, rate: float, k: float, b: float) -> float:
    """Push of a wall [N], never a pull."""
    return max(0.0, k * depth + b * rate) if depth > 0.0 else 0.0


@kernel
def pull_back(effect: EffectRecord, memory: EffectMemoryRecord) -> None:
    """Workspace: inward walls of a sphere about the place, or of a box with the half edges effect.direction."""
    k, b = memory.stiffness, effect.damping
    if effect.radius > 0.0:
        r = norm(memory.p)
        if r <= effect.radius:
            return
        rate = (memory.p[0] * memory.v[0] + memory.p[1] * memory.v[1] + memory.p[2] * memory.v[2]) / r
        back = _wall(r - effect.radius, rate, k, b)
        for i in range(3):
            memory.force[i] = -back * memory.p[i] / r
    else:
        for i in range(3):
            side = 1.0 if memory.p[i] >= 0.0 else -1.0
            back = _wall(side * memory.p[i] - effect.direction[i], side * memory.v[i], k, b)
            memory.force[i] = -side * back
    memory.held = 1 if norm(memory.force) > 0.0 else 0
    bound(memory.force, memory.size)
