"""Processes that a session starts without importing the program it is played by."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from types import ModuleType

__all__ = ["main_hidden"]


@contextmanager
def main_hidden() -> Iterator[None]:
    """Start processes whose interpreter does not import `__main__`, which `multiprocessing` does by default.

    Recorder and sound need nothing of it. A script without `if __name__ == "__main__"` would open its scene once more
    in each of them.
    """
    main = sys.modules["__main__"]
    sys.modules["__main__"] = ModuleType("__main__")
    try:
        yield
    finally:
        sys.modules["__main__"] = main
