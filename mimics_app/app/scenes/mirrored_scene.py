"""The mirror image of a scene across the sagittal plane x = 0: for the left side of a person, from that for the right.

Entities, curves, haptic objects, effects, lights, cameras and the places of the task are mirrored, and with them what a
simulated person does. Texts keep their letters, and people their left and right. Other models are mirrored as a whole:
what is only seen by a negative scale; a model on an entity that is felt, which must not be scaled, by an entity below
it. The robot stays as it is: so its axes stay true.
"""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterator, Mapping
from typing import Any

from mimics_app.contracts.errors import UsageError
from mimics_app.contracts.system.phrases import phrase

__all__ = ["mirrored", "why_not_mirrored"]

_Plain = dict[str, Any]

_WALK = phrase("a walk has no side: its hand goes to both")
_TASKS = {
    "city_walk": _WALK,
    "canyon_walk": _WALK,
    "guided_walk": _WALK,
    "soccer": _WALK,
    "avatar_cord": phrase("head and both hands of the person are tracked"),
    "calibration": phrase("a calibration measures both sides as they are"),
}
"""Why a task is not mirrored, by its section."""
_COMPONENTS = {
    "force_field": phrase("the function of a force field has no mirror image here"),
    "connections": phrase("wires carry numbers of any meaning"),
    "controller": phrase("its controller has no mirror image here"),
    "joint_reference": phrase("legs are led along curves of their own"),
    "cord": phrase("a cord hangs at a body"),
    "follow": phrase("a view follows what moves"),
    "walking_path": phrase("people walk along paths of their own"),
}
"""Why a scene is not mirrored, by a component that it has."""
_POLAR = {
    "light": ("target",),
    "camera": ("target",),
    "particles": ("direction", "gravity", "wind"),
    "haptic_object": ("centre", "gravity", "initial_velocity", "force_aux"),
}
"""Points, directions and forces of components, whose x is reversed."""
_AXIAL = {"haptic_object": ("initial_angular_velocity", "torque_aux")}
"""Axial vectors, whose y and z are reversed."""
_ONLY_SEEN = frozenset({"mesh"})
_PEOPLE = frozenset({"animation", "avatar", "encourager"})
_BOXES = ("lost_outside", "lost_inside")


def why_not_mirrored(document: Mapping[str, Any]) -> str:
    """Return why a resolved scene cannot be mirrored, "" where it can."""
    task = document.get("task") or {}
    reasons = [why for name, why in _TASKS.items() if name in task]
    for entity in document["entities"]:
        components = entity["components"]
        reasons += [why for name, why in _COMPONENTS.items() if name in components]
        if "path_file" in components.get("tunnel", {}) or "path_file" in components.get("haptic_path", {}):
            reasons.append(phrase("its path is recorded"))
        if any(shape.get("shape") == "mesh" for shape in components.get("haptic_object", {}).get("shapes", ())):
            reasons.append(phrase("it has objects made of models, which have a side"))
        if "robot" in components:
            reasons += _why_not_robot(components["robot"])
    return reasons[0] if reasons else ""


def mirrored(document: Mapping[str, Any]) -> _Plain:
    """Return the mirror image of a resolved scene.

    Raises:
        UsageError: The scene cannot be mirrored; says why.
    """
    if why := why_not_mirrored(document):
        raise UsageError(f"this scene cannot be mirrored: {why}", "leave --side out")
    result: _Plain = copy.deepcopy(dict(document))
    seen = _seen_as_a_whole(result["entities"])
    for entity in result["entities"]:
        if entity["id"] in seen:
            if entity["parent"] not in seen:
                _mirror_place(entity["transform"])
                x, y, z = entity["transform"].get("scale", (1.0, 1.0, 1.0))
                entity["transform"]["scale"] = [-x, y, z]
            continue
        _mirror_place(entity["transform"])
        for name, component in entity["components"].items():
            _mirror_component(name, component)
    result["entities"] += list(_mirror_images(result["entities"], seen))
    _mirror_task(result.get("task") or {})
    return result


