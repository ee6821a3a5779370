"""Begin and end of touching an object, as events and counts want them: without the chatter of one scrape."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mimics_app.contracts.kernel import kernel
from mimics_app.rendering.haptic.kernels.state import CONTACT_BEGAN, CONTACT_ENDED, CONTACT_UNCHANGED

if TYPE_CHECKING:
    from mimics_app.contracts.record_types import (
        ObjectCountsRecord,
        ObjectWork,
        StateRecord,
        Table,
        TotalsRecord,
        TouchRecord,
    )

__all__ = ["CLEAR_TIME", "TOUCH", "follow_touch", "follow_touches"]

CLEAR_TIME = 0.02
"""A contact ends after this long without touching [s]: no chatter of one scrape into many."""

TOUCH = np.dtype(
    [
        ("in_contact", "i8"),
        ("clear_ticks", "i8"),  # in a row without touching
        ("change", "i8"),  # CONTACT_... of this tick
    ],
    align=True,
)
"""Memory of one partner of touch; row 0 is the static scene, row i + 1 body i."""


@kernel
def follow_touch(touch: TouchRecord | StateRecord, touching: bool, felt: bool, dt: float) -> int:
    """Follow one partner for one tick; its CONTACT_... change.

    Args:
        touch: Record with `in_contact` and `clear_ticks`, updated.
        touching: It is touched in this tick.
        felt: The user can feel it; a contact ends when not.
        dt: Tick [s].
    """
    touch.clear_ticks = 0 if touching else touch.clear_ticks + 1
    if touching and felt and touch.in_contact == 0:
        touch.in_contact = 1
        return CONTACT_BEGAN
    if touch.in_contact == 1 and (not felt or touch.clear_ticks * dt >= CLEAR_TIME):
        touch.in_contact = 0
        return CONTACT_ENDED
    return CONTACT_UNCHANGED


@kernel
def _touch_static(totals: Table[TotalsRecord]) -> bool:
    """Whether any point of contact touches the static scene."""
    for c in range(totals.shape[0]):
        if totals[c].static_touching > 0:
            return True
    return False


@kernel
def follow_touches(work: ObjectWork, counts: ObjectCountsRecord, felt: bool, dt: float) -> None:
    """Follow the static scene and all bodies for one tick."""
    if counts.shapes == 0:
        return
    for k in range(counts.bodies + 1):
        touch = work.touches[k]
        touching = _touch_static(work.totals) if k == 0 else work.motions[k - 1].touched == 1
        touch.change = follow_touch(touch, touching, felt, dt)
