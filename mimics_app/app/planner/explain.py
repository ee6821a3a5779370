"""Explanation of a plan: the parts that a scene runs and leaves out, as the object of `mimics explain --json`."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from typing import Any

import msgspec

from mimics_app.app.planner.plan import Costlier, Plan, PlannedMethod
from mimics_app.app.planner.uses import (
    TOUCH,
    WHOLE_TICK,
    grips,
    points_of,
    shadow_distance_of,
    touched_shape,
    uses,
    visual_of,
)
from mimics_app.contracts.ports.method_table import Row, Table
from mimics_app.contracts.ports.methods import Settings
from mimics_app.tasks.scene_section import task_of
from mimics_app.world.components.effects import Billboard, Particles, Projector
from mimics_app.world.components.objects import ForceField, HapticEffect, HapticObject, HapticWalls
from mimics_app.world.components.pictures import Inset, Mirror, Screen
from mimics_app.world.components.robot import Tunnel
from mimics_app.world.components.visible import LightComponent, Sound, SoundEmitter
from mimics_app.world.files.scene.scene import Scene

__all__ = ["OF_OBJECTS", "TICK_GROUP", "Part", "explain_plan"]

TICK_GROUP = "haptic tick"
"""Group of the table with the cost of the whole tick, by tunnel projection."""

_SHAPES = "bounding geometry"
_EFFECTS, _GRIP = "effects", "grip"
_ACTING = "effects and force fields"
_OF_TICK = ("resting bodies",)
"""Groups whose cost is added to that of the whole tick."""

_IN_TICK = "device, kinematics, controller, safety limits, passivity controller, stability margin and records in it"


@dataclass(frozen=True, slots=True)
class Part:
    """One part that a scene runs.

    Attributes:
        part: Purpose of the part.
        group: Group of methods in the table.
        method: The method that runs.
        cost_us: Cost by the table [us per call]; None for a method that is not in the table.
        error: Error in `unit`; None where it has none, or the method is not in the table.
        unit: Unit of error and tolerance.
        tolerance: Largest accepted error; None where nothing is chosen.
        next_cheaper: The nearest cheaper rival, refused for its error, {"method", "error"}; None without one.
        too_dear: The more accurate rival that the frame time does not allow, {"method", "error", "more_ms", "room_ms"}:
            added frame time over the cheapest rival, and time available [ms]; None where time does not decide.
        more_ms: Added frame time over the cheapest rival [ms]; None where the frame time is free.
        note: Remark on its use; "" for none.
        within: The part whose cost includes this one's; "" for none.
        tick_us: Its share of a tick of the haptic loop [us]; None where another part includes it, or it is no part of
            the loop. The shares add up to the cost of the whole tick.
    """

    part: str
    group: str
    method: str
    cost_us: float | None
    error: float | None
    unit: str
    tolerance: float | None
    next_cheaper: dict[str, Any] | None
    too_dear: dict[str, Any] | None = None
    more_ms: float | None = None
    note: str = ""
    within: str = ""
    tick_us: float | None = None


@dataclass(frozen=True, slots=True)
class _LeftOut:
    """One part that a scene leaves out, the reason, and the time saved [us], None where it is unknown."""

    part: str
    why: str
    saved_us: float | None


def explain_plan(scene: Scene, plan: Plan, shadow_us: Callable[[], float | None] = lambda: None) -> dict[str, Any]:
    """Return the object of `mimics explain --json`; what does not apply to a part is absent.

    Args:
        scene: The scene of the plan.
        plan: The plan that runs.
        shadow_us: Measures the cost of a shadow pass [us]; called only where the scene casts no shadow.
    """
    parts = [*_tick_parts(scene, plan), *(_part(scene, choice, plan) for choice in plan.choices)]
    return {
        "profile": plan.profile,
        "tolerances": dict(plan.tolerances),
        "pixels": plan.pixels,
        "table": {"origin": plan.origin, "machine": plan.table.machine},
        "parts": [_stated(part) for part in parts],
        "left_out": [_stated(left) for left in _left_out(scene, plan, shadow_us)],
    }


def _stated(row: Part | _LeftOut) -> dict[str, Any]:
    """Return the fields that apply, in their order."""
    return {name: value for name, value in asdict(row).items() if value is not None}


def _part(scene: Scene, choice: PlannedMethod, plan: Plan) -> Part:
    taken, refused, costlier = choice.taken, choice.refused, choice.costlier
    timed = bool(plan.pixels and uses()[choice.group].pixels)
    return Part(
        part=choice.what,
        group=choice.group,
        method=taken.method,
        cost_us=None if math.isnan(taken.cost_us) else taken.cost_us,
        error=None if math.isnan(taken.error) else taken.error,
        unit=taken.unit,
        tolerance=choice.tolerance,
        next_cheaper=None if refused is None else {"method": refused.method, "error": refused.error},
        too_dear=None if costlier is None else _too_dear(costlier),
        more_ms=choice.more_ms if timed else None,
        note=_note(scene, choice, plan),
        within=uses()[choice.group].within,
        tick_us=taken.cost_us * uses()[choice.group].count(scene) if choice.group in _OF_TICK else None,
    )


def _note(scene: Scene, choice: PlannedMethod, plan: Plan) -> str:
    if choice.taken.settings.get("cascaded"):
        return _cascade_note(scene)
    return _ALONE if len(plan.table.groups[choice.group]) == 1 else ""


_ALONE = "no rival that the product can run"


def _cascade_note(scene: Scene) -> str:
    """Return the distance of the cascades, and the reason for it."""
    visual, distance = visual_of(scene), shadow_distance_of(scene)
    reason = (
        "bodies are spread over more than one map holds" if visual.shadow_distance == "auto" else "set by the scene"
    )
    maps = "1 map" if visual.cascades == 1 else f"{visual.cascades} maps"
    return f"to {distance:.3g} m from the camera in {maps}: {reason}"


def _too_dear(costlier: Costlier) -> dict[str, Any]:
    row = costlier.row
    return {"method": row.method, "error": row.error, "more_ms": costlier.more_ms, "room_ms": costlier.room_ms}


def _tick_parts(scene: Scene, plan: Plan) -> list[Part]:
    """Return the whole haptic tick, where the table has it and the scene is playable."""
    if scene.scenario == _NOBODY:
        return []
    row = _tick_row(plan.table, plan.settings.get("tunnel projection", {}))
    if row is None:
        return []
    some = _has_objects(scene)
    what = f"{WHOLE_TICK} without its objects" if some else f"{WHOLE_TICK}, all of it"
    part = Part(what, TICK_GROUP, row.method, row.cost_us, None, "", None, None, note=_IN_TICK, tick_us=row.cost_us)
    return [part, *(_touch_parts(scene, plan) if some else []), *_effect_parts(scene, plan), *_grip_parts(scene, plan)]


def _effect_parts(scene: Scene, plan: Plan) -> list[Part]:
    """Return the effects and force fields by their kind."""
    kinds = [each.effect.__struct_config__.tag for _, each, _ in scene.components(HapticEffect)]
    kinds += ["force_field" for _ in scene.components(ForceField)]
    rows = {row.settings["effect"]: row for row in plan.table.groups.get(_EFFECTS, [])}
    return [
        Part(_ACTING, _EFFECTS, row.method, row.cost_us, None, "", None, None, tick_us=count * row.cost_us)
        for kind, count in Counter(kinds).items()
        if (row := rows.get(kind)) is not None
    ]


def _grip_parts(scene: Scene, plan: Plan) -> list[Part]:
    """Return the grip, where fingers can hold an object; its cost is that of a tick that holds one."""
    rows = plan.table.groups.get(_GRIP, []) if grips(scene) else []
    return [
        Part(_GRIP, _GRIP, row.method, row.cost_us, None, "", None, None, note=_ALONE, tick_us=row.cost_us)
        for row in rows
    ]


def _touch_parts(scene: Scene, plan: Plan) -> list[Part]:
    """Touching a shape with each point of contact: found, felt, with its law and friction."""
    rows = plan.table.groups.get(_SHAPES, [])
    row = next((row for row in rows if row.settings["shape"] == touched_shape(scene)), None)
    if row is None:
        return []
    whole = row.cost_us * points_of(scene)
    return [Part(TOUCH, _SHAPES, row.method, row.cost_us, None, "", None, None, tick_us=whole)]


def _has_objects(scene: Scene) -> bool:
    return scene.has(HapticObject) or scene.has(HapticWalls)


def _tick_row(table: Table, settings: Settings) -> Row | None:
    """Return the row of the whole tick with this projection of a tunnel; {}: without a tunnel."""
    return next((row for row in table.groups.get(TICK_GROUP, []) if row.settings == settings), None)


def _left_out(scene: Scene, plan: Plan, shadow_us: Callable[[], float | None]) -> list[_LeftOut]:
    """Return the parts of the product that this scene does not use."""
    table = plan.table
    absent: list[tuple[type[msgspec.Struct], str, str, float | None]] = [
        (Sound, "sound process, per block of 5 ms", "no entity has a sound", _cheapest(table, "spatialiser")),
        (SoundEmitter, "sound emitters", "no entity has a sound_emitter", _emitters_us(plan)),
        (Billboard, "billboards, per frame", "no entity has a billboard", None),
        (Particles, "particles, per frame", "no entity has particles", None),
        (Projector, "decals and slides, per frame", "no entity has a projector", None),
        (Mirror, "mirrors, a picture each per eye", "no entity has a mirror", None),
        (Screen, "screens, a picture each", "no entity has a screen", None),
        (Inset, "pictures over the display", "no entity has an inset", None),
        (Tunnel, "tunnel force, per tick", "no entity has a tunnel", _tunnel_us(table)),
    ]
    left = [_LeftOut(part, why, saved) for kind, part, why, saved in absent if not scene.has(kind)]
    if not any(light.casts_shadow for _, light, _ in scene.components(LightComponent)):
        left.append(_LeftOut("shadow pass, per frame", "no light casts a shadow", shadow_us()))
    left += _filters_left_out(scene, plan)
    if not _has_objects(scene):
        left += [_LeftOut(part, _NO_OBJECT, _cheapest(table, group)) for group, part in OF_OBJECTS.items()]
    left.append(_LeftOut("body signals and the person's state", "mimics run --physio SOURCE requests them", None))
    if not task_of(scene).learn:
        left.append(_LeftOut("learned adaptation", "neither task.learn nor mimics run --learn POLICY", None))
    return left


def _filters_left_out(scene: Scene, plan: Plan) -> list[_LeftOut]:
    """Return the parts of the picture that run only where the scene requests them."""
    visual = visual_of(scene)
    left = [
        _LeftOut(
            f"{group}, per frame",
            f"systems.visual.{group.replace(' ', '_')} does not request it",
            _extra_us(plan, group),
        )
        for group, used in (
            ("bloom", visual.bloom > 0.0),
            ("ambient occlusion", visual.ambient_occlusion > 0.0),
        )
        if not used
    ]
    if not plan.settings.get("anti aliasing", {"fxaa": True})["fxaa"]:
        left.append(_LeftOut("filter of edges, per frame", "see anti-aliasing above: another method, or none", None))
    return left


def _extra_us(plan: Plan, group: str) -> float | None:
    """Return the cost of the costliest method above the cheapest in the plan's picture [us]; None: not timed."""
    costs = [row.cost_us for row in plan.table.groups.get(group, [])]
    return (max(costs) - min(costs)) * plan.pixels / uses()[group].pixels if costs and plan.pixels else None


