"""Records of the rings of commands, and the sources that have one."""

from __future__ import annotations

from enum import IntEnum

import numpy as np

__all__ = ["ANSWER", "COMMAND", "LONGEST_COMMAND", "LONGEST_WHO", "LONGEST_WHY", "CommandSource"]


class CommandSource(IntEnum):
    """Sources of commands; each has its own ring and its own stop word, with one writer."""

    KEYS = 0
    GAMEPAD = 1
    BUTTON = 2  # of the device
    FILE = 3
    PYTHON = 4
    OPERATOR = 5
    LSL = 6
    STOP_BUTTON = 7  # of the operator's page, from a process of its own
    ATTENDANCE = 8  # the session itself, when its operator is lost


LONGEST_COMMAND, LONGEST_WHO, LONGEST_WHY = 512, 32, 256
"""Lengths of the texts below [bytes]."""

COMMAND = np.dtype(
    [("sequence", np.int64), ("t_ns", np.int64), ("who", f"S{LONGEST_WHO}"), ("written", f"S{LONGEST_COMMAND}")]
)
"""One command of a source: its number from 0, when it was given [ns], by whom, and itself as JSON."""

ANSWER = np.dtype(
    [("sequence", np.int64), ("frame", np.int64), ("tick", np.int64), ("done", np.int8), ("why", f"S{LONGEST_WHY}")]
)
"""Answer to the command of a number: frame and tick of its effect, whether it was done, and why not."""
