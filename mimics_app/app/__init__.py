"""The application: the only layer that knows all others.

cli         finds a command of `commands`, which asks the rooms below
play        a run from its first frame to its result, of the `session` it owns
picture     drawing, figures, overlay, films; touch, cues: what is felt, what sounds and effects follow
planner     which method does what; scenes: reading them, and what plays them
bench, devices, sweep, viewer: the rooms of single commands; installation, settings, terminal: what any may need

Imports go down this list only (pyproject.toml).
"""

__all__: list[str] = []
