"""Newest numbers of the 1 kHz loop as binary messages: values, and the extremes since the last message."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.shared_memory.ring_history import RingHistory
from mimics_app.contracts.shared_memory.session_memory import ControlWord, SessionMemory

__all__ = [
    "EXTREMES",
    "HEADER_BYTES",
    "MIRROR",
    "PICTURE",
    "SECOND_PICTURE",
    "SIGNALS",
    "TELEMETRY",
    "VALUES",
    "Telemetry",
    "message",
]

TELEMETRY, PICTURE, SIGNALS, SECOND_PICTURE, MIRROR = 1, 2, 3, 4, 5
"""Kinds of binary messages, their first word."""

HEADER_BYTES = 8
"""Length of what precedes the content of a binary message."""

_SCALARS = (
    "progress", "distance", "tunnel_radius", "penetration", "touching", "depth", "margin", "stiffness_share", "calm",
    "energy", "ramp", "state", "cause",
)  # fmt: skip
_VECTORS = ("hip_world",)
_LENGTHS = {"force": "f_user_world", "force_measured": "f_meas", "speed": "v_world"}
"""Names of lengths of vectors, and the vectors."""

EXTREMES = ("force", "force_measured", "speed", "distance", "lateness_us")
"""Values whose smallest and largest since the last message are sent too: a peak of one tick is drawn."""

VALUES = (
    "t_s", "ticks", "missed", "held", "stops", "holds",
    *_SCALARS, "x", "y", "z", *_LENGTHS, "lateness_us", "duration_us",
    *(f"{name}_{end}" for name in EXTREMES for end in ("low", "high")),
)  # fmt: skip
"""Names of the numbers of a message, in their order."""

_CONTROL = (ControlWord.TICKS, ControlWord.MISSED, ControlWord.HELD, ControlWord.STOPS, ControlWord.HOLDS)


def message(kind: int, content: bytes) -> bytes:
    """Return a binary message: its kind and a reserved word, four bytes each, then the content."""
    return np.array([kind, 0], "<u4").tobytes() + content


class Telemetry:
    """Reads the samples of a session beside its recorder.

    Args:
        memory: The shared memory.
    """

    def __init__(self, memory: SessionMemory) -> None:
        self._control = memory.control
        self._samples = RingHistory(memory.sample_words, memory.samples)
        self._values = np.zeros(len(VALUES))

    def newest(self) -> bytes | None:
        """Return the message of the ticks since the last call; None where there were none."""
        samples = self._samples.take()
        if not len(samples):
            return None
        series = {name: np.linalg.norm(samples[vector], axis=1) for name, vector in _LENGTHS.items()}
        series |= {"distance": samples["distance"], "lateness_us": samples["lateness_ns"] * 1e-3}
        last = samples[-1]
        values = [
            float(last["t"]),
            *(float(self._control[word]) for word in _CONTROL),
            *(float(last[name]) for name in _SCALARS),
            *(float(each) for name in _VECTORS for each in last[name]),
            *(float(series[name][-1]) for name in _LENGTHS),
            float(series["lateness_us"][-1]),
            float(last["duration_ns"]) * 1e-3,
            *_extremes(series),
        ]
        self._values[:] = values
        return message(TELEMETRY, self._values.astype("<f8").tobytes())


def _extremes(series: dict[str, NDArray[Any]]) -> list[float]:
    return [float(end(series[name])) for name in EXTREMES for end in (np.min, np.max)]
