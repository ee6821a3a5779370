"""Mapping of parameter values to their targets: SCENE fields, scenario parameters, the mixer, the task itself."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Generic, TypeVar

import msgspec

from mimics_app.contracts.messages.action_space import ActionSpace, Parameter
from mimics_app.contracts.messages.orders import Feature, HapticField, Numbers, haptic_field
from mimics_app.contracts.messages.shared_fields import shared_fields
from mimics_app.tasks.kinds.registry import task_kinds
from mimics_app.tasks.task import MapSpec, ParameterSpec, TaskSpec

__all__ = [
    "TARGET_GROUPS",
    "ActionSpace",
    "Changes",
    "Settings",
    "build_action_space",
    "build_learning_space",
    "fill_defaults",
    "haptic_target",
    "settings_for",
    "task_targets",
]

TARGET_GROUPS = ("haptic", "visual", "audio", "task")
"""First words of `MapSpec.to`."""


_NEVER = object()

K = TypeVar("K")
V = TypeVar("V")


@dataclass(frozen=True, slots=True)
class Settings:
    """New values by target group; names without the first word of `MapSpec.to`."""

    haptic: Mapping[HapticField, Numbers] = field(default_factory=dict)
    visual: Mapping[Feature[Any], Any] = field(default_factory=dict)
    audio: Mapping[str, object] = field(default_factory=dict)
    task: Mapping[str, object] = field(default_factory=dict)


def task_targets() -> tuple[str, ...]:
    """Return the names that a parameter may change of the task itself."""
    return ("time_limit_s", "rest_s", "block", *(name for kind in task_kinds() for name in kind.targets))


def build_action_space(spec: TaskSpec) -> ActionSpace:
    """Return the action space of a task whose defaults have been filled in (`fill_defaults`)."""
    return ActionSpace(
        Parameter(
            name,
            low=p.min,
            high=p.max,
            **shared_fields(p, Parameter) | {"default": p.min if p.default is None else p.default},
        )
        for name, p in spec.parameters.items()
    )


def build_learning_space(spec: TaskSpec) -> ActionSpace:
    """Return the action space of a learning system: without the parameters that the therapist has vetoed."""
    return ActionSpace(p for p in build_action_space(spec) if not spec.parameters[p.name].veto)


def haptic_target(target: MapSpec) -> str:
    """Return the dotted name of the haptic field that a map writes without a table, "" for none."""
    group, _, name = target.to.partition(".")
    return name if group == "haptic" and target.table is None and target.scale != 0.0 else ""


def fill_defaults(spec: TaskSpec, value_of: Callable[[str], float]) -> TaskSpec:
    """Set the default of every parameter without one to the scene's value, clipped to its limits.

    Args:
        spec: The task.
        value_of: Function that returns the scene's value of a haptic field, e.g. "tunnel.stiffness".
    """
    parameters = dict(spec.parameters)
    for name, parameter in parameters.items():
        target = next((target for target in parameter.maps if haptic_target(target)), None)
        if parameter.default is None and target is not None:
            own = (value_of(haptic_target(target)) - target.offset) / target.scale
            default = min(max(own, parameter.min), parameter.max)
            parameters[name] = msgspec.structs.replace(parameter, default=default)
    return msgspec.structs.replace(spec, parameters=parameters)


def _map_value(value: float, parameter: ParameterSpec, target: MapSpec) -> float | str:
    """Return the value of one target: affine, or from its table (numbers interpolated, words of the nearest step)."""
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


def settings_for(
    spec: TaskSpec, values: Mapping[str, float], features: Mapping[str, Feature[Any]] | None = None
) -> Settings:
    """Return the target values of parameter values, by group.

    Args:
        spec: The task.
        values: Values of its parameters.
        features: What its scenario can show, by name; a map to anything else, which a check refuses, shows nothing.

    Raises:
        UsageError: A feature takes values of another type.
    """
    known = features or {}
    groups: dict[str, dict[Any, Any]] = {group: {} for group in TARGET_GROUPS}
    for name, value in values.items():
        parameter = spec.parameters[name]
        for target in parameter.maps:
            group, _, key = target.to.partition(".")
            mapped = _map_value(value, parameter, target)
            if group == "haptic":
                groups[group][haptic_field(key)] = mapped
            elif group != "visual":
                groups[group][key] = mapped
            elif key in known:
                groups[group][known[key]] = known[key].read(mapped)
    return Settings(**groups)


class Changes(Generic[K, V]):
    """Last value sent under each key."""

    def __init__(self) -> None:
        self._sent: dict[K, V] = {}
        self._last: Mapping[K, V] = {}

    def since_last(self, wanted: Mapping[K, V]) -> dict[K, V]:
        """Return the values that differ from those sent before; they count as sent. `wanted` stays as it is."""
        if wanted == self._last:
            return {}
        self._last = wanted
        changed = {name: value for name, value in wanted.items() if self._sent.get(name, _NEVER) != value}
        self._sent.update(changed)
        return changed
