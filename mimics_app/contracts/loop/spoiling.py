"""Kinds of faults injected between the loop and a simulated device."""

from __future__ import annotations

from enum import IntEnum

__all__ = ["Spoiling"]


class Spoiling(IntEnum):
    """What the loop does with what passes between it and the device, from the fault's tick on."""

    NOTHING = 0
    SET = 1  # a number of the data is a value
    ADD = 2  # a value is added to it
    ADD_ONCE = 3  # likewise, in one tick
    FREEZE = 4  # it keeps its value
    DROP = 5  # no data arrive
    DROP_SOME = 6  # half of the data do not arrive
    DELAY = 7  # data arrive late
    REPORT = 8  # the device reports a fault
    REFUSE = 9  # the device takes no command
