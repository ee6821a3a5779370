"""Exclusion of permanent objects from Python's garbage collection during a session.

A full collection over the objects of imports, compiled code and a scene takes 0.1 to 0.2 s, in which no frame is drawn,
and the first seconds of a session would have several. Objects that exist at its beginning live as long as the session,
so they are collected once and then excluded. New ones are collected in small numbers, which takes some 10 ms each time.
"""

from __future__ import annotations

import gc
from collections.abc import Iterator
from contextlib import contextmanager

__all__ = ["frozen_objects"]

_YOUNG_OBJECTS = 50_000
"""Threshold of the youngest generation during a session [objects]."""


@contextmanager
def frozen_objects() -> Iterator[None]:
    """Exclude the objects that exist now from collections inside the context; later ones are collected, in turn."""
    gc.collect()
    gc.freeze()
    usual = gc.get_threshold()
    gc.set_threshold(_YOUNG_OBJECTS)
    try:
        yield
    finally:
        gc.set_threshold(*usual)
        gc.unfreeze()
