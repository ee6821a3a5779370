"""Force of a contact tick by tick, from the haptic loop to audio, as the excitation of its sound.

The loop follows a contact for `FOLLOWED` ticks after its event and writes one record per tick to a ring. The force of
the first tick is in the event itself.
"""

from __future__ import annotations

import numpy as np

__all__ = ["CONTACT_FORCE", "FOLLOWED", "FOLLOWED_AT_ONCE", "STRUCK"]

FOLLOWED = 256
"""Ticks for which a contact is followed after its event: later changes of its force make no sound."""

FOLLOWED_AT_ONCE = 8
"""Contacts followed at the same time; a further one replaces the oldest."""

CONTACT_FORCE = np.dtype(
    [
        ("t_ns", "i8"),  # release time of the tick, as in its events
        ("body_a", "i2"),  # as in EVENT
        ("body_b", "i2"),
        ("force", "f4"),  # [N] between the two, unsigned
    ]
)
"""Force of one contact in one tick, 16 bytes."""

STRUCK = np.dtype(
    [
        ("body_a", "i8"),  # as in EVENT
        ("body_b", "i8"),
        ("left", "i8"),  # remaining ticks
    ],
    align=True,
)
"""One followed contact."""
