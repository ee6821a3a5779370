"""Examples below each command's --help, in a block that is not wrapped."""

from __future__ import annotations

import argparse

__all__ = ["EXAMPLES", "HelpFormatter", "examples_of"]

EXAMPLES: dict[str, tuple[tuple[str, str], ...]] = {
    "run": (
        ("mimics run wavy_tunnel", "in a window, with the mouse"),
        ("mimics run wavy_tunnel --headless --patient moderate --seconds 20", "without a window"),
        ("mimics run tower --device serial:/dev/ttyUSB0 --participant P07", "with a robot"),
    ),
    "render": (
        ("mimics render city_walk --camera main_street --output pictures", "one picture"),
        ("mimics render wavy_tunnel --seconds 10 --video tunnel.mp4", "a film"),
    ),
    "scenes": (("mimics run free_objects", "each name is found from any folder"),),
    "view": (
        ("mimics view pick_and_place", "a scene, in a window"),
        ("mimics view model.glb --output model.png", "a picture of a model"),
    ),
    "avatar": (("mimics avatar import person.glb", "which joints are known"),),
    "check": (("mimics check my_scene.json", "all errors at once, with line and column"),),
    "schema": (("mimics schema --out scene.schema.json", "for an editor that completes JSON"),),
    "explain": (("mimics explain wavy_tunnel --profile study", "what would run"),),
    "config": (("mimics config wavy_tunnel --profile study", "limits, options and tolerances with their origin"),),
    "doctor": (("mimics doctor", "what is there, what is missing"),),
    "devices": (
        ("mimics devices", "what a scene can run on"),
        ("mimics devices check simulated_hapticmaster", "the conformance kit"),
        ("mimics devices emulate serial", "a robot that is not there"),
    ),
    "replay": (("mimics replay runs/RUN", "every output compared, bit for bit"),),
    "report": (("mimics report runs/RUN", "writes runs/RUN/report.html"),),
    "physio": (("mimics physio sim:severe --seconds 120 --page signals.html", "a simulated person"),),
    "record": (("mimics record recover runs/RUN", "after a crash or a power failure"),),
    "study": (("mimics study avatar_cord --subjects 2 --seconds 300 --out study", "tables in ./study"),),
    "sweep": (("mimics sweep --list", "experiments"), ("mimics sweep my_sweep.json --workers 2", "run one")),
    "bench": (("mimics bench haptic", "one tick beside rivals"),),
    "lab": (
        ('mimics lab chart "tunnel projection"', "cost against error, into ./charts"),
        ("mimics lab stability S3 --points 12", "where a wall gets unstable"),
    ),
    "assets": (
        ("mimics assets list", "what can be built"),
        ("mimics assets levels model.glb --out models", "levels of detail for a model"),
    ),
}
"""Command lines and their meaning, by command."""


def examples_of(command: str) -> str:
    """Return the examples of a command as lines of text; "" where it has none."""
    rows = EXAMPLES.get(command, ())
    if not rows:
        return ""
    wide = max(len(typed) for typed, _ in rows)
    return "\n".join(["examples:", *(f"  {typed:{wide}}  {what}" for typed, what in rows)])


class HelpFormatter(argparse.ArgumentDefaultsHelpFormatter):
    """Formatter that shows defaults other than None, False and "", and does not wrap the examples."""

    def _get_help_string(self, action: argparse.Action) -> str | None:
        return action.help if action.default in (None, False, "") else super()._get_help_string(action)

    def _fill_text(self, text: str, width: int, indent: str) -> str:
        wrapped, _, examples = text.partition("examples:\n")
        parts = [super()._fill_text(wrapped, width, indent)] if wrapped.strip() else []
        return "\n\n".join([*parts, *([f"examples:\n{examples}"] if examples else [])])
