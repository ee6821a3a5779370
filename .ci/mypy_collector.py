"""Plugin of mypy that lets Python's garbage collector look through its objects a twentieth as often.

mypy makes some ten million objects, of which few are rubbish: half of its processor time was the search for them. With
this threshold it has 1.0 GB at most instead of 0.6.
"""

from __future__ import annotations

import gc

from mypy.plugin import Plugin

_OBJECTS = 4_000_000


def plugin(version: str) -> type[Plugin]:
    """Return a plugin that changes nothing of the types; mypy has set its own threshold before it asks for it."""
    gc.set_threshold(_OBJECTS, 30, 30)
    return Plugin
