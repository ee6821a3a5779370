"""Programs of a test that end with it, also when it is killed."""

from __future__ import annotations

import os
import signal
import sys

__all__ = ["ending_with_parent"]

_PARENT_DEATH_SIGNAL = 1
"""Of prctl(2)."""
_BEGIN = f"""
import ctypes, os, sys
ctypes.CDLL(None).prctl({_PARENT_DEATH_SIGNAL}, {int(signal.SIGTERM)}, 0, 0, 0)
if os.getppid() != int(sys.argv[1]):
    sys.exit("the test was gone before its program began")
os.execv(sys.argv[2], sys.argv[2:])
"""


def ending_with_parent(*words: str) -> list[str]:
    """Return the command of this Python with arguments, to which the kernel sends SIGTERM when its parent is gone."""
    return [sys.executable, "-c", _BEGIN, str(os.getpid()), sys.executable, *words]
