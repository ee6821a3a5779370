"""Steering of a walk by the head: whoever looks aside turns, or leans, that way; a small angle counts as none."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from mimics_app.contracts.errors import Issue
from mimics_app.contracts.messages.head_place import HeadPlace
from mimics_app.world.components.trackers import TrackersSettings

if TYPE_CHECKING:
    from mimics_app.world.files.scene.scene import Scene

__all__ = ["check_head_tracked", "head_aside"]

_STRAIGHT, _FULL = math.radians(6.0), math.radians(30.0)
"""Angles of the head up to which nobody turns, and from which they turn fully [rad]."""


def head_aside(head: HeadPlace | None) -> float:
    """Return how far a head is turned to the right, -1 to 1; 0 for one that is not tracked."""
    if head is None:
        return 0.0
    beyond = min(max(abs(head.yaw) - _STRAIGHT, 0.0) / (_FULL - _STRAIGHT), 1.0)
    return math.copysign(beyond, -head.yaw)


def check_head_tracked(scene: Scene, pointer: str) -> list[Issue]:
    """Return a fault at a pointer that needs a tracked head, where the scene tracks none."""
    trackers = scene.system(TrackersSettings)
    roles = [role for each in trackers.devices for role in each.roles.values()] if trackers is not None else []
    if "head" in roles:
        return []
    return [scene.issue(pointer, "no tracker reports a head", 'give one of "systems.trackers" the role "head"')]
