"""Shipped scenes: name, group, what a person needs for each, and its duration, read from JSON without other imports."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from mimics_app.contracts.system.phrases import counted_phrase, phrase
from mimics_app.contracts.system.regular_file import read_regular
from mimics_app.contracts.system.resources import root

__all__ = [
    "GROUPS",
    "ONLY_LOOKED_AT",
    "ShippedScene",
    "find_shipped",
    "is_only_looked_at",
    "shipped_scenes",
    "thumbnail_of",
]

ONLY_LOOKED_AT = "none"
"""Scenario of a scene without a task, which is only looked at."""

GROUPS = {
    "tasks": phrase("Tasks"),
    "walks": phrase("Walks"),
    "examples": phrase("Examples"),
    "places": phrase("Places"),
}
"""Title of each group: scenes with a task, walks, examples of one feature each, scenes that are only looked at."""
_WALKS = ("city_walk", "canyon_walk", "soccer")
"""Scenes of the group "walks"."""

SIMULATED = "simulated_hapticmaster"
"""Robot of a scene that names none, the same as `world.components.robot.Robot` (a test compares them)."""

_FIRST = ("calibration", "wavy_tunnel", "pick_and_place", *_WALKS, "guided_walk")

_SECONDS = 60.0
"""Default duration of a trial [s], the same as `tasks.task.TaskSpec.time_limit_s` (a test compares them)."""

_SHIPPED = "mimics:"
"""Begins the URI of a shipped file, the same as `reading.paths.SHIPPED` (a test compares them)."""

_ANSWER_S, _PROBE_S = 10.0, 20.0
"""Typical time for an item of a questionnaire, and for the localisation probe [s]."""


@dataclass(frozen=True, slots=True)
class ShippedScene:
    """A scene of the installation; its fields are the keys of `mimics scenes --json`.

    Attributes:
        name: Name by which every command finds it, e.g. "free_objects".
        file: The scene file.
        title, description: Title and description of the scene for people.
        group: One of GROUPS.
        takes: Body part or tracker that a person plays it with.
        lasts: Number of trials and longest duration; "" without a task.
        device: Robot that it is made for; "" where it is only looked at.
        also: Devices of another shape for which it has other entities.
        limits: Limits that it sets beyond the usual ones; "" for none.
    """

    name: str
    file: Path
    title: str
    description: str
    group: str
    takes: str
    lasts: str
    device: str
    also: tuple[str, ...] = ()
    limits: str = ""


@cache
def shipped_scenes() -> tuple[ShippedScene, ...]:
    """Return all shipped scenes in the order of GROUPS; in each those of `_FIRST`, then the others by name."""
    found = [_describe(file) for file in _files()]
    groups = list(GROUPS)
    return tuple(sorted(found, key=lambda scene: (groups.index(scene.group), *_rank(scene.name))))


def _rank(name: str) -> tuple[int, str]:
    return (_FIRST.index(name) if name in _FIRST else len(_FIRST), name)


@cache
def find_shipped(name: str) -> ShippedScene | None:
    """Return the shipped scene of a name, the only one whose file is read; None where there is none."""
    return next((_describe(file) for file in _files() if file.stem == name), None)


def is_only_looked_at(file: Path) -> bool:
    """Whether a scene file has no task and is only looked at; False where the file cannot be read."""
    try:
        document = json.loads(read_regular(file))
    except (OSError, ValueError, RecursionError):
        return False
    return isinstance(document, dict) and document.get("scenario") == ONLY_LOOKED_AT


def thumbnail_of(name: str) -> Path:
    """Return the file of a shipped scene's thumbnail."""
    return root() / "assets" / "pictures" / "scenes" / f"{name}.jpg"


def _files() -> Iterator[Path]:
    folder = root() / "scenes"
    yield from folder.glob("*.json")
    yield from (folder / "examples").glob("*.json")


