"""`mimics explain SCENE`: what it runs, by which methods at which cost and error, and what it leaves out."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mimics_app.app.settings import PROFILES

if TYPE_CHECKING:
    from mimics_app.app.planner.plan import Plan

__all__ = ["add_arguments", "run"]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of `mimics explain`."""
    parser.add_argument("scene", type=Path, help="scene file")
    parser.add_argument("--profile", choices=PROFILES, default="training", help="whose tolerances hold")


def run(args: argparse.Namespace) -> int:
    """Plan the scene as a run of it would, and say what was taken and why."""
    from mimics_app.app.picture.shadow_cost import measure_shadow_us
    from mimics_app.app.planner.explain import explain_plan
    from mimics_app.app.planner.plan import plan_scene
    from mimics_app.app.scenes.loading import load_checked_scene
    from mimics_app.app.terminal import output

    scene = load_checked_scene(args.scene)
    plan = plan_scene(scene, args.profile)
    answer = explain_plan(scene, plan, lambda: measure_shadow_us(scene))
    if args.json:
        output.write_object("explain", answer)
    else:
        _say(answer, plan)
    return 0


def _say(answer: dict[str, Any], plan: Plan) -> None:
    where = "measured on this machine" if plan.origin == "saved" else f"the {plan.origin} table"
    print(f"profile {plan.profile}; costs by {where} ({answer['table']['machine'].get('processor', '')})")
    limits = ", ".join(f"{name} {value:g}" for name, value in plan.tolerances.items())
    print(f"accepts {limits}\n")
    overruled = {choice.group: choice.planner.method for choice in plan.choices if choice.planner is not None}
    for part in answer["parts"]:
        error = _error_of(part)
        print(f"runs      {part['part']}: {part['method']}, {part['cost_us']:.3f} us{error}")
        if part["group"] in overruled:
            print(f"          the scene names it; the planner would take {overruled[part['group']]}")
        refused = part["next_cheaper"]
        if refused:
            print(f"          cheaper but refused: {refused['method']}, error {refused['error']:.2g} {part['unit']}")
    for left in answer["left_out"]:
        saved = "" if left["saved_us"] is None else f" ({left['saved_us']:.3f} us saved)"
        print(f"left out  {left['part']}: {left['why']}{saved}")


def _error_of(part: dict[str, Any]) -> str:
    if part["error"] is None:
        return ""
    within = "of" if part["error"] <= part["tolerance"] else "beyond"
    return f", error {part['error']:.2g} {within} {part['tolerance']:.2g} {part['unit']}"
