"""From a parameter's value to what it changes: SCENE fields, scenario parameters, the mixer, the task itself."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import msgspec

from mimics_app.contracts.action_space import ActionSpace, Parameter
from mimics_app.tasks.kinds.registry import task_kinds
from mimics_app.tasks.task import MapSpec, ParameterSpec, TaskSpec

__all__ = [
    "TARGET_GROUPS",
    "ActionSpace",
    "Settings",
    "build_action_space",
    "build_learning_space",
    "fill_defaults",
    "haptic_field",
    "map_value",
    "settings_for",
    "task_targets",
]

TARGET_GROUPS = ("haptic", "visual", "audio", "task")
"""First words of `MapSpec.to`."""


@dataclass(frozen=True, slots=True)
class Settings:
    """New values by where they go; names without the first word of `MapSpec.to`."""

    haptic: Mapping[str, object] = field(default_factory=dict)
    visual: Mapping[str, object] = field(default_factory=dict)
    audio: Mapping[str, object] = field(default_factory=dict)
    task: Mapping[str, object] = field(default_factory=dict)


def task_targets() -> tuple[str, ...]:
    """What a parameter may change of the task itself."""
    return ("time_limit_s", "rest_s", "block", *(name for kind in task_kinds() for name in kind.targets))


def build_action_space(spec: TaskSpec) -> ActionSpace:
    """The limits of a scene's parameters, as learning sees them; defaults have been filled in (`fill_defaults`)."""
    return ActionSpace(
        Parameter(
            name,
            p.min if p.default is None else p.default,
            p.min,
            p.max,
            p.step,
            p.rate,
            p.unit,
            p.kind,
            p.harder,
            p.cost,
            p.dwell_s,
        )
        for name, p in spec.parameters.items()
    )


def build_learning_space(spec: TaskSpec) -> ActionSpace:
    """What a learning system may choose: the action space without what the therapist has vetoed."""
    return ActionSpace(p for p in build_action_space(spec) if not spec.parameters[p.name].veto)


def haptic_field(target: MapSpec) -> str:
    """Dotted name of the haptic field a map writes without a table, "" where it does not."""
    group, _, name = target.to.partition(".")
    return name if group == "haptic" and target.table is None and target.scale != 0.0 else ""


def fill_defaults(spec: TaskSpec, value_of: Callable[[str], float]) -> TaskSpec:
    """Give every parameter without a default the value the scene itself has, drawn into its limits.

    Args:
        spec: The task.
        value_of: The scene's value of a haptic field by dotted name, e.g. "tunnel.stiffness".
    """
    parameters = dict(spec.parameters)
    for name, parameter in parameters.items():
        target = next((target for target in parameter.maps if haptic_field(target)), None)
        if parameter.default is None and target is not None:
            own = (value_of(haptic_field(target)) - target.offset) / target.scale
            default = min(max(own, parameter.min), parameter.max)
            parameters[name] = msgspec.structs.replace(parameter, default=default)
    return msgspec.structs.replace(spec, parameters=parameters)


def map_value(value: float, parameter: ParameterSpec, target: MapSpec) -> float | str:
    """The value of one target: affine, or from its table (numbers interpolated, words at the nearest step)."""
    if target.table is None:
        return target.offset + target.scale * value
    last = len(target.table) - 1
    span = parameter.max - parameter.min
    place = (value - parameter.min) / span * last if span > 0.0 else 0.0
    place = min(max(place, 0.0), float(last))
    i = min(int(place), max(last - 1, 0))
    low, high = target.table[i], target.table[min(i + 1, last)]
    if isinstance(low, str) or isinstance(high, str):
        return target.table[round(place)]
    return low + (high - low) * (place - i)


def settings_for(spec: TaskSpec, values: Mapping[str, float]) -> Settings:
    """What the named parameter values change, by group."""
    groups: dict[str, dict[str, Any]] = {group: {} for group in TARGET_GROUPS}
    for name, value in values.items():
        parameter = spec.parameters[name]
        for target in parameter.maps:
            group, _, key = target.to.partition(".")
            groups[group][key] = map_value(value, parameter, target)
    return Settings(**groups)
