"""Python's garbage collector, with what is here to stay kept out of it.

A full round over all that imports, compiled code and a scene leave behind takes 0.1 to 0.2 s, and the first seconds of
a session, which make much that is kept, take several: so long no frame is made. What exists when the session begins
lives as long as the session, so it is swept once and then left out of every further round.
"""

from __future__ import annotations

import gc
from collections.abc import Iterator
from contextlib import contextmanager

__all__ = ["left_alone"]


@contextmanager
def left_alone() -> Iterator[None]:
    """While it lasts, what exists at its beginning is not looked through again; what is made in it is, as ever."""
    gc.collect()
    gc.freeze()
    try:
        yield
    finally:
        gc.unfreeze()
