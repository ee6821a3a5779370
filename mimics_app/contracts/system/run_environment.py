"""Environment of a run: software versions, the machine, and pairs of wall and monotonic time."""

from __future__ import annotations

import os
import platform
from functools import cache
from pathlib import Path
from typing import Any

from mimics_app.contracts.clock import MonotonicClock, wall_time
from mimics_app.contracts.version import __version__

__all__ = ["boot_id", "clock_pair", "describe_environment"]

_LIBRARIES = ("numpy", "numba", "moderngl", "glfw", "PyOpenAL", "msgspec", "pyarrow", "pyserial", "trimesh")


def clock_pair() -> dict[str, Any]:
    """Return wall time (UTC, ISO 8601) and monotonic time [ns] of one moment, to date a session."""
    return {"utc": wall_time().isoformat(), "monotonic_ns": MonotonicClock().now_ns()}


@cache
def boot_id() -> str:
    """Random number of the machine's present start, "" where the system has none: monotonic times count from it."""
    try:
        return Path("/proc/sys/kernel/random/boot_id").read_text(encoding="ascii").strip()
    except (OSError, ValueError):
        return ""  # not Linux


@cache
def describe_environment() -> dict[str, dict[str, Any]]:
    """Return the `versions` of application and libraries, and the `machine`, without names of persons or hosts."""
    from importlib.metadata import PackageNotFoundError, version

    versions = {"mimics_app": __version__, "python": platform.python_version()}
    for library in _LIBRARIES:
        try:
            versions[library] = version(library)
        except PackageNotFoundError:
            continue
    machine = {
        "system": f"{platform.system()} {platform.release()}",
        "architecture": platform.machine(),
        "processor": _processor(),
        "cores": os.cpu_count(),
        "memory_bytes": _memory(),
    }
    return {"versions": versions, "machine": machine}


def _processor() -> str:
    try:
        for line in Path("/proc/cpuinfo").read_text().splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    except OSError:
        pass  # not Linux
    return platform.processor() or "unknown"


def _memory() -> int | None:
    try:
        return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, ValueError, OSError):
        return None
