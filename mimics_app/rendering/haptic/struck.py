"""Contact forces for the sound: one record per tick for a quarter of a second after a contact began."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.loop.contact_force import FOLLOWED
from mimics_app.contracts.shared_memory.ring import push
from mimics_app.maths.vec import norm
from mimics_app.rendering.haptic.kernels.event_points import event_body, event_point
from mimics_app.rendering.haptic.kernels.state import CONTACT_BEGAN

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.channels import Channels, Work
    from mimics_app.rendering.haptic.record_types import (
        ObjectCountsRecord,
        ObjectWork,
        PairRecord,
        SceneRecord,
        StateRecord,
        StruckRecord,
        Table,
    )

__all__ = ["publish_forces"]


@kernel
def _follow(struck: Table[StruckRecord], body_a: int, body_b: int) -> None:
    """Follow a contact from the next tick on, in the row of the same two bodies or in the one closest to its end."""
    row = 0
    for k in range(struck.shape[0]):
        if struck[k].body_a == body_a and struck[k].body_b == body_b:
            row = k
            break
        if struck[k].left < struck[row].left:
            row = k
    struck[row].body_a, struck[row].body_b, struck[row].left = body_a, body_b, FOLLOWED


@kernel
def _between(pairs: Table[PairRecord], count: int, body_a: int, body_b: int) -> float:
    """Return the normal force between two bodies, summed over all pairs of their shapes [N]."""
    total = 0.0
    for k in range(count):
        pair = pairs[k]
        if pair.touching == 0:
            continue
        if (pair.body_a == body_a and pair.body_b == body_b) or (pair.body_a == body_b and pair.body_b == body_a):
            total += pair.force
    return total


@kernel
def _force_of(struck: StruckRecord, states: Table[StateRecord], objects: ObjectWork) -> float:
    """Return the force of a contact in this tick [N]."""
    if struck.body_a > 0:
        b = struck.body_b - 1 if struck.body_b > 0 else -1
        return _between(objects.pairs, objects.sweep[0].pairs, struck.body_a - 1, b)
    if struck.body_b > 0:
        return norm(objects.motions[struck.body_b - 1].force_user)
    contact = event_point(struck.body_a)
    totals = objects.totals[contact]
    walls = norm(totals.shape_force) if totals.static_touching > 0 else 0.0
    return walls + norm(states[contact].own_tunnel.force_tnb)


@kernel
def _begin_of_point(work: Work, counts: ObjectCountsRecord, contact: int) -> None:
    """Follow the contacts of one point that began in this tick."""
    struck, touches, body_a = work.struck, work.objects.touches[contact], event_body(contact)
    if work.state[contact].contact_change == CONTACT_BEGAN:
        _follow(struck, body_a, -1)
    if counts.shapes == 0:
        return
    for k in range(counts.bodies + 1):
        if touches[k].change == CONTACT_BEGAN:
            _follow(struck, body_a, k if k > 0 else -1)


@kernel
def _begin(work: Work, scene: SceneRecord) -> None:
    """Follow the contacts that began in this tick."""
    struck, objects = work.struck, work.objects
    for contact in range(max(1, scene.contacts)):
        _begin_of_point(work, scene.objects, contact)
    if scene.objects.shapes == 0:
        return
    totals = objects.totals[0]
    if totals.impact > 0.0:
        _follow(
            struck,
            totals.impact_a + 1 if totals.impact_a >= 0 else -1,
            totals.impact_b + 1 if totals.impact_b >= 0 else -1,
        )


@kernel
def publish_forces(channels: Channels, work: Work, scene: SceneRecord, t_ns: int) -> None:
    """Send the force of each followed contact, then follow the contacts that began in this tick.

    Args:
        channels: Arrays of the session.
        work: Arrays of the loop; `struck` is updated.
        scene: SCENE record of this tick.
        t_ns: Release time of the tick [ns].
    """
    for k in range(work.struck.shape[0]):
        struck = work.struck[k]
        if struck.left > 0:
            struck.left -= 1
            row = work.force[0]
            row.t_ns, row.body_a, row.body_b = t_ns, struck.body_a, struck.body_b
            row.force = _force_of(struck, work.state, work.objects)
            push(channels.audio_force_words, channels.audio_forces, work.force)
    _begin(work, scene)
