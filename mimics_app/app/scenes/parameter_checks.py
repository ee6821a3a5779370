"""Check of a scene's haptic numbers as they will be written: at first, and at both ends of every parameter of its task.

Writes go through the parameter store, as in a session, so that `check`, a run and a write during it refuse the same.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping

from mimics_app.app.touch.haptic_scene_data import HapticSceneData
from mimics_app.app.touch.parameter_store import ParameterStore
from mimics_app.contracts.errors import DeviceError, Issue, UsageError
from mimics_app.rendering.haptic.block_check import check_values
from mimics_app.scenarios.parts.robot_scene import robot_block
from mimics_app.tasks.actions import settings_for
from mimics_app.tasks.kinds.tunnel.kind import own_tunnel
from mimics_app.tasks.scene_section import task_of
from mimics_app.tasks.task import ParameterSpec, TaskSpec
from mimics_app.world.components.robot import Robot
from mimics_app.world.files.reading.json_text import escape
from mimics_app.world.files.scene.scene import Scene

__all__ = ["check_parameters"]

_MOST_CORNERS = 256
"""Largest number of combinations of the parameters' ends that are tried; of more parameters each end on its own."""


def check_parameters(scene: Scene) -> list[Issue]:
    """Return the faults of numbers that depend on each other, such as two friction coefficients of one surface."""
    if not scene.components(Robot):
        return []
    try:
        block, rows, names = HapticSceneData(scene).parameters(robot_block(scene))
    except DeviceError:  # a device that does not exist is reported elsewhere
        return []
    if rows is not None and names.get("tunnels"):
        block[0]["own_tunnel"] = names["tunnels"][own_tunnel(scene)][0]
    try:
        check_values(block, rows)
    except ValueError as error:
        return [scene.issue("", str(error))]
    if scene.section(TaskSpec) is None:
        return []
    return list(_faults_of_parameters(task_of(scene), ParameterStore(block, rows, names), scene))


def _faults_of_parameters(task: TaskSpec, store: ParameterStore, scene: Scene) -> Iterator[Issue]:
    ends = {name: _ends(parameter) for name, parameter in task.parameters.items() if _is_haptic(parameter)}
    try:
        before = {name: store.value(name) for name in _settings(task, {name: each[0] for name, each in ends.items()})}
    except UsageError as error:  # a joint that the device does not have
        yield scene.issue("/task/parameters", error.what, error.fix)
        return
    for name, values in ends.items():
        for value in values:
            fault = _fault(store, _settings(task, {name: value}))
            store.change(before)
            if fault is not None:
                yield scene.issue(f"/task/parameters/{escape(name)}/maps", f"at {value:g}: {fault.what}", fault.fix)
                return
    if math.prod(len(values) for values in ends.values()) > _MOST_CORNERS:
        return
    for corner in itertools.product(*ends.values()):
        together = dict(zip(ends, corner, strict=True))
        fault = _fault(store, _settings(task, together))
        if fault is not None:
            text = ", ".join(f"{name} {value:g}" for name, value in together.items())
            yield scene.issue("/task/parameters", f"at {text}: {fault.what}", fault.fix)
            return


def _is_haptic(parameter: ParameterSpec) -> bool:
    return any(target.to.startswith("haptic.") for target in parameter.maps)


def _ends(parameter: ParameterSpec) -> list[float]:
    """Return the values between which every map of a parameter is linear."""
    steps = max((len(target.table) for target in parameter.maps if target.table), default=2) - 1
    return [parameter.min + (parameter.max - parameter.min) * k / max(1, steps) for k in range(steps + 1)]


def _settings(task: TaskSpec, values: Mapping[str, float]) -> Mapping[str, object]:
    return {str(field): value for field, value in settings_for(task, values).haptic.items()}


def _fault(store: ParameterStore, values: Mapping[str, object]) -> UsageError | None:
    try:
        store.change(values)
    except UsageError as error:
        return error
    return None
