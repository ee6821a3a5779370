"""A scene fitted to a person: paths within the range of motion, grips within the strength.

Scaled about the place where the hand rests are the entities that the task's `fitting` names: their places, curves,
tunnels and balls, and the points of the task itself. Length over width of a tunnel stays, by which the time to steer
through it is predicted (Accot and Zhai, CHI 1997). The robot, what is only seen, and the sizes of objects stay. Grips
and deflections of the hand are lowered where they are beyond what fits.
"""

from __future__ import annotations

import copy
from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple, cast

from msgspec.structs import fields

from mimics_app.contracts.messages.calibration_record import DIRECTIONS
from mimics_app.contracts.messages.fit import Fit
from mimics_app.tasks.kinds.registry import task_kinds
from mimics_app.world.components.joint_reference import JointReference

__all__ = ["FITTED", "Change", "fitted"]

FITTED = "x-fitted"
"""Key of a resolved scene with the list of its changes: a comment."""

_Document = Mapping[str, Any]
_Slot = tuple[dict[Any, Any], object]
"""What holds a value, a table or a list, and its key there."""

_BOXES = ("falls_from", "lost_outside", "lost_inside")
_WIDTHS = {"tunnel": ("radius",), "ball": ("radius_min", "radius_max")}
"""Radii by component."""
_WALKS = ("city_walk", "canyon_walk", "soccer")
_DEFLECTION, _LEAST_DEFLECTION = 0.1, 0.04
"""Full deflection of the hand of a walk that states none, and the smallest that can be dosed [m]."""
_LEAST_SPEED = 0.2
"""Smallest speed to which a walk is fitted [m/s]: slower, no scene comes to its end."""
_FULL_GRASP = 20.0
"""Grasp force that makes a ball smallest where it states none, as `world.components.robot.Ball` [N]."""
_ABOVE_LEAST = 1.25
"""Smallest ratio of the largest right grip to the least."""


class Change(NamedTuple):
    """One number of a scene that was fitted.

    Attributes:
        name: What it is, such as "paths".
        value: Its new value.
        before: As the scene has it.
        unit: "" for a factor.
        meaning: In a sentence.
    """

    name: str
    value: float
    before: float
    unit: str
    meaning: str


def fitted(document: _Document, fit: Fit) -> dict[str, Any]:
    """Return a resolved scene with what fits a person, and the list of what was changed; a calibration stays."""
    result: dict[str, Any] = copy.deepcopy(dict(document))
    if "calibration" in (result.get("task") or {}):
        return result
    changes, factor = list[Change](), _factor(result, fit)
    if factor != 1.0:
        changes.append(Change("paths", factor, 1.0, "", "Factor on the paths of the task, by the range of motion"))
        rest = _rest(result)
        for holder, key in list(_places(result)):
            holder[key] = [at + factor * (value - at) for value, at in zip(holder[key], rest, strict=True)]
        for holder, key in _widths(result):
            width = holder[key]
            holder[key] = [factor * each for each in width] if isinstance(width, list) else factor * width
    for change, holder, key in list(_changed(result, fit)):
        holder[key] = change.value
        changes.append(change)
    if fit.volume != 1.0:
        changes.append(Change("volume", fit.volume, 1.0, "", "Factor on the volume, by the hearing"))
    if changes:
        result[FITTED] = [change._asdict() for change in changes]
    return result


_Changed = Iterator[tuple[Change, dict[Any, Any], object]]
"""Single numbers that are fitted, and where each is."""


def _changed(document: _Document, fit: Fit) -> _Changed:
    if fit.grip is not None:
        yield from _grips(document, fit.grip)
    if fit.reaches:
        yield from _deflections(document.get("task") or {}, min(fit.reaches.values()))
    if fit.walking is not None:
        yield from _speeds(document, max(fit.walking, _LEAST_SPEED))
    for entity in document["entities"]:
        board = entity["components"].get("hud")
        if board is not None and fit.text > float(board.get("enlarged", 1.0)):
            meaning = "Factor on the size of text, by the letters that are read, or as the person wants it"
            yield Change("text", fit.text, float(board.get("enlarged", 1.0)), "", meaning), board, "enlarged"


