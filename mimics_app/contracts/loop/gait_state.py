"""States of a walk in a gait orthosis, by the nine steps of D2.1 4.3.6, in events, recordings and on the board."""

from __future__ import annotations

from enum import IntEnum

__all__ = ["GAIT_STATES", "GaitState"]


class GaitState(IntEnum):
    """State of the walk; 0 to 8 are the nine steps of D2.1 4.3.6 in their order."""

    WALKING = 0
    OBSTACLE_ENABLED = 1
    STOPPING = 2
    COLLISION_ENABLED = 3
    LEG_RELEASED = 4
    EXPLORING = 5
    GUIDANCE_RESTORED = 6
    TO_START = 7
    RESUMING = 8
    STANDING = 9  # held by the device's own brakes


GAIT_STATES = tuple(state.name.lower() for state in GaitState)
"""Their names."""
