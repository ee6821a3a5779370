"""The wait of the audio process: a compiled sleep until the haptic loop has published an event."""

from __future__ import annotations

from mimics_app.compiled.atomics import now_ns, sleep_until_ns
from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Words
from mimics_app.contracts.shared_memory.ring import waiting

__all__ = ["wait_for_records"]


@kernel
def wait_for_records(words: Words, timespec: Words, deadline_ns: int, step_ns: int) -> bool:
    """Poll a ring every `step_ns` until it holds a record (True) or the deadline has passed (False)."""
    while waiting(words) == 0:
        now = now_ns(timespec)
        if now >= deadline_ns:
            return False
        sleep_until_ns(timespec, min(now + step_ns, deadline_ns))
    return True