_NOBODY = "none"
"""Scenario of a scene that is only looked at."""

_NO_OBJECT = "no entity has a haptic_object or haptic_walls"

OF_OBJECTS: Mapping[str, str] = {
    "integrator": "rigid bodies, per body and tick",
    "rotation update": "rotation of bodies, per body and tick",
    "contact law": "contact with shapes, per contact and tick",
    "friction": "friction, per contact and tick",
}
"""Part of each group of methods that only haptic objects use."""


def _cheapest(table: Table, group: str) -> float | None:
    """Return the cost of the cheapest method of a group [us]; None for an empty group."""
    costs = [row.cost_us for row in table.groups.get(group, [])]
    return min(costs, default=None)


def _emitters_us(plan: Plan) -> float | None:
    """Return the cost of one source in a block of the mixer [us]; None where it is unknown."""
    chosen = next((choice.taken for choice in plan.choices if choice.group == "spatialiser"), None)
    return None if chosen is None or math.isnan(chosen.cost_us) else chosen.cost_us / _SOURCES_OF_TABLE


_SOURCES_OF_TABLE = 16
"""Number of moving sources in the block with which the spatialisers are measured (lab/groups/spatialiser.py)."""


def _tunnel_us(table: Table) -> float | None:
    """Return the added cost of a tick with a tunnel, at least that of the projection."""
    bare, least = _tick_row(table, {}), _cheapest(table, "tunnel projection")
    whole = [row.cost_us for row in table.groups.get(TICK_GROUP, []) if row.settings]
    if bare is None or least is None or not whole:
        return least
    return max(min(whole) - bare.cost_us, least)
