"""Effects along a path: their place is the closest point of a B-spline, as in the tunnel (D2.1 4.2.10)."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from mimics_app.compiled.kernel import kernel
from mimics_app.maths.vec import dot, norm
from mimics_app.rendering.haptic.kernels.objects.effect_laws import add_bounded, is_within
from mimics_app.rendering.haptic.kernels.tunnel import fade_at_end
from mimics_app.rendering.haptic.kernels.tunnel_frame import arc_at
from mimics_app.rendering.haptic.kernels.tunnel_projection import axis, locate, track

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import EffectMemoryRecord, EffectRecord, TunnelRecord

__all__ = ["find_path", "guide", "pull_to_path"]

_SMALLEST = 1e-12
"""Distance from the path below which the spring has no direction and no force [m]."""


@kernel
def find_path(path: TunnelRecord, memory: EffectMemoryRecord) -> float:
    """Find the closest point: memory.p becomes the offset from it, memory.path.tangent its tangent.

    Args:
        path: TUNNEL record with pieces.
        memory: EFFECT_MEMORY record; p is the world position on entry.

    Returns:
        Remaining arc length to the end [m].
    """
    p, state = memory.p, memory.path
    s = track(path, p[0], p[1], p[2], state)
    piece, u = locate(path, s)
    x, x1, _ = axis(path, piece, 0, u)
    y, y1, _ = axis(path, piece, 1, u)
    z, z1, _ = axis(path, piece, 2, u)
    speed = math.sqrt(x1 * x1 + y1 * y1 + z1 * z1)
    state.tangent[0] = x1 / speed
    state.tangent[1] = y1 / speed
    state.tangent[2] = z1 / speed
    p[0] -= x
    p[1] -= y
    p[2] -= z
    return path.arc_length[path.pieces] - arc_at(path, piece, u)


@kernel
def pull_to_path(effect: EffectRecord, memory: EffectMemoryRecord) -> None:
    """Path spring: F = -k (r - dead band) e/r - b v', v' the velocity across the path, beyond an end also along it.

    e.t is 0 except beyond an end, where v' includes the share (e.t/r)^2 of the motion along t: continuous at the end.
    """
    t, e, v = memory.path.tangent, memory.p, memory.v
    r = norm(e)
    beyond = r - effect.slip
    if beyond <= 0.0 or r < _SMALLEST or not is_within(effect, memory):
        return
    lean = dot(e, t) / r
    free = (1.0 - lean * lean) * dot(v, t)
    for i in range(3):
        memory.force[i] = -memory.stiffness * beyond * e[i] / r
        memory.damper[i] = -effect.damping * (v[i] - free * t[i])
    add_bounded(memory.force, memory.damper, memory.size)
    memory.held = 1


@kernel
def guide(effect: EffectRecord, memory: EffectMemoryRecord, remaining: float) -> None:
    """Guidance: F = (f - b v.t) t, where f fades before the end and is 0 beyond it."""
    if not is_within(effect, memory):
        return
    t, v = memory.path.tangent, memory.v
    along = memory.size * fade_at_end(remaining) - effect.damping * dot(v, t)
    for i in range(3):
        memory.force[i] = along * t[i]
