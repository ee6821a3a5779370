"""MIMICS: one shared scene rendered as touch (1 kHz), picture (~60 Hz) and sound (<= 20 ms).

    import mimics_app as mimics

    with mimics.open("wavy_tunnel", seed=7, patient="moderate") as session:
        session.step(2.0)
        session.command(mimics.Pause())
        force = session.state["f_user_world"]
    recording = mimics.load(session.run_dir)

The package imports nothing heavy: numpy, numba, OpenGL and OpenAL come in when a part that needs them does.
"""

from importlib import import_module

_COMMANDS = (
    "Calibrate", "Confirm", "End", "Fault", "Mark", "Mute", "Note", "Obstacle", "Pause", "Policy", "Recalibrate",
    "Repeat", "Reset", "Resume", "SetAssistance", "SetParameter", "Skip", "StartTrial", "Stop", "View", "Volume",
)  # fmt: skip
_HOMES = {
    "open": "app.api.opened",
    "load": "app.api.loaded_run",
    "__version__": "contracts.version",
    "errors": "contracts",
    **dict.fromkeys(_COMMANDS, "contracts.commands.vocabulary"),
}
"""Module of each name that the package offers."""

__all__ = ["__version__", "errors", "load", "open", *_COMMANDS]


def __getattr__(name: str) -> object:
    """Import what the package offers when it is used."""
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    if name == "errors":
        return import_module("mimics_app.contracts.errors")
    return getattr(import_module(f"mimics_app.{_HOMES[name]}"), name)
