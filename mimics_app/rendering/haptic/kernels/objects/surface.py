"""What a touched surface does: its ripple, its normal force, and its friction, all in the frame of the shape.

Friction is the anchor of Hayward and Armstrong in that frame, hence rides with a moving object and does not drift: it
is seen in the tangent plane of the tick, stays where it is while it holds, and is dragged at the cone. It breaks away
at the static coefficient and slides at the dynamic one; while it holds, a damper as strong as the normal one calms it,
clamped to the same cone.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.haptic_objects import ForceLaw
from mimics_app.contracts.kernel import kernel
from mimics_app.rendering.haptic.kernels.contact_law import hunt_crossley, spring_damper
from mimics_app.rendering.haptic.kernels.friction import hayward_armstrong
from mimics_app.rendering.haptic.kernels.vectors import fill, norm

if TYPE_CHECKING:
    from mimics_app.contracts.record_types import ContactRecord, MemoryRecord, ShapeRecord

__all__ = ["anchor_stiffness", "lower_by_ripple", "normal_force", "rub"]


_AT_REST = 1e-9
"""Share of its reach by which friction may be overstretched and still counts as holding: rounding, not motion."""


@kernel
def lower_by_ripple(shape: ShapeRecord, p: Vec, contact: ContactRecord, slope: Vec) -> None:
    """Take the surface's ripple off a contact's depth.

    The surface lies h(q) = height/2 (1 - g(q)) under the smooth one, where g is the mean of sines along the two tangent
    directions of the point q of the surface; on curved surfaces the sines of the frame's axes are weighed by how far
    they are tangent. The force follows the rippled surface, normal - slope, so that on a flat face it has a potential:
    no stroke gains energy. It changes by at most k (pi height / length) per metre along the surface.

    Args:
        shape: SHAPE row; its texture_length is not read while texture_height is 0.
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
    """Force [N] of the shape's law, its stiffness [N/m] and its damping [N s/m] at this depth [m] and rate [m/s]."""
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
    """Move the anchor along the normal into the tangent plane of the touched point; its distance from there [m]."""
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
    """Add a damper along the surface to the holding force and clamp it to the cone."""
    along = v[0] * normal[0] + v[1] * normal[1] + v[2] * normal[2]
    for i in range(3):
        out[i] -= damping * (v[i] - along * normal[i])
    size = norm(out)
    if size > most:
        for i in range(3):
            out[i] *= most / size


@kernel
def rub(
    shape: ShapeRecord, touched: Vec, v: Vec, normal: Vec, push: float, damping: float, memory: MemoryRecord, out: Vec
) -> None:
    """Friction of one contact; |out| <= mu_s push while it holds, = mu_d push while it slides.

    Args:
        shape: SHAPE row.
        touched: Touched point in the frame of the shape [m].
        v: Velocity of the point relative to the shape, same frame [m/s].
        normal: Outward unit normal.
        push: Clamped normal force [N] >= 0; 0 ends the hold.
        damping: Of the normal law [N s/m], used along the surface too while friction holds.
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
        if stays:  # an anchor that followed the turning plane would creep on curved surfaces
            memory.anchor[0], memory.anchor[1], memory.anchor[2] = x, y, z
        _damp(v, normal, damping, shape.friction_static * push, out)