def _why_not_robot(robot: _Plain) -> list[str]:
    placed, device = robot.get("robot_to_world", {}), robot.get("device", "simulated_hapticmaster")
    if any(word in device for word in ("leg", "lokomat")):
        return [phrase("its device is worn on the legs")]
    rotation = placed.get("rotation", ((0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (1.0, 0.0, 0.0)))
    across = [(i, j) for i in range(3) for j in range(3) if (i == 0) != (j == 1) and rotation[i][j] != 0.0]
    aside = placed.get("translation", (0.0, 0.0, 0.0))[0] != 0.0
    return [phrase("its robot is not before the middle of the person")] if across or aside else []


def _seen_as_a_whole(entities: list[_Plain]) -> set[str]:
    """Return the entities that, with all below them, are only seen."""
    below: dict[str | None, list[_Plain]] = {}
    for entity in entities:
        below.setdefault(entity["parent"], []).append(entity)

    def only_seen(entity: _Plain) -> bool:
        own = set(entity["components"]) <= _ONLY_SEEN
        return own and all(only_seen(child) for child in below.get(entity["id"], ()))

    def found(entity: _Plain, within: bool) -> Iterator[str]:
        within = within or (only_seen(entity) and bool(_shown(entity, below)))
        if within:
            yield entity["id"]
        for child in below.get(entity["id"], ()):
            yield from found(child, within)

    return {name for entity in below.get(None, ()) for name in found(entity, within=False)}


def _mirror_images(entities: list[_Plain], seen: set[str]) -> Iterator[_Plain]:
    """Move the model of each entity that is more than seen to one below it, which is mirrored; yield those."""
    with_nodes = {entity["id"].partition("/")[0] for entity in entities if "/" in entity["id"]}
    for entity in entities:
        parts = entity["components"]
        stays = entity["id"] in seen or entity["id"] in with_nodes or parts.keys() & _PEOPLE
        if "source" in parts.get("mesh", {}) and not stays:
            transform = {"scale": [-1.0, 1.0, 1.0]}
            own = {"mesh": parts.pop("mesh")}
            yield {"id": f"{entity['id']}.mirrored", "parent": entity["id"], "transform": transform, "components": own}


def _shown(entity: _Plain, below: Mapping[str | None, list[_Plain]]) -> bool:
    """Whether an entity, or one below it, has a model."""
    children = below.get(entity["id"], ())
    return "source" in entity["components"].get("mesh", {}) or any(_shown(child, below) for child in children)


def _mirror_place(place: _Plain) -> None:
    """Mirror translation and rotation of a transform."""
    _change(place, "translation", _point)
    _change(place, "rotation", _turn)


def _mirror_component(name: str, component: _Plain) -> None:
    for key in _POLAR.get(name, ()):
        _change(component, key, _point)
    for key in _AXIAL.get(name, ()):
        _change(component, key, _axial)
    if "control_points" in component:
        component["control_points"] = [_point(each) for each in component["control_points"]]
    if name in _PARTS:
        _PARTS[name](component)


def _mirror_shapes(body: _Plain) -> None:
    for shape in body.get("shapes", ()):
        _change(shape, "position", _point)
        _change(shape, "rotation", _turn)


def _mirror_effect(effect: _Plain) -> None:
    for key in ("force", "direction"):
        _change(effect["effect"], key, _point)


def _mirror_fingers(points: _Plain) -> None:
    for point in points.get("points", ()):
        _change(point, "offset", _point)


def _mirror_walls(walls: _Plain) -> None:
    for side in ("left", "right", "floor", "ceiling", "back", "front"):
        _change(walls.get(side, {}), "position", _point)
        _change(walls.get(side, {}), "rotation", _turn)
    _exchange(walls, "left", "right")


def _mirror_person(person: _Plain) -> None:
    person["mirrored"] = not person.get("mirrored", False)
    if person.get("range_of_motion"):
        right, left, *rest = person["range_of_motion"]
        person["range_of_motion"] = [left, right, *rest]
    _exchange(person, "hearing_left", "hearing_right")


def _mirror_hand(hand: _Plain) -> None:
    if "fingers" in hand:
        hand["fingers"] = hand["fingers"][::-1]


_PARTS: Mapping[str, Callable[[_Plain], None]] = {
    "haptic_object": _mirror_shapes,
    "haptic_effect": _mirror_effect,
    "haptic_walls": _mirror_walls,
    "grasping_hand": _mirror_hand,
    "interaction_points": _mirror_fingers,
    "patient": _mirror_person,
}
"""Components with parts of their own."""


def _mirror_task(task: _Plain) -> None:
    for goal in task.get("goals", ()):
        _change(goal, "position_world", _point)
    carry = task.get("carry") or {}
    for name in _BOXES:
        if carry.get(name):
            low, high = carry[name]["low"], carry[name]["high"]
            carry[name] = {"low": [-high[0], *low[1:]], "high": [-low[0], *high[1:]]}
    if carry.get("falls_from"):  # drawn from low to high, whichever is the smaller
        for end in ("low", "high"):
            _change(carry["falls_from"], end, _point)


def _change(holder: _Plain, key: str, mirror: Callable[[list[float]], list[float]]) -> None:
    if isinstance(holder.get(key), list):  # of some components the key has a number: a size
        holder[key] = mirror(holder[key])


def _exchange(holder: _Plain, one: str, other: str) -> None:
    kept = {other: holder.pop(one, None), one: holder.pop(other, None)}
    holder.update({key: value for key, value in kept.items() if value is not None})


def _point(values: list[float]) -> list[float]:
    x, y, z = values
    return [-x, y, z]


def _axial(values: list[float]) -> list[float]:
    x, y, z = values
    return [x, -y, -z]


def _turn(values: list[float]) -> list[float]:
    x, y, z, w = values
    return [x, -y, -z, w]
