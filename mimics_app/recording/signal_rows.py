"""Body signals as messages from the application to the recorder, without Arrow."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import msgspec
import numpy as np

from mimics_app.contracts.messages.stage_messages import SignalBlock

__all__ = ["SignalRow", "pack_signals", "unpack_signals"]

_Sent = tuple[int, int, str, float, bytes]


@dataclass(frozen=True, slots=True)
class SignalRow:
    """One block of a signal, and the number of the frame that received it."""

    frame: int
    block: SignalBlock


def pack_signals(rows: Sequence[SignalRow]) -> bytes:
    """Encode rows for the recorder's channel."""
    return msgspec.msgpack.encode(
        [
            (row.frame, row.block.t_ns, row.block.name, row.block.rate, np.asarray(row.block.values, float).tobytes())
            for row in rows
        ]
    )


def unpack_signals(payload: bytes) -> list[_Sent]:
    """Return frame, time, name, rate and samples of each row.

    Raises:
        ValueError: The bytes are not of `pack_signals`.
    """
    try:
        return msgspec.msgpack.decode(payload, type=list[_Sent])
    except (msgspec.DecodeError, msgspec.ValidationError) as error:
        raise ValueError(f"no rows of signals: {error}") from error
