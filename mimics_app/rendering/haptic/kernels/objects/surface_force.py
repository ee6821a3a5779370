"""Forces of a touched surface, its ripple, normal force and friction, in the frame of the shape.

Friction is the anchor of Hayward and Armstrong in that frame, so that it moves with the object and does not drift. The
anchor is projected to the tangent plane of the tick, is fixed while friction sticks, and is dragged at the cone.
Friction breaks away at the static coefficient and slides at the dynamic one; while it sticks, a damper equal to the
normal one is added, clamped to the same cone.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.loop.haptic_objects import ForceLaw
from mimics_app.maths.vec import clamp_norm, dot, fill
from mimics_app.rendering.haptic.kernels.contact_law import hunt_crossley, spring_damper
from mimics_app.rendering.haptic.kernels.friction import hayward_armstrong

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import ContactRecord, MemoryRecord, ShapeRecord

__all__ = ["anchor_stiffness", "lower_by_ripple", "normal_force", "set_friction"]


_AT_REST = 1e-9
"""Relative overstretch up to which friction counts as sticking [-]: rounding."""


@kernel
def lower_by_ripple(shape: ShapeRecord, p: Vec, contact: ContactRecord, slope: Vec) -> None:
    """Subtract the ripple of the surface from a contact's depth.

    The surface lies h(q) = height/2 (1 - g(q)) below the smooth one, where g is the mean of sines along the two tangent
    directions at the point q of the surface; on curved surfaces the sines along the frame's axes are weighted by their
    tangential part. The force is normal to the rippled surface, normal - slope, so that on a flat face it has a
    potential: no stroke generates energy. It changes by at most k (pi height / length) per metre along the surface.

    Args:
        shape: SHAPE row; texture_length is ignored while texture_height is 0.
        p: Point in the frame of the shape [m].
        contact: Record of `CONTACT`; depth is lowered, not below 0.
        slope: Receives the gradient of -h along the surface [-], shape [3].
    """
    if shape.texture_height == 0.0:
        fill(slope, 0.0)
        return
    n = contact.normal
    wave = 2.0 * math.pi / shape.texture_length
    height, along = 0.0, 0.0
    for i in range(3):
        share = 0.5 * (1.0 - n[i] * n[i])
        angle = wave * (p[i] + contact.depth * n[i])
        height += share * math.sin(angle)
        slope[i] = 0.5 * shape.texture_height * share * wave * math.cos(angle)
        along += slope[i] * n[i]
    for i in range(3):
        slope[i] -= along * n[i]
    contact.depth = max(0.0, contact.depth - 0.5 * shape.texture_height * (1.0 - height))


@kernel
def normal_force(shape: ShapeRecord, depth: float, rate: float) -> tuple[float, float, float]:
    """Force [N] of the shape's law, its stiffness [N/m] and damping [N s/m], at a depth > 0 [m] and its rate [m/s]."""
    if shape.law == ForceLaw.HUNT_CROSSLEY:
        lam = shape.stiffness * shape.damping
        force = hunt_crossley(depth, rate, shape.stiffness, lam, shape.exponent)
        pushed = depth**shape.exponent
        return force, shape.stiffness * shape.exponent * pushed / depth, lam * pushed
    return spring_damper(depth, rate, shape.stiffness, shape.damping), shape.stiffness, shape.damping


@kernel
def anchor_stiffness(shape: ShapeRecord) -> float:
    """Stiffness of the spring to the anchor of friction [N/m]."""
    return shape.friction_stiffness if shape.friction_stiffness > 0.0 else shape.stiffness


@kernel
def _into_plane(memory: MemoryRecord, touched: Vec, normal: Vec) -> float:
    """Project the anchor to the tangent plane of the touched point; return its distance from that point [m]."""
    off = 0.0
    for i in range(3):
        off += (touched[i] - memory.anchor[i]) * normal[i]
    square = 0.0
    for i in range(3):
        memory.anchor[i] += off * normal[i]
        square += (touched[i] - memory.anchor[i]) ** 2
    return math.sqrt(square)


@kernel
def _damp(v: Vec, normal: Vec, damping: float, most: float, out: Vec) -> None:
    """Add a tangential damper to the force of sticking friction and clamp the sum to `most` [N]."""
    along = dot(v, normal)
    for i in range(3):
        out[i] -= damping * (v[i] - along * normal[i])
    clamp_norm(out, most)


@kernel
def set_friction(
    shape: ShapeRecord, touched: Vec, v: Vec, normal: Vec, push: float, damping: float, memory: MemoryRecord, out: Vec
) -> None:
    """Set the friction of one contact; |out| <= mu_s push while it sticks, = mu_d push while it slides.

    Args:
        shape: SHAPE row.
        touched: Touched point in the frame of the shape [m].
        v: Velocity of the point relative to the shape, same frame [m/s].
        normal: Outward unit normal.
        push: Clamped normal force [N] >= 0; 0 ends the contact.
        damping: Damping of the normal law [N s/m], also used along the surface while friction sticks.
        memory: Record of `MEMORY`, updated.
        out: Receives the force on the point [N], along the surface.
    """
    if shape.friction_static <= 0.0 or push <= 0.0:
        memory.touching = 0
        memory.sticking = 0
        fill(out, 0.0)
        return
    x, y, z = memory.anchor[0], memory.anchor[1], memory.anchor[2]
    stays = memory.touching == 1
    stiffness = anchor_stiffness(shape)
    held = memory.touching == 0 or memory.sticking == 1
    if memory.touching == 1:
        stretch = _into_plane(memory, touched, normal)
        held = held or stretch <= shape.friction_dynamic * push / stiffness * (1.0 + _AT_REST)
    if held:
        hayward_armstrong(touched, push, shape.friction_static, stiffness, memory, out)
    if not held or memory.sticking == 0:
        hayward_armstrong(touched, push, shape.friction_dynamic, stiffness, memory, out)
        memory.sticking = 0
    else:
        if stays:  # an anchor that followed the tangent plane would creep on curved surfaces
            memory.anchor[0], memory.anchor[1], memory.anchor[2] = x, y, z
        _damp(v, normal, damping, shape.friction_static * push, out)
