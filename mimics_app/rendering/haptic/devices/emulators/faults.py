"""Faults that an emulated robot injects on command."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field

import numpy as np

from mimics_app.contracts.errors import UsageError, require_choice

__all__ = ["Faults", "apply_order"]


@dataclass(slots=True)
class Faults:
    """Faults of a line; all off by default.

    Attributes:
        silence: The line stays open, but nothing is sent.
        garbage: Random bytes inserted per millisecond.
        drop: Share of the sent bytes that are lost.
        deaf: The robot sends, but receives nothing.
        late: Milliseconds by which all that is sent comes later.
        plugged: False: the line is unplugged.
    """

    silence: bool = False
    garbage: int = 0
    drop: float = 0.0
    deaf: bool = False
    late: int = 0
    plugged: bool = True
    _under_way: deque[bytes] = field(default_factory=deque)

    def spoil(self, sent: bytes, random: np.random.Generator) -> bytes:
        """Return the bytes that arrive of those sent in one millisecond."""
        self._under_way.append(sent)
        sent = b"".join(self._under_way.popleft() for _ in range(len(self._under_way) - self.late))
        if self.silence:
            return b""
        if self.drop > 0.0:
            kept = random.random(len(sent)) >= self.drop
            sent = bytes(byte for byte, keep in zip(sent, kept, strict=True) if keep)
        return sent + random.integers(0, 256, self.garbage, np.uint8).tobytes() if self.garbage else sent


_ORDERS = {
    "silence": "silence [off]",
    "garbage": "garbage BYTES_PER_MS",
    "drop": "drop SHARE",
    "deaf": "deaf [off]",
    "late": "late MS",
    "unplug": "unplug",
    "plug": "plug",
}


def apply_order(faults: Faults, line: str) -> None:
    """Change the faults by a line of text.

    `silence [off]`, `garbage BYTES_PER_MS`, `drop SHARE`, `deaf [off]`, `late MS`, `unplug`,
    `plug`.

    Raises:
        UsageError: Unknown order, or an invalid number.
    """
    word, _, value = line.strip().partition(" ")
    require_choice(word, _ORDERS, "order")
    try:
        if word == "garbage":
            faults.garbage = min(1000, max(0, int(value)))
        elif word == "late":
            faults.late = min(1000, max(0, int(value)))
        elif word == "drop":
            faults.drop = min(1.0, max(0.0, float(value)))
    except ValueError:
        raise UsageError(f'"{value}" is not a number', f"write {_ORDERS[word]}") from None
    if word == "silence":
        faults.silence = value != "off"
    elif word == "deaf":
        faults.deaf = value != "off"
    elif word in ("unplug", "plug"):
        faults.plugged = word == "plug"
