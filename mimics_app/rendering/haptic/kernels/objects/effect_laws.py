"""Laws of the effects: each fills `memory.force` from memory.p and memory.v, the motion relative to its place.

Every spring here is the gradient of a potential and every damper takes energy, so that none of them gives any; only
guidance, vibration, constant forces, and force fields do, and those no more than their force times the displacement.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.kernel import kernel

if TYPE_CHECKING:
    from mimics_app.contracts.record_types import EffectMemoryRecord, EffectRecord

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
"""Nearer to its place than this [m] a spring has no direction to pull in, and no need."""


@kernel
def _norm(a: Vec) -> float:
    return math.sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2])


@kernel
def is_within(effect: EffectRecord, memory: EffectMemoryRecord) -> bool:
    """Whether what feels the effect is near enough to its place."""
    return effect.radius <= 0.0 or _norm(memory.p) <= effect.radius


@kernel
def bound(force: Vec, limit: float) -> None:
    """Shorten a force to a limit [N] > 0; with limit 0 there is none."""
    size = _norm(force)
    if limit > 0.0 and size > limit:
        for i in range(3):
            force[i] *= limit / size


@kernel
def add_bounded(force: Vec, damper: Vec, limit: float) -> None:
    """Add a damper's force to a spring's, that together they stay within a limit [N]; with limit 0 there is none.

    The spring alone is shortened to the limit first, which leaves it the gradient of a potential; then as much of the
    damper is added as fits. So the bound gives no energy, as a shortened sum of the two could.
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
    """F = -k (r - dead band) p/r - b v, outside of the dead band."""
    r = _norm(memory.p)
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
    """F = -b v."""
    if not is_within(effect, memory):
        return
    for i in range(3):
        memory.force[i] = -effect.damping * memory.v[i]
    bound(memory.force, memory.size)
    memory.held = 1


@kernel
def push(effect: EffectRecord, memory: EffectMemoryRecord) -> None:
    """F = f e."""
    if is_within(effect, memory):
        for i in range(3):
            memory.force[i] = memory.size * effect.direction[i]


@kernel
def magnet(effect: EffectRecord, memory: EffectMemoryRecord) -> None:
    """F = -min(k r, f (1 - r/R)) p/r - b (1 - r/R) v: continuous, nothing at R and at its place."""
    r = _norm(memory.p)
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
    """F = a sin(2 pi f t) e."""
    if is_within(effect, memory):
        phase = effect.frequency * t
        now = memory.size * math.sin(2.0 * math.pi * (phase - math.floor(phase)))
        for i in range(3):
            memory.force[i] = now * effect.direction[i]


@kernel
def stick_and_slip(effect: EffectRecord, local: Vec, memory: EffectMemoryRecord) -> None:
    """F = -k (x - w), and w jumps to x when it is `slip` away: the energy of the spring is lost each time.

    Args:
        effect: EFFECT record.
        local: x, from the effect's place, in the frame the anchor is kept in [m], shape [3].
        memory: EFFECT_MEMORY record; `force` is given in that frame.
    """
    if not is_within(effect, memory):
        memory.sticking = 0
        return
    away = 0.0
    for i in range(3):
        gap = local[i] - memory.anchor[i]
        away += gap * gap
    if memory.sticking == 0 or away > effect.slip * effect.slip:
        for i in range(3):
            memory.anchor[i] = local[i]
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
    """Walls of a ball about the place, or of a box whose half edges are effect.direction, pushing inwards."""
    k, b = memory.stiffness, effect.damping
    if effect.radius > 0.0:
        r = _norm(memory.p)
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
    memory.held = 1 if _norm(memory.force) > 0.0 else 0
    bound(memory.force, memory.size)
