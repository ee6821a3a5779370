"""MIMICS: one shared scene rendered as touch (1 kHz), picture (~60 Hz) and sound (<= 20 ms).

    import mimics_app as mimics

    with mimics.open("wavy_tunnel", seed=7, patient="moderate") as session:
        session.step(2.0)
        session.command(mimics.Pause())
        force = session.state["f_user_world"]
    recording = mimics.load(session.run_dir)

The package imports nothing heavy: numpy, numba, OpenGL and OpenAL come in when a part that needs them does.
"""

__all__ = [
    "Calibrate",
    "Confirm",
    "End",
    "Fault",
    "Mark",
    "Mute",
    "Note",
    "Obstacle",
    "Pause",
    "Policy",
    "Recalibrate",
    "Repeat",
    "Reset",
    "Resume",
    "SetAssistance",
    "SetParameter",
    "Skip",
    "StartTrial",
    "Stop",
    "View",
    "Volume",
    "__version__",
    "errors",
    "load",
    "open",
]  # fmt: skip


def __getattr__(name: str) -> object:
    """Import what the package offers when it is used."""
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    if name == "open":
        from mimics_app.app.api.opened import open

        return open
    if name == "load":
        from mimics_app.app.api.loaded_run import load

        return load
    if name == "__version__":
        from mimics_app.contracts.version import __version__

        return __version__
    if name == "errors":
        from mimics_app.contracts import errors

        return errors
    from mimics_app.contracts.commands import vocabulary

    return getattr(vocabulary, name)
