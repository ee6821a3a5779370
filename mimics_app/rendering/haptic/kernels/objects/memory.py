"""Contact memory of each interaction point at each shape: feature of entry and anchor of friction.

For a shape that was not near the point in the last tick, the point's last position in its frame follows from the last
world position and the last pose of its body: a moving object is entered through the same face as a resting one. The
memory is cleared where it is invalid: the shape was enabled or edited, its body respawned, the point disabled, enabled,
or displaced faster than `_FASTEST`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.compiled.kernel import kernel
from mimics_app.maths import quat
from mimics_app.maths.vec import copy, rotate_back
from mimics_app.rendering.haptic.kernels.contact import forget
from mimics_app.rendering.haptic.kernels.objects.contact_scratch import DISABLED, PLACED, TRACED

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import (
        BeforeRecord,
        BirthRecord,
        ContactScratchRecord,
        MemoryRecord,
        MotionRecord,
        ObjectCountsRecord,
        ShapeRecord,
        Table,
    )

__all__ = ["follow_point", "keep_poses", "notice_changes", "recall"]

_FASTEST = 50.0
"""Speed from which a motion of a point counts as a teleport [m/s]."""


@kernel
def _forget_touch(memory: MemoryRecord) -> None:
    """Clear the memory of a point at a shape."""
    forget(memory.contact)
    memory.touching = 0
    memory.sticking = 0


@kernel
def _same_form(a: ShapeRecord, b: ShapeRecord) -> bool:
    """True for two SHAPE rows of the same geometry; stiffness and friction may differ."""
    if a.kind != b.kind or a.body != b.body or a.enabled != b.enabled or a.mesh != b.mesh:
        return False
    for i in range(3):
        if a.position[i] != b.position[i] or a.size[i] != b.size[i]:
            return False
    for i in range(quat.QUATERNION):
        if a.orientation[i] != b.orientation[i]:
            return False
    return a.rounding == b.rounding


@kernel
def _keep_form(shape: ShapeRecord, form: ShapeRecord) -> None:
    """Copy the geometry of a SHAPE row."""
    form.kind, form.body, form.enabled, form.mesh = shape.kind, shape.body, shape.enabled, shape.mesh
    copy(shape.position, form.position)
    copy(shape.orientation, form.orientation)
    copy(shape.size, form.size)
    form.rounding = shape.rounding


@kernel
def notice_changes(
    shapes: Table[ShapeRecord],
    motions: Table[MotionRecord],
    counts: ObjectCountsRecord,
    scratch: ContactScratchRecord,
    births: Table[BirthRecord],
    befores: Table[BeforeRecord],
) -> None:
    """Begin a tick: note the shapes that are new, edited, or on a respawned body."""
    scratch.tick += 1
    if counts.revision != scratch.revision or scratch.tick == 1:
        scratch.revision = counts.revision
        for i in range(counts.shapes):
            if not _same_form(shapes[i], births[i].form):
                _keep_form(shapes[i], births[i].form)
                births[i].tick = scratch.tick
    for body in range(counts.bodies):
        if motions[body].spawn != befores[body].spawn:
            befores[body].spawn = motions[body].spawn
            for i in range(counts.shapes):
                if shapes[i].body == body:
                    births[i].tick = scratch.tick


@kernel
def follow_point(scratch: ContactScratchRecord, point: int, enabled: bool, dt: float) -> None:
    """Set whether the present point (scratch.point) moved continuously from its last position."""
    jump = 0.0
    for i in range(3):
        scratch.last[i] = scratch.last_points[point, i]
        scratch.last_points[point, i] = scratch.point[i]
        jump += (scratch.point[i] - scratch.last[i]) ** 2
    if not enabled:
        scratch.known[point] = DISABLED
    elif scratch.tick == 1 or scratch.known[point] == DISABLED or not jump <= (_FASTEST * dt) ** 2:
        scratch.known[point] = PLACED
    else:
        scratch.known[point] = TRACED


@kernel
def keep_poses(motions: Table[MotionRecord], bodies: int, befores: Table[BeforeRecord]) -> None:
    """End a tick: keep the poses of the bodies for the next one."""
    for body in range(bodies):
        copy(motions[body].position, befores[body].position)
        for i in range(3):
            for j in range(3):
                befores[body].rotation[i, j] = motions[body].rotation[i, j]


@kernel
def _last_place_on_body(scratch: ContactScratchRecord, shape: ShapeRecord, before: BeforeRecord) -> None:
    """Set scratch.c to the last position of the point in the shape's frame, by the last pose of its body [m]."""
    for i in range(3):
        scratch.a[i] = scratch.last[i] - before.position[i]
    rotate_back(before.rotation, scratch.a, scratch.b)
    for i in range(3):
        scratch.b[i] -= shape.position[i]
    quat.rotate_back(shape.orientation, scratch.b, scratch.c)


@kernel
def recall(
    scratch: ContactScratchRecord,
    point: int,
    shape: ShapeRecord,
    born: int,
    befores: Table[BeforeRecord],
    memory: MemoryRecord,
) -> None:
    """Update the memory of the present point and shape to the last tick, or clear it where that is unknown.

    Args:
        scratch: CONTACT_SCRATCH record with the present point and the pose of the present shape.
        point: Row of the point.
        shape: SHAPE row of the present shape.
        born: Tick in which the shape was new, edited or respawned.
        befores: Poses of the bodies in the last tick.
        memory: MEMORY of the point at the shape, updated.
    """
    traced = scratch.known[point] == TRACED and born != scratch.tick
    if not traced or memory.tick != scratch.tick - 1:
        _forget_touch(memory)
        if traced:
            if shape.body < 0:
                for i in range(3):
                    scratch.a[i] = scratch.last[i] - scratch.position[i]
                rotate_back(scratch.rotation, scratch.a, scratch.c)
            else:
                _last_place_on_body(scratch, shape, befores[shape.body])
            copy(scratch.c, memory.contact.previous)
            memory.contact.known = 1
    memory.tick = scratch.tick
