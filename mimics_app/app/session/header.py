"""Header of the recording of a run."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Any

import msgspec

from mimics_app.app.planner.explain import explain_plan
from mimics_app.app.scenes.person_edit import plain_edit
from mimics_app.app.session.mover import mover_of
from mimics_app.app.session.preparation import SessionParts
from mimics_app.contracts.loop.haptic import SafetyState, TripCause
from mimics_app.recording.report_values import mapping
from mimics_app.rendering.haptic.devices.scene_contacts import contacts_of
from mimics_app.rendering.haptic.scene_block import safety_of
from mimics_app.rendering.haptic.scene_objects import objects_of_scene
from mimics_app.tasks.task_record import task_record
from mimics_app.world.components.robot import Robot
from mimics_app.world.files.scene.scene import Scene

__all__ = ["describe_session"]


def describe_session(parts: SessionParts) -> dict[str, Any]:
    """Return scene, seed, device and person, limits, names, settings, task and plan as plain objects of JSON."""
    scene, settings = parts.scene, parts.settings
    return {
        "scene": {
            "name": scene.name,
            "title": scene.title,
            "file": str(scene.path),
            "hash": scene.hash,
            "document": scene.document,
        },
        "seed": settings.seed,
        "profile": settings.profile,
        "live": parts.live,
        "moved_by": _moved_by(parts),
        "safety": {
            **msgspec.structs.asdict(safety_of(parts.parameter_store.block)),
            "late_latches": bool(parts.parameter_store.block["late_latches"][0]),
        },
        **({"beyond_usual_limits": list(parts.held.notes)} if parts.held.notes else {}),
        **({"softened": list(parts.softened)} if parts.softened else {}),
        "settings": {
            name: str(value) if isinstance(value, Path) else value
            for name, value in asdict(settings).items()
            if name != "journey"
        },
        "task": task_record(parts.task, parts.context),
        "facts": parts.scenario.facts,
        **({"edit": edit} if (edit := plain_edit(scene)) else {}),
        "names": _names(scene),
        **({"body": parts.body.header} if parts.body.header else {}),
        "plan": explain_plan(scene, parts.plan.without_picture if parts.live else parts.plan),
    }


def _names(scene: Scene) -> dict[str, list[str]]:
    """Return what the numbers in samples and events mean: states, causes, and the rows of the haptic objects."""
    objects = objects_of_scene(scene)
    return {
        "state": [state.name for state in SafetyState],
        "cause": [cause.name for cause in TripCause],
        "points": list(contacts_of(scene)),
        "bodies": list(objects.body_entities),
        "shapes": list(objects.shape_entities),
        "effects": list(objects.effect_entities),
        "materials": list(objects.materials),
    }


def _moved_by(parts: SessionParts) -> dict[str, Any]:
    """Return the device and the person who moved it; of a replayed recording, the person in its header."""
    device = parts.robot.device
    if parts.device_given:
        return {"device": parts.plugin.name, "kind": device, **_person(parts)}
    if parts.recorded is None:
        return {"device": device, **_person(parts)}
    kind, before = (parts.scene.first(Robot) or Robot()).device, mapping(parts.recorded.get("moved_by"))
    return {"device": device, "kind": kind, **{key: before[key] for key in ("person", "preset") if key in before}}


def _person(parts: SessionParts) -> dict[str, str]:
    mover = mover_of(parts.plugin)
    return {"person": mover, **({"preset": parts.patient.preset} if mover == "simulated" else {})}
