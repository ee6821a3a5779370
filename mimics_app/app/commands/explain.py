"""`mimics explain SCENE`: print the parts a scene runs, their methods, costs and errors, and the parts left out."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mimics_app.app.terminal.arguments import add_profile_argument, add_size_argument
from mimics_app.app.terminal.output import answer

if TYPE_CHECKING:
    from mimics_app.app.planner.plan import Plan

__all__ = ["add_arguments", "run"]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of `mimics explain`."""
    parser.add_argument("scene", type=Path, help="scene file")
    add_profile_argument(parser, "profile whose tolerances apply")
    add_size_argument(parser, "size of the live picture, for its cost without a graphics card [px]")
    parser.add_argument(
        "--still", action="store_true", help="plan still pictures, without a frame time to hold, as mimics render does"
    )


def run(args: argparse.Namespace) -> int:
    """Plan the scene as a run would, and print what was chosen and why."""
    from mimics_app.app.scenes.scene_search import find_scene

    find_scene(args.scene)
    from mimics_app.app.scenes.loading import load_checked_scene

    scene = load_checked_scene(args.scene)  # before graphics and the method table are imported
    from mimics_app.app.picture.shadow_cost import measure_shadow_us
    from mimics_app.app.planner.explain import explain_plan
    from mimics_app.app.planner.plan import plan_scene

    plan = plan_scene(scene, args.profile, pixels=0 if args.still else args.size[0] * args.size[1])
    explained = explain_plan(scene, plan, lambda: measure_shadow_us(scene))
    answer(args, explained, _lines(explained, plan))
    return 0


def _of_machine(machine: dict[str, Any]) -> Iterator[str]:
    if "cores" in machine:
        yield f"{machine['cores']} cores"
    yield from (str(machine[name]) for name in ("architecture", "software") if name in machine)


def _lines(explained: dict[str, Any], plan: Plan) -> Iterator[str]:
    where = "measured on this machine" if plan.origin == "saved" else f"the {plan.origin} method table"
    yield f"profile {plan.profile}; costs by {where} ({', '.join(_of_machine(explained['table']['machine']))})"
    yield "accepts " + ", ".join(f"{name} {value:g}" for name, value in plan.tolerances.items())
    if plan.pixels:
        yield f"live picture of {plan.pixels / 1e6:.3g} million pixels, drawn without a graphics card"
    yield ""
    overruled = {choice.group: choice.planner.method for choice in plan.choices if choice.planner is not None}
    for part in explained["parts"]:
        yield f"runs      {part['part']}: {part['method']}, {_cost_of(part)}{_whole_of(part)}{_error_of(part)}"
        if part["note"]:
            yield f"          {part['note']}"
        if part["group"] in overruled:
            yield f"          the scene names it; the planner would take {overruled[part['group']]}"
        refused = part.get("next_cheaper")
        if refused:
            yield f"          cheaper but refused: {refused['method']}, error {refused['error']:.2g} {part['unit']}"
        if "too_dear" in part:
            yield f"          better but too costly: {_too_dear(part['too_dear'], part['unit'])}"
    costs = [part["tick_us"] for part in explained["parts"] if "tick_us" in part]
    if costs:
        yield f"in all    a tick of the haptic loop, bodies at rest: {_time_of(sum(costs))}"
    for left in explained["left_out"]:
        saved = f" ({_time_of(left['saved_us'])} saved)" if "saved_us" in left else ""
        yield f"not used  {left['part']}: {left['why']}{saved}"


def _cost_of(part: dict[str, Any]) -> str:
    """Return the cost of a part; of a refinement of the picture, the added time per frame."""
    if "cost_us" not in part:
        return "not in the table"
    more = part.get("more_ms")
    return _time_of(part["cost_us"]) if more is None else f"{more:.3g} ms a frame more than the cheapest"


def _whole_of(part: dict[str, Any]) -> str:
    """Return the part whose cost includes this one, or the cost per tick of all its instances."""
    if part["within"]:
        return f" (part of: {part['within']})"
    paid = part.get("tick_us")
    return f" each, {_time_of(paid)} a tick" if paid is not None and paid > part["cost_us"] else ""


def _time_of(us: float) -> str:
    return f"{us:.3f} us" if us < 1000.0 else f"{1e-3 * us:.3g} ms"


def _too_dear(costlier: dict[str, Any], unit: str) -> str:
    more, room = costlier["more_ms"], costlier["room_ms"]
    return (
        f"{costlier['method']}, error {costlier['error']:.2g} {unit}: {more:.3g} ms a frame more, of {room:.3g} ms left"
    )


def _error_of(part: dict[str, Any]) -> str:
    if "error" not in part:
        return ""
    within = "of" if part["error"] <= part["tolerance"] else "beyond"
    return f", error {part['error']:.2g} {within} {part['tolerance']:.2g} {part['unit']}"
