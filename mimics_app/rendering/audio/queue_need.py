"""Length of the live queue that this machine's last sessions needed; the next session's is never shorter.

A stall that comes every minute is seen in no start of a session: without this, each session would learn of it by a gap.
"""

from __future__ import annotations

import statistics
from typing import Annotated

import msgspec

from mimics_app.contracts.ports.audio_port import QueueReport
from mimics_app.contracts.system.machine_memory import MachineMemory, machine_file

__all__ = ["QueueNeed", "keep_needed_ms", "known_needed_ms"]

_SESSIONS = 5
"""Number of sessions that count: of most of them, not of a single busy one, is the length taken."""

_LONGEST_MS = 10_000.0
"""Need above which a file is damaged: no queue is so long [ms]."""

_NAME = "live"


class QueueNeed(msgspec.Struct, frozen=True):
    """Needs of the last sessions, oldest first [ms]."""

    ms: tuple[Annotated[float, msgspec.Meta(ge=0.0, le=_LONGEST_MS)], ...] = ()


def known_needed_ms(memory: MachineMemory[QueueNeed] | None = None) -> float:
    """Return the median need of the last sessions, the longer of two [ms]; 0 where none is known.

    Args:
        memory: None: that of this machine.
    """
    known = (memory or _of_machine()).find(_NAME)
    return statistics.median_high(known.ms) if known is not None and known.ms else 0.0


def keep_needed_ms(queue: QueueReport, memory: MachineMemory[QueueNeed] | None = None) -> None:
    """Keep the need of a session; one that says none, as it was too short, changes nothing.

    Args:
        queue: Report of its queue.
        memory: None: that of this machine.
    """
    needed = queue.get("needed_ms")
    if needed is None:
        return
    memory = memory or _of_machine()
    known = memory.find(_NAME) or QueueNeed()
    memory.keep(_NAME, QueueNeed((*known.ms, needed)[-_SESSIONS:]))


def _of_machine() -> MachineMemory[QueueNeed]:
    return MachineMemory(QueueNeed, machine_file("sound"))
