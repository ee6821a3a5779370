"""What a scene runs and what it leaves out, as the object of `mimics explain --json`."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from typing import Any

import msgspec

from mimics_app.app.planner.plan import Choice, Plan
from mimics_app.lab.table import Row, Table
from mimics_app.world.components.effects import Billboard, Particles, Projector
from mimics_app.world.components.pictures import Inset, Mirror, Screen
from mimics_app.world.components.robot import Tunnel
from mimics_app.world.components.systems import VisualSettings
from mimics_app.world.components.visible import LightComponent, Sound, SoundEmitter
from mimics_app.world.scene.scene import Scene

__all__ = ["TICK_GROUP", "UNUSED", "LeftOut", "Part", "describe_plan", "explain_plan"]

TICK_GROUP = "haptic tick"
"""Group of the table that holds the whole tick, by the projection in it."""

_NO_TUNNEL = "no tunnel"


@dataclass(frozen=True, slots=True)
class Part:
    """One thing a scene runs.

    Attributes:
        part: What it is for.
        group: Of the table.
        method: The one that runs.
        cost_us: By the table [us per call].
        error: In `unit`; None where it has none.
        unit: Of error and tolerance.
        tolerance: What the run accepts; None where nothing is chosen.
        next_cheaper: The nearest cheaper rival, refused for its error, {"method", "error"}; None where there is none.
    """

    part: str
    group: str
    method: str
    cost_us: float
    error: float | None
    unit: str
    tolerance: float | None
    next_cheaper: dict[str, Any] | None


@dataclass(frozen=True, slots=True)
class LeftOut:
    """One thing a scene does not run, why, and what that saves [us]; None: there is nothing to measure it by."""

    part: str
    why: str
    saved_us: float | None


def explain_plan(scene: Scene, plan: Plan, shadow_us: Callable[[], float | None] = lambda: None) -> dict[str, Any]:
    """The whole object.

    Args:
        scene: The scene of the plan.
        plan: What runs.
        shadow_us: Measures what a shadow pass would cost [us]; asked only where the scene casts no shadow.
    """
    left_out = _left_out(scene, plan, shadow_us)
    return {**describe_plan(scene, plan), "left_out": [asdict(left) for left in left_out]}


def describe_plan(scene: Scene, plan: Plan) -> dict[str, Any]:
    """The object without measuring anything: what the header of a run keeps."""
    parts = [*_tick_parts(scene, plan), *(_part(choice) for choice in plan.choices)]
    return {
        "profile": plan.profile,
        "tolerances": dict(plan.tolerances),
        "table": {"origin": plan.origin, "machine": plan.table.machine},
        "parts": [asdict(part) for part in parts],
        "left_out": [asdict(left) for left in _left_out(scene, plan, lambda: None)],
    }


def _part(choice: Choice) -> Part:
    taken, refused = choice.taken, choice.refused
    return Part(
        part=choice.what,
        group=choice.group,
        method=taken.method,
        cost_us=taken.cost_us,
        error=taken.error,
        unit=taken.unit,
        tolerance=choice.tolerance,
        next_cheaper=None if refused is None else {"method": refused.method, "error": refused.error},
    )


def _tick_parts(scene: Scene, plan: Plan) -> list[Part]:
    """The whole haptic tick, where the table has it."""
    method = plan.methods.get("tunnel projection", _NO_TUNNEL) if scene.components(Tunnel) else _NO_TUNNEL
    row = _row(plan.table, TICK_GROUP, method)
    if row is None:
        return []
    return [Part("haptic tick, all of it", TICK_GROUP, method, row.cost_us, None, "", None, None)]


def _row(table: Table, group: str, method: str) -> Row | None:
    return next((row for row in table.groups.get(group, []) if row.method == method), None)


def _left_out(scene: Scene, plan: Plan, shadow_us: Callable[[], float | None]) -> list[LeftOut]:
    """Parts of the product this scene does not use."""
    table = plan.table
    absent: list[tuple[type[msgspec.Struct], str, str, float | None]] = [
        (Sound, "sound process, per block of 5 ms", "no entity has a sound", _cheapest(table, "spatialiser")),
        (SoundEmitter, "sound emitters", "no entity has a sound_emitter", _emitters_us(table, plan)),
        (Billboard, "billboards, per frame", "no entity has a billboard", None),
        (Particles, "particles, per frame", "no entity has particles", None),
        (Projector, "decals and slides, per frame", "no entity has a projector", None),
        (Mirror, "mirrors, a picture each per eye", "no entity has a mirror", None),
        (Screen, "screens, a picture each", "no entity has a screen", None),
        (Inset, "pictures over the display", "no entity has an inset", None),
        (Tunnel, "tunnel force, per tick", "no entity has a tunnel", _tunnel_us(table)),
    ]
    left = [LeftOut(part, why, saved) for kind, part, why, saved in absent if not scene.components(kind)]
    if not any(light.casts_shadow for _, light, _ in scene.components(LightComponent)):
        left.append(LeftOut("shadow pass, per frame", "no light casts a shadow", shadow_us()))
    left += _filters_left_out(scene)
    for group, (part, why) in UNUSED.items():
        left.append(LeftOut(part, why, _cheapest(table, group)))
    left.append(LeftOut("body signals, estimation, learning", "no recorder of body signals is in the scene", None))
    return left


def _filters_left_out(scene: Scene) -> list[LeftOut]:
    """What is done to the picture only where the scene asks."""
    wanted = scene.systems.get("visual")
    visual = wanted if isinstance(wanted, VisualSettings) else VisualSettings()
    absent = (
        ("glow", "bloom", visual.bloom),
        ("darker corners", "ambient_occlusion", visual.ambient_occlusion),
        ("filter of edges", "anti_aliasing", float(visual.anti_aliasing in ("filter", "both"))),
    )
    return [
        LeftOut(f"{part}, per frame", f"systems.visual.{name} does not ask for it", None)
        for part, name, used in absent
        if used == 0.0
    ]


UNUSED: Mapping[str, tuple[str, str]] = {
    "integrator": ("rigid bodies, per body and tick", "nothing but the ball moves, and the robot moves it"),
    "rotation update": ("rotation of bodies, per body and tick", "nothing turns"),
    "contact law": ("contact with shapes, per contact and tick", "there is no shape to touch but the tunnel"),
    "friction": ("friction, per contact and tick", "the wall of a tunnel is smooth; its drag is part of the tunnel"),
}
"""Groups whose methods no component of the present scene format asks for: (part, why)."""


def _cheapest(table: Table, group: str) -> float | None:
    """The least a part could have cost: what leaving it out saves at least [us]."""
    costs = [row.cost_us for row in table.groups.get(group, [])]
    return min(costs, default=None)


def _emitters_us(table: Table, plan: Plan) -> float | None:
    """Sources share one block: nothing is mixed for one that is not there."""
    method = plan.methods.get("spatialiser")
    row = None if method is None else _row(table, "spatialiser", method)
    return None if row is None else row.cost_us / _SOURCES_OF_TABLE


_SOURCES_OF_TABLE = 16
"""Moving sources in the block that the spatialisers are measured by (rendering/audio/methods.py)."""


def _tunnel_us(table: Table) -> float | None:
    """What the whole tick costs more with a tunnel, and the projection at least."""
    bare, least = _row(table, TICK_GROUP, _NO_TUNNEL), _cheapest(table, "tunnel projection")
    whole = [row.cost_us for row in table.groups.get(TICK_GROUP, []) if row.method != _NO_TUNNEL]
    if bare is None or least is None or not whole:
        return least
    return max(min(whole) - bare.cost_us, least)
