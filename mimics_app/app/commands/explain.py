"""`mimics explain SCENE`: what it runs, by which methods at which measured cost and error, and what it leaves out."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from mimics_app.app.settings import PROFILES

__all__ = ["add_arguments", "run"]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of `mimics explain`."""
    parser.add_argument("scene", type=Path, help="scene file")
    parser.add_argument("--profile", choices=PROFILES, default="training", help="whose tolerances hold")


def run(args: argparse.Namespace) -> int:
    """Measure the rivals here and now, and say which are taken."""
    from mimics_app.app import output
    from mimics_app.app.plan import explain_scene
    from mimics_app.app.scene_loading import load_checked_scene

    answer = explain_scene(load_checked_scene(args.scene), args.profile)
    if args.json:
        output.write_object("explain", answer)
    else:
        _say(answer)
    return 0


def _say(answer: dict[str, Any]) -> None:
    print(f"profile {answer['profile']}; costs measured on this machine now\n")
    for part in answer["parts"]:
        error = (
            "" if part["error"] is None else f", error {part['error']:.2g} of {part['tolerance']:.2g} {part['unit']}"
        )
        print(f"runs      {part['part']}: {part['method']}, {part['cost_us']:.3f} us{error}")
        if part["planner"]:
            print(f"          the scene names it; the planner would take {part['planner']}")
        refused = part["next_cheaper"]
        if refused:
            print(f"          cheaper but refused: {refused['method']}, error {refused['error']:.2g} {part['unit']}")
    for left in answer["left_out"]:
        saved = "" if left["saved_us"] is None else f" ({left['saved_us']:.3f} us saved)"
        print(f"left out  {left['part']}: {left['why']}{saved}")
