"""Sound scene for the mixer: the listener's head and every emitter, one record per frame.

The main thread writes it to a triple buffer, and the audio stage reads the newest one; neither waits. World frame, SI
units; the rows of emitters are in the order of the session's sound settings.
"""

from __future__ import annotations

import numpy as np

__all__ = ["BANDS", "MAX_EMITTERS", "SOUND_SCENE", "SOUND_SPEED", "fill_defaults"]

MAX_EMITTERS = 256
"""Largest number of emitters of a scene."""

BANDS = 3
"""Frequency bands of the attenuation by obstacles: below 500 Hz, around 1.4 kHz, above 4 kHz."""

SOUND_SPEED = 343.0
"""Speed of sound in air at 20 degrees C [m/s]."""

SOUND_SCENE = np.dtype(
    [
        ("t_ns", "i8"),  # session time of the poses
        ("head_position", "f8", (3,)),  # [m]
        ("head_velocity", "f8", (3,)),  # [m/s]
        ("head_forward", "f8", (3,)),  # unit vector
        ("head_up", "f8", (3,)),  # unit vector
        ("room_level", "f8"),  # linear level of the reverberation at the head, 0: outdoors
        ("room_time", "f8"),  # reverberation time RT60 [s]
        ("position", "f8", (MAX_EMITTERS, 3)),  # [m]
        ("velocity", "f8", (MAX_EMITTERS, 3)),  # [m/s]
        ("forward", "f8", (MAX_EMITTERS, 3)),  # axis of the cone, unit vector
        ("gain", "f8", (MAX_EMITTERS,)),  # linear; 0: silent
        ("passes", "f8", (MAX_EMITTERS, BANDS)),  # linear transmission through obstacles, by band
    ],
    align=True,
)
"""Listener and emitters of one frame. One writer: the main thread."""


def fill_defaults(record: np.ndarray[tuple[int], np.dtype[np.void]]) -> None:
    """Write defaults: head at the origin looking along -z, no room, silent unobstructed emitters; shape [1]."""
    record[:] = 0
    record["head_forward"], record["head_up"] = (0.0, 0.0, -1.0), (0.0, 1.0, 0.0)
    record["forward"] = (0.0, 0.0, -1.0)
    record["passes"] = 1.0
