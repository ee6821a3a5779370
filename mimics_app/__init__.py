"""MIMICS: one shared scene rendered as touch (1 kHz), picture (~60 Hz) and sound (<= 20 ms).

    import mimics_app as mimics

    with mimics.open("wavy_tunnel", seed=7, patient="moderate") as session:
        session.step(2.0)
        force = session.state["f_user_world"]
    recording = mimics.load(session.run_dir)

The package imports nothing heavy: numpy, numba, OpenGL and OpenAL come in when a part that needs them does.
"""

from importlib import import_module
from typing import Any

__all__ = ["__version__", "errors", "load", "open"]

__version__ = "0.1.0"

_PUBLIC = {
    "open": "mimics_app.app.api.opened:open_scene",
    "load": "mimics_app.app.api.recording:load",
    "errors": "mimics_app.contracts.errors",
}
"""Public names, imported when they are used."""


def __getattr__(name: str) -> Any:
    if name not in _PUBLIC:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    module, _, member = _PUBLIC[name].partition(":")
    found = import_module(module)
    return getattr(found, member) if member else found
