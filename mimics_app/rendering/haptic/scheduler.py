"""Real-time scheduling of the haptic thread, and the recipe that was granted.

Measured on two cores beside a software renderer: an ordinary thread misses up to a quarter of its deadlines, one with
SCHED_FIFO and a short spin tail 0.02 %. Where FIFO is refused, the best for an unprivileged user is a timer slack of
1 ns, a short scheduling slice, and a main thread at nice 19 before it creates its GL context (the renderer's workers
inherit that).

All code specific to Linux is in this module; on other systems the recipe is "plain".
"""

from __future__ import annotations

import os
import platform
import struct
import sys
import threading
from dataclasses import dataclass

__all__ = ["RECIPES", "Granted", "arrange_thread", "cores", "demote", "lower_this_thread", "occupy_core", "spin_for"]

RECIPES = ("auto", "fifo", "ordinary", "plain")
"""auto: fifo where allowed, else ordinary. fifo: SCHED_FIFO. ordinary: the best without privileges. plain: default."""

_FIFO_PRIORITY = 50

_HIGHEST_PRIORITY = 99

_RUNAWAY_US = 500_000
"""RLIMIT_RTTIME: processor time of a real-time thread without a sleep before SIGXCPU [us]."""

_PR_SET_TIMERSLACK = 29

_SLICE_NS = 100_000
"""Requested scheduling slice [ns]."""

_SCHED_SETATTR = {"x86_64": 314, "aarch64": 274}
"""Number of the system call by architecture."""

_SPIN_FIFO_US = 60


@dataclass(frozen=True, slots=True)
class Granted:
    """Scheduling that the system granted to the haptic thread.

    Attributes:
        recipe: Name for reports, e.g. "fifo50+slack1ns".
        lower_main: True when the main thread should call `lower_this_thread` before it creates its GL context.
    """

    recipe: str
    lower_main: bool


def spin_for(granted: Granted) -> int:
    """Return the longest spin before a deadline [us]; 0 without FIFO, where spinning only uses up the slice."""
    return _SPIN_FIFO_US if granted.recipe.startswith("fifo") else 0


def arrange_thread(recipe: str = "auto") -> Granted:
    """Schedule the calling thread for the haptic loop; return what was granted.

    Args:
        recipe: One of `RECIPES`.

    Raises:
        ValueError: Unknown recipe.
    """
    if recipe not in RECIPES:
        raise ValueError(f'unknown scheduler recipe "{recipe}"; known: {", ".join(RECIPES)}')
    if recipe == "plain" or not sys.platform.startswith("linux"):
        return Granted("plain", False)
    words = ["slack1ns"] if _set_timer_slack() else []
    if recipe in ("auto", "fifo") and _set_fifo():
        return Granted("+".join([f"fifo{_FIFO_PRIORITY}", *words]), False)
    if _set_slice():
        words.append("slice0.1ms")
    return Granted("+".join(["ordinary", *words]), True)


def lower_this_thread() -> bool:
    """Set the calling thread to nice 19, permanently without privileges; True on success. New threads inherit it."""
    if not sys.platform.startswith("linux"):
        return False
    try:
        os.setpriority(os.PRIO_PROCESS, threading.get_native_id(), 19)
    except OSError:
        return False
    return True


def demote(thread_id: int) -> Granted:
    """Remove SCHED_FIFO from a runaway thread of this process, so that the machine stays usable."""
    os.sched_setscheduler(thread_id, os.SCHED_OTHER | os.SCHED_RESET_ON_FORK, os.sched_param(0))
    return Granted("demoted", False)


def cores() -> list[int]:
    """Return the numbers of the cores this process may use; [] where the system does not tell."""
    return sorted(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else []


def occupy_core(core: int) -> bool:
    """Pin the calling thread to a core, before everything else there; False where the system refuses."""
    if not hasattr(os, "sched_setaffinity"):
        return False
    try:
        os.sched_setaffinity(0, {core})
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(_HIGHEST_PRIORITY))
    except OSError:
        return False
    return True


def _set_fifo() -> bool:
    """Set SCHED_FIFO for this thread, not inherited, with a limit that sends SIGXCPU to a runaway loop."""
    try:
        os.sched_setscheduler(0, os.SCHED_FIFO | os.SCHED_RESET_ON_FORK, os.sched_param(_FIFO_PRIORITY))
    except OSError:
        return False
    _limit_runaway()
    return True


def _limit_runaway() -> None:
    """Set RLIMIT_RTTIME: the kernel sends SIGXCPU to a real-time thread that does not sleep for _RUNAWAY_US.

    At the hard limit it sends SIGKILL, so that the soft limit stays below it.
    """
    import resource

    try:
        _, hard = resource.getrlimit(resource.RLIMIT_RTTIME)
        limit = _RUNAWAY_US if hard == resource.RLIM_INFINITY else min(_RUNAWAY_US, hard // 2)
        resource.setrlimit(resource.RLIMIT_RTTIME, (limit, hard))
    except (AttributeError, ValueError, OSError):
        return


def _set_timer_slack() -> bool:
    """Set the timer slack of this thread to 1 ns; the default of 50 us is added to every sleep."""
    import ctypes

    return bool(ctypes.CDLL(None).prctl(_PR_SET_TIMERSLACK, 1, 0, 0, 0) == 0)


def _set_slice() -> bool:
    """Request slices of 0.1 ms from the fair scheduler: EEVDF picks a waking thread with a short slice sooner."""
    import ctypes

    number = _SCHED_SETATTR.get(platform.machine())
    if number is None:
        return False
    nice = os.getpriority(os.PRIO_PROCESS, threading.get_native_id())
    attributes = struct.pack("<IIQiIQQQ", 48, 0, 0, nice, 0, _SLICE_NS, 0, 0)
    return bool(ctypes.CDLL(None).syscall(number, 0, ctypes.create_string_buffer(attributes), 0) == 0)
