"""The application, the only layer that imports all others.

cli             finds a command of `commands`, which uses the packages below
bench, devices, physio, study, sweep, viewer: packages of single commands
play            a run from its first frame to its result; the launcher's contents
session         objects of one run: haptic loop, scenario, stages of D2.1 Figure 1, recorder, sound
picture         drawing, board, overlay, videos, frame governor
touch, cues     haptic objects and parameters; sounds and effects that follow events
planner         choice of methods; scenes: reading and checking of scenes, and their scenarios
installation, settings, terminal: used by any of them

Imports go down this list only (pyproject.toml).
"""

__all__: list[str] = []
