"""The force of a contact, tick by tick, from the haptic loop to the sound: what strikes a thing is what it answers to.

The loop follows a contact from its event on for `FOLLOWED` ticks and writes one record a tick into a ring. The first
tick's force stands in the event itself.
"""

from __future__ import annotations

import numpy as np

__all__ = ["CONTACT_FORCE", "FOLLOWED", "FOLLOWED_AT_ONCE", "STRUCK"]

FOLLOWED = 256
"""Ticks after its event in which a contact is followed: what changes later than in a quarter of a second makes no
sound of its own."""

FOLLOWED_AT_ONCE = 8
"""Contacts followed at once; a further one takes the place of the oldest."""

CONTACT_FORCE = np.dtype(
    [
        ("t_ns", "i8"),  # when the tick was released, as of its events
        ("body_a", "i2"),  # as EVENT has them
        ("body_b", "i2"),
        ("force", "f4"),  # [N] between the two, without a sign
    ]
)
"""Force of one contact in one tick, 16 bytes."""

STRUCK = np.dtype(
    [
        ("body_a", "i8"),  # as EVENT has them: 0 is the hand, -1 the static scene
        ("body_b", "i8"),
        ("left", "i8"),  # ticks in which it is still followed
    ],
    align=True,
)
"""One contact that the loop follows."""