def _grips(document: _Document, most: float) -> _Changed:
    grip = ((document.get("task") or {}).get("carry") or {}).get("grip") or {}
    right = max(most, _ABOVE_LEAST * float(grip.get("least", 0.0)))
    if right < float(grip.get("most", 0.0)):
        meaning = "Largest right grip, by the grip strength"
        yield Change("grip", right, grip["most"], "N", meaning), grip, "most"
    for entity in document["entities"]:
        ball = entity["components"].get("ball")
        full = 0.0 if ball is None else float(ball.get("grasp_force_full", _FULL_GRASP))
        if ball is not None and most < full:
            meaning = "Grip that makes the ball smallest, by the grip strength"
            yield Change("squeeze", most, full, "N", meaning), ball, "grasp_force_full"


def _deflections(task: _Document, most: float) -> _Changed:
    for walk in _WALKS:
        section, full = task.get(walk), max(most, _LEAST_DEFLECTION)
        if section is not None and full < float(section.get("deflection", _DEFLECTION)):
            before, meaning = float(section.get("deflection", _DEFLECTION)), "Full deflection of the hand, by its range"
            yield Change("deflection", full, before, "m", meaning), section, "deflection"


def _speeds(document: _Document, most: float) -> _Changed:
    """Yield the speeds of walks that are faster than a person walks comfortably [m/s]."""
    task = document.get("task") or {}
    sections = {kind.name: kind.section for kind in task_kinds() if kind.section is not None}
    usual = {walk: {field.name: field.default for field in fields(sections[walk])} for walk in _WALKS}
    for walk in _WALKS:
        section = task.get(walk)
        before = 0.0 if section is None else float(section.get("fastest", usual[walk]["fastest"]))
        if section is not None and most < before:
            meaning = "Speed at full deflection of the hand, by the walking speed"
            yield Change("speed", most, before, "m/s", meaning), section, "fastest"
    for entity in document["entities"]:
        legs = entity["components"].get("joint_reference")
        pace = 0.0 if legs is None else float(legs.get("speed", JointReference().speed))
        if legs is not None and most < pace:
            meaning = "Speed of the legs that are led, by the walking speed"
            yield Change("pace", most, pace, "m/s", meaning), legs, "speed"


def _factor(document: _Document, fit: Fit) -> float:
    """Return the factor with which the paths stay within a person's reach, at most 1."""
    rest, factor = _rest(document), 1.0
    ways = [[value - at for value, at in zip(holder[key], rest, strict=True)] for holder, key in _places(document)]
    for name, direction in DIRECTIONS.items():
        needed = max((sum(a * b for a, b in zip(direction, way, strict=True)) for way in ways), default=0.0)
        if name in fit.reaches and needed > 0.0:
            factor = min(factor, fit.reaches[name] / needed)
    return max(factor, min(fit.least_reach, 1.0))


def _rest(document: _Document) -> list[float]:
    """Return where the hand rests: the middle of the robot's workspace, world [m]."""
    for entity in document["entities"]:
        robot = entity["components"].get("robot")
        if robot is not None:
            return [float(value) for value in robot.get("robot_to_world", {}).get("translation", (0.0, 0.0, 0.0))]
    return [0.0, 0.0, 0.0]


def _named(document: _Document) -> list[dict[str, Any]]:
    """Return the entities that are scaled: those that the task's `fitting` names."""
    fitting = (document.get("task") or {}).get("fitting") or {}
    return [entity for entity in document["entities"] if entity["id"] in fitting.get("entities", ())]


def _widths(document: _Document) -> Iterator[_Slot]:
    """Yield each radius that is scaled with the places; one that is not stated is the component's own, and stays."""
    for entity in _named(document):
        for name, keys in _WIDTHS.items():
            component = entity["components"].get(name) or {}
            yield from ((component, key) for key in keys if key in component)


def _places(document: _Document) -> Iterator[_Slot]:
    """Yield each place to which the task takes the hand, of a scene whose task has `fitting`."""
    task = document.get("task") or {}
    if not isinstance(task.get("fitting"), dict):
        return
    for entity in _named(document):
        if "translation" in entity["transform"]:
            yield entity["transform"], "translation"
        for component in entity["components"].values():
            points = component.get("control_points") if isinstance(component, dict) else None
            yield from ((cast("dict[Any, Any]", points), number) for number in range(len(points or ())))
    yield from ((goal, "position_world") for goal in task.get("goals", ()) if "position_world" in goal)
    for name in _BOXES:
        box = (task.get("carry") or {}).get(name)
        yield from ((box, end) for end in ("low", "high") if box is not None)
