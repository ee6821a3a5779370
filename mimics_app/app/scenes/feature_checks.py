"""Check that what the parameters of a scene's task change in the picture is something that its scenario shows."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from mimics_app.app.scenes.scenario_choice import features_of, is_playable
from mimics_app.contracts.errors import Issue, UsageError, nearest
from mimics_app.contracts.messages.orders import Feature
from mimics_app.tasks.task import MapSpec, TaskSpec
from mimics_app.world.files.reading.json_text import escape
from mimics_app.world.files.scene.scene import Scene

__all__ = ["check_features"]

_GROUP = "visual."


def check_features(scene: Scene) -> list[Issue]:
    """Return the faults of the maps to features: names that the scenario does not know, values that it does not take.

    Args:
        scene: The scene.
    """
    task = scene.section(TaskSpec)
    maps = [
        (f"/task/parameters/{escape(name)}/maps/{number}", target)
        for name, parameter in (task.parameters if task else {}).items()
        for number, target in enumerate(parameter.maps)
        if target.to.startswith(_GROUP)
    ]
    if not maps or not is_playable(scene):
        return []
    known = {each.name: each for each in features_of(scene)}
    return [issue for pointer, target in maps for issue in _faults(target, pointer, known, scene)]


def _faults(target: MapSpec, pointer: str, known: dict[str, Feature[Any]], scene: Scene) -> Iterator[Issue]:
    name = target.to.removeprefix(_GROUP)
    if name not in known:
        yield scene.issue(f"{pointer}/to", f'the scenario of this scene shows no "{name}"', nearest(name, known))
        return
    for value in target.table or [0.0]:
        try:
            known[name].read(value)
        except UsageError as error:
            yield scene.issue(f"{pointer}/{'table' if target.table else 'to'}", error.what, "write what it takes")
            return
