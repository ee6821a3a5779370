"""Kinds of hard object that the controllers of the gait orthosis render at a foot."""

from __future__ import annotations

from enum import IntEnum

__all__ = ["HardObject"]


class HardObject(IntEnum):
    """Kind of the hard object, as the parameter `object_kind` says; placed in the robot's frame."""

    NONE = 0
    WALL = 1  # vertical, at object[0], facing back
    BOX = 2
    KERB = 3  # upper edge at object[0], object[1]
    ROUND = 4  # of the diameter size[0]
    STREET = 5  # the StreetObject that is called, from object[0] on, on the ground at object[1]
    MESH = 6  # any polygon: outline_x, outline_z are its corners
