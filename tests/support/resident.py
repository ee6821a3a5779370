"""Memory of a process."""

from __future__ import annotations

import os
from pathlib import Path


def resident_mb(process: int | str = "self") -> float:
    """Memory that a process holds [MB]."""
    pages = int(Path(f"/proc/{process}/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 2**20
