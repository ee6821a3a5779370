"""What the mixer hears of the world: the listener's head and every emitter, one record a frame.

Written by the main thread into a triple buffer and read by the audio stage: nothing waits, the newest one counts. World
frame, SI units; the rows of emitters are in the order of the session's sound settings.
"""

from __future__ import annotations

import numpy as np

__all__ = ["BANDS", "MAX_EMITTERS", "SOUND_SCENE", "fill_defaults"]

MAX_EMITTERS = 256
"""Most emitters of one scene."""

BANDS = 3
"""Bands in which the path from an emitter dampens: below 500 Hz, around 1.4 kHz, above 4 kHz."""

SOUND_SCENE = np.dtype(
    [
        ("t_ns", "i8"),  # session time the poses are of
        ("head_position", "f8", (3,)),  # [m]
        ("head_velocity", "f8", (3,)),  # [m/s]
        ("head_forward", "f8", (3,)),  # unit vector
        ("head_up", "f8", (3,)),  # unit vector
        ("room_level", "f8"),  # linear level of the reverberation where the head is, 0: outdoors
        ("room_time", "f8"),  # [s] in which it falls by 60 dB
        ("position", "f8", (MAX_EMITTERS, 3)),  # [m]
        ("velocity", "f8", (MAX_EMITTERS, 3)),  # [m/s]
        ("forward", "f8", (MAX_EMITTERS, 3)),  # axis of the cone, unit vector
        ("gain", "f8", (MAX_EMITTERS,)),  # linear; 0: silent
        ("passes", "f8", (MAX_EMITTERS, BANDS)),  # linear share that obstacles let through, by band
    ],
    align=True,
)
"""One writer: the main thread."""


def fill_defaults(record: np.ndarray[tuple[int], np.dtype[np.void]]) -> None:
    """Head at the origin looking along -z, no room, silent emitters with a free path; `record` has shape [1]."""
    record[:] = 0
    record["head_forward"], record["head_up"] = (0.0, 0.0, -1.0), (0.0, 1.0, 0.0)
    record["forward"] = (0.0, 0.0, -1.0)
    record["passes"] = 1.0
