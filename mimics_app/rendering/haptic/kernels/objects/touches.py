"""Begin and end of contacts, debounced: one scrape is one contact."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.rendering.haptic.kernels.state import CONTACT_BEGAN, CONTACT_ENDED, CONTACT_UNCHANGED

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import (
        MotionRecord,
        ObjectCountsRecord,
        StateRecord,
        Table,
        TotalsRecord,
        TouchRecord,
    )

__all__ = ["TOUCH", "follow_touch", "follow_touches"]

_CLEAR_TIME = 0.02
"""Time without touching after which a contact ends [s]."""

TOUCH = np.dtype(
    [
        ("in_contact", "i8"),
        ("clear_ticks", "i8"),  # in a row without touching
        ("change", "i8"),  # CONTACT_... of this tick
    ],
    align=True,
)
"""Contact state of one point of contact and one partner; row 0 is the static scene, row i + 1 body i."""


@kernel
def follow_touch(touch: TouchRecord | StateRecord, touching: bool, rendered: bool, dt: float) -> int:
    """Advance the contact state of one partner by one tick; return its CONTACT_... change.

    Args:
        touch: Record with `in_contact` and `clear_ticks`, updated.
        touching: Whether the partner is touched in this tick.
        rendered: Whether the user can feel it; a contact that is not felt ends.
        dt: Tick [s].
    """
    touch.clear_ticks = 0 if touching else touch.clear_ticks + 1
    if touching and rendered and touch.in_contact == 0:
        touch.in_contact = 1
        return CONTACT_BEGAN
    if touch.in_contact == 1 and (not rendered or touch.clear_ticks * dt >= _CLEAR_TIME):
        touch.in_contact = 0
        return CONTACT_ENDED
    return CONTACT_UNCHANGED


@kernel
def follow_touches(
    touches: Table[TouchRecord],
    totals: TotalsRecord,
    motions: Table[MotionRecord],
    counts: ObjectCountsRecord,
    contact: int,
    rendered: bool,
    dt: float,
) -> int:
    """Advance the contact states of one point of contact by one tick; return how many partners it is in contact with.

    Args:
        touches: Its TOUCH records, of the static scene and of all bodies.
        totals: Its TOTALS record.
        motions: MOTION records.
        counts: SCENE.objects.
        contact: Number of the point.
        rendered: Whether the user can feel it.
        dt: Tick [s].
    """
    if counts.shapes == 0:
        return 0
    touches[0].change = follow_touch(touches[0], totals.static_touching > 0, rendered, dt)
    partners = touches[0].in_contact
    for k in range(counts.bodies):
        is_touched = (motions[k].touched >> contact) & 1 == 1
        touches[k + 1].change = follow_touch(touches[k + 1], is_touched, rendered, dt)
        partners += touches[k + 1].in_contact
    return partners
