"""What an emulated robot does wrong, on command."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mimics_app.contracts.errors import UsageError, nearest

__all__ = ["Faults", "apply_order"]


@dataclass(slots=True)
class Faults:
    """The faults of a line; all off.

    Attributes:
        silence: The line stays open, nothing is sent.
        garbage: Random bytes put between frames, per millisecond.
        drop: Share of the bytes that are lost on the way out.
        deaf: The robot speaks and hears nothing.
        plugged: False pulls the plug.
    """

    silence: bool = False
    garbage: int = 0
    drop: float = 0.0
    deaf: bool = False
    plugged: bool = True

    def spoil(self, sent: bytes, random: np.random.Generator) -> bytes:
        """What arrives of the bytes of one millisecond."""
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
    "unplug": "unplug",
    "plug": "plug",
}


def apply_order(faults: Faults, line: str) -> None:
    """Change the faults as a line of text says.

    `silence [off]`, `garbage BYTES_PER_MS`, `drop SHARE`, `deaf [off]`, `unplug`, `plug`.

    Raises:
        UsageError: No such order, or its number is wrong.
    """
    word, _, value = line.strip().partition(" ")
    if word not in _ORDERS:
        raise UsageError(f'there is no order "{word}"', nearest(word, _ORDERS))
    try:
        if word == "garbage":
            faults.garbage = min(1000, max(0, int(value)))
        elif word == "drop":
            faults.drop = min(1.0, max(0.0, float(value)))
    except ValueError:
        raise UsageError(f'"{value}" is no number', f"write {_ORDERS[word]}") from None
    if word == "silence":
        faults.silence = value != "off"
    elif word == "deaf":
        faults.deaf = value != "off"
    elif word in ("unplug", "plug"):
        faults.plugged = word == "plug"
