"""What is remembered of each interaction point at each shape: the feature it came in by, and where friction holds it.

A shape that no point came near in the last tick was not looked at, so the point's last place in its frame is found from
the last world position and the last pose of its body: a moving object is entered by the same face as a resting one.
Memory ends where it would mislead: the shape was enabled or edited, its body put back to its start, the point
disabled, enabled, or displaced faster than anything moves.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.contracts.kernel import kernel
from mimics_app.maths import quat
from mimics_app.rendering.haptic.kernels.contact import forget
from mimics_app.rendering.haptic.kernels.objects.contact_scratch import DISABLED, PLACED, TRACED
from mimics_app.rendering.haptic.kernels.vectors import copy, rotate_back

if TYPE_CHECKING:
    from mimics_app.contracts.record_types import (
        BeforeRecord,
        BirthRecord,
        ContactScratchRecord,
        MemoryRecord,
        MotionRecord,
        ObjectCountsRecord,
        ShapeRecord,
        Table,
    )

__all__ = ["follow_point", "forget_touch", "keep_poses", "notice_changes", "recall"]

_FASTEST = 50.0
"""A point that seems faster than this [m/s] was put somewhere else."""


@kernel
def forget_touch(memory: MemoryRecord) -> None:
    """Start as if the point had never been near the shape."""
    forget(memory.contact)
    memory.touching = 0
    memory.sticking = 0


@kernel
def _same_form(a: ShapeRecord, b: ShapeRecord) -> bool:
    """Two SHAPE rows that are the same place to touch; stiffness and friction may differ."""
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
    """Begin a tick: note which shapes are new, edited, or on a body that was put back to its start."""
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
    """Whether the last place of the present point (scratch.point) is where it came from."""
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
    """End a tick: the poses of the bodies that the next one calls the last."""
    for body in range(bodies):
        copy(motions[body].position, befores[body].position)
        for i in range(3):
            for j in range(3):
                befores[body].rotation[i, j] = motions[body].rotation[i, j]


@kernel
def _last_place_on_body(scratch: ContactScratchRecord, shape: ShapeRecord, before: BeforeRecord) -> None:
    """scratch.c: where the point was in the shape's frame, from the last pose of its body [m]."""
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
    """Make the memory of the present point and shape hold the last tick, or nothing where nothing is known of it.

    Args:
        scratch: CONTACT_SCRATCH record with the present point and the pose of the present shape.
        point: Row of the point.
        shape: SHAPE row of the present shape.
        born: Tick in which it became what it is.
        befores: Bodies at the last tick.
        memory: MEMORY of the two, updated.
    """
    traced = scratch.known[point] == TRACED and born != scratch.tick
    if not traced or memory.tick != scratch.tick - 1:
        forget_touch(memory)
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