def _describe(file: Path) -> ShippedScene:
    document = json.loads(file.read_text(encoding="utf-8"))
    looked_at = document.get("scenario") == ONLY_LOOKED_AT
    group = "places" if looked_at else "examples" if file.parent.name == "examples" else "tasks"
    group = "walks" if file.stem in _WALKS else group
    return ShippedScene(
        name=file.stem,
        file=file,
        title=str(document.get("title", file.stem)),
        description=str(document.get("description", "")),
        group=group,
        takes=phrase("a look round") if looked_at else _takes(document),
        lasts="" if looked_at else _lasts(document.get("task") or {}),
        device="" if looked_at else next(iter(_devices(document)), SIMULATED),
        also=_also(document),
        limits=_limits(document),
    )


def _limits(document: Mapping[str, Any]) -> str:
    """Return the limits of the scene's own `safety` that are beyond the usual ones."""
    parts = (each.get("components", {}).get("safety") for each in document.get("entities", ()))
    stated = next((part for part in parts if part), None)
    if stated is None:
        return ""
    import msgspec

    from mimics_app.app.touch.ceilings import CEILINGS, asked_of, notes_on
    from mimics_app.world.components.robot import Safety

    asked = {name: bound.conservative for name, bound in CEILINGS.items()} | asked_of(msgspec.convert(stated, Safety))
    return ", ".join(line.partition(",")[0] for line in notes_on(asked, asked))


def _takes(document: Mapping[str, Any]) -> str:
    if "trackers" in document.get("systems", {}):
        return phrase("head and hands")
    return phrase("one leg" if any("leg" in device for device in _devices(document)) else "one hand")


def _devices(document: Mapping[str, Any]) -> list[str]:
    """Return the devices that the robots of a scene name."""
    robots = [each.get("components", {}).get("robot", {}) for each in document.get("entities", ())]
    return [robot["device"] for robot in robots if robot.get("device")]


def _also(document: Mapping[str, Any]) -> tuple[str, ...]:
    """Return the devices for which a scene, or a shipped part that it includes, has other entities."""
    parts = [root() / uri.removeprefix(_SHIPPED) for uri in document.get("include", ()) if uri.startswith(_SHIPPED)]
    documents = [document, *(json.loads(part.read_text(encoding="utf-8")) for part in parts)]
    return tuple(dict.fromkeys(name for each in documents for name in each.get("devices", {})))


def _lasts(task: Mapping[str, Any]) -> str:
    """Return the number of counted trials, and the longest duration of all trials with their rests."""
    blocks = task.get("trials") or [{}]
    if isinstance(blocks, str):
        return phrase("its own trials")
    limit, rest = float(task.get("time_limit_s", _SECONDS)), float(task.get("rest_s", 3.0))
    asked = [float(goal["seconds"]) for goal in task.get("goals", ()) if goal.get("kind") == "duration"]
    asked += _experiment(task.get("avatar_cord") or {})
    usual = min(max(asked), limit) if asked else limit
    trials = [
        (block.get("practice", False), float(trial.get("time_limit_s") or usual))
        for block in blocks
        for trial in block.get("trials", [{}]) * int(block.get("repetitions", 1))
    ]
    seconds = sum(length for _, length in trials) + rest * (len(trials) - 1)
    count = sum(not practice for practice, _ in trials)
    minutes = max(1, math.ceil(seconds / 60.0))
    if task.get("avatar_cord"):
        return counted_phrase("{n:d} trial, about {min:d} min", "{n:d} trials, about {min:d} min", count, min=minutes)
    if asked:
        return counted_phrase("{n:d} trial, {min:d} min", "{n:d} trials, {min:d} min", count, min=minutes)
    return counted_phrase("{n:d} trial, up to {min:d} min", "{n:d} trials, up to {min:d} min", count, min=minutes)


def _experiment(cord: Mapping[str, Any]) -> list[float]:
    """Return the duration of each condition of an experiment [s]: its phases, and a typical time for the answers."""
    answers = _ANSWER_S * len((cord.get("questionnaire") or {}).get("items", ()))
    return [
        float(condition.get("baseline_s", 5.0)) + float(condition.get("duration_s", 60.0)) + _PROBE_S + answers
        for condition in (cord.get("conditions") or {}).values()
    ]
