"""A scene in high contrast: targets, paths and the hand's marker in light colours on dark ground.

A scene says by `systems.contrast` what its materials are, and what is left out that is only seen. Of a scene that does
not, what the task names or the hand feels is a target, what leads the hand a path, and all else is dim. Each target,
path and hand gets one colour without light or texture, so that the ratio of two of them is known: at least 7:1 to the
ground (WCAG 2.1, 1.4.11 asks for 3:1).
"""

from __future__ import annotations

import copy
from collections.abc import Iterable, Mapping
from typing import Any

from mimics_app.world.components.systems import Role
from mimics_app.world.components.visible import Environment, LightComponent

__all__ = ["contrasted"]

_COLOURS: Mapping[Role, tuple[float, float, float, float]] = {
    "target": (1.0, 0.85, 0.0, 1.0),
    "path": (1.0, 1.0, 1.0, 1.0),
    "hand": (0.25, 0.75, 1.0, 1.0),
    "ground": (0.004, 0.004, 0.006, 1.0),
}
"""Colour by role, linear."""
_DARK = [0.004, 0.004, 0.006]
_DIM = 0.25
"""Light of the surroundings on what has a material of its own."""
_DIMMED = 0.07
"""Share of the light that is left of a scene without roles."""
_OTHER = (1.0, 0.55, 0.05, 1.0)
"""Colour of every second target of such a scene, so that neighbours differ: 5:1 to a white surface in it."""
_PARTS: Mapping[str, Role] = {"ball": "hand", "tunnel": "path", "haptic_path": "path", "haptic_object": "target"}
"""Role of what is drawn of an entity, by a component that it has."""
_PEOPLE = frozenset({"animation", "avatar"})
_Plain = dict[str, Any]


def contrasted(document: Mapping[str, Any]) -> _Plain:
    """Return a resolved scene in high contrast."""
    result: _Plain = copy.deepcopy(dict(document))
    contrast = (result.get("systems") or {}).get("contrast", {})
    for entity in result["entities"]:
        if entity["id"] in contrast.get("left_out", ()):
            entity["components"].pop("mesh", None)
    stated = contrast.get("materials", {})
    if not stated:
        _by_components(result)
        return result
    materials = result.get("materials", {})
    for name, role in stated.items():
        if name in materials:
            materials[name] = _material(_COLOURS[role])
    for entity in result["entities"]:
        surroundings = entity["components"].get("environment")
        if surroundings is not None:
            surroundings |= {"zenith": _DARK, "horizon": _DARK, "ground": _DARK, "ambient": _DIM}
    return result


def _by_components(document: _Plain) -> None:
    """Give what the task names, and what is felt, the colours of its role, and dim all else; without such, nothing."""
    roles = _roles_of(document)
    drawn = [entity for entity in document["entities"] if entity["id"] in roles and "mesh" in entity["components"]]
    if not drawn:  # people are looked at: they have no role, and would not be seen
        return
    materials = document.setdefault("materials", {})
    for number, entity in enumerate(drawn):
        role = roles[entity["id"]]
        name = entity["components"]["mesh"]["material"] = f"contrast_{role}_{number % 2}"
        materials[name] = _material(_OTHER if role == "target" and number % 2 else _COLOURS[role])
    for entity in document["entities"]:
        _dim(entity["components"])


def _roles_of(document: _Plain) -> dict[str, Role]:
    """Return the role of each entity that has one, and of those below it."""
    named = _named_by((document.get("task") or {}).values())
    hands = _named_by(entity["components"].get("grasping_hand") for entity in document["entities"])
    roles: dict[str, Role] = {}
    for entity in document["entities"]:  # a parent stands before what is below it
        components = entity["components"]
        own: list[Role] = [role for part, role in _PARTS.items() if part in components]
        if entity["id"] in hands:
            own.append("hand")
        if entity["id"] in named:
            own.append("target")
        if entity["parent"] in roles:
            own.append(roles[entity["parent"]])
        if own and not components.keys() & _PEOPLE:
            roles[entity["id"]] = own[0]
    return roles


def _named_by(values: Iterable[object]) -> set[str]:
    """Return all words of a part of the task, among them the names of entities."""
    found: set[str] = set()
    for value in values:
        if isinstance(value, str):
            found.add(value)
        elif isinstance(value, list | dict):
            found |= _named_by(value.values() if isinstance(value, dict) else value)
    return found


def _dim(components: _Plain) -> None:
    """Leave little of a light, and of that of the surroundings, whose sky is dark."""
    light, surroundings = components.get("light"), components.get("environment")
    if light is not None:
        light["intensity"] = _DIMMED * light.get("intensity", LightComponent().intensity)
    if surroundings is not None:
        ambient = _DIMMED * surroundings.get("ambient", Environment().ambient)
        surroundings |= {"zenith": _DARK, "horizon": _DARK, "ground": _DARK, "ambient": ambient}
        surroundings.pop("backdrop", None)


def _material(colour: tuple[float, ...]) -> _Plain:
    return {"technique": "unlit", "base_colour": list(colour)}
