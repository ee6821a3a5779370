"""From a parameter's value to what it changes: SCENE fields, scenario parameters, the mixer, the task itself."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from mimics_app.contracts.action_space import ActionSpace, Parameter
from mimics_app.tasks.task import MapSpec, ParameterSpec, TaskSpec

__all__ = [
    "TARGET_GROUPS",
    "TASK_TARGETS",
    "ActionSpace",
    "Settings",
    "build_action_space",
    "map_value",
    "settings_for",
]

TARGET_GROUPS = ("haptic", "visual", "audio", "task")
"""First words of `MapSpec.to`."""

TASK_TARGETS = ("time_limit_s", "rest_s")
"""What a parameter may change of the task itself."""


@dataclass(frozen=True, slots=True)
class Settings:
    """New values by where they go; names without the first word of `MapSpec.to`."""

    haptic: Mapping[str, object] = field(default_factory=dict)
    visual: Mapping[str, object] = field(default_factory=dict)
    audio: Mapping[str, object] = field(default_factory=dict)
    task: Mapping[str, object] = field(default_factory=dict)


def build_action_space(spec: TaskSpec) -> ActionSpace:
    """The limits of a scene's parameters, as learning sees them."""
    return ActionSpace(
        Parameter(name, p.default, p.min, p.max, p.step, p.rate, p.unit) for name, p in spec.parameters.items()
    )


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
