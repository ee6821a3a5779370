"""Orders of the task to each channel of rendering: what changes in a frame, under keys with a type.

A key is declared once, by whoever shows or feels it, and imported by whoever orders it: a `Feature` of the picture, a
`HapticField` of the parameter block. A scene file names the same by text, which `Feature.read` and `haptic_field` read.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Generic, NamedTuple, TypeVar, cast

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.errors import UsageError

__all__ = [
    "CONTROLLER",
    "TARGET",
    "TRIAL",
    "Feature",
    "HapticField",
    "HapticOrder",
    "Numbers",
    "Shown",
    "VisualOrder",
    "haptic_field",
    "shown",
]

T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class Feature(Generic[T]):
    """Something of a channel that a task may change.

    Attributes:
        name: Its name; in a scene file behind "visual." or "audio.".
        default: Its value until something is ordered; its type is that of all values, where it is no None.
    """

    name: str
    default: T

    def read(self, value: object) -> T:
        """Return a value of this feature; a whole number counts as any number, and a number as yes or no.

        Raises:
            UsageError: The value has another type.
        """
        kind = type(self.default)
        if kind is float and isinstance(value, int | float):
            return cast("T", float(value))
        if kind is bool and isinstance(value, int | float):
            return cast("T", bool(value))
        if self.default is None or isinstance(value, kind):
            return cast("T", value)
        raise UsageError(f'"{self.name}" = {value!r} is refused: it takes a {_KINDS.get(kind, kind.__name__)}')


_KINDS = {float: "number", bool: "yes or no", str: "word"}


class HapticField(NamedTuple):
    """A number of the haptic scene, or a vector.

    Attributes:
        field: Name of the field.
        table: Table of rows, as "bodies"; "tunnel": the task's own tunnel; "": the parameter block itself.
        entity: Entity of the row; "" for the block and the task's own tunnel.
    """

    field: str
    table: str = ""
    entity: str = ""

    def __str__(self) -> str:
        return ".".join(part for part in (self.table, self.entity, self.field) if part)


def haptic_field(text: str) -> HapticField:
    """Return the field of a dotted name: "virtual_mass", "tunnel.stiffness", "bodies.apple.mass"."""
    *groups, name = text.removeprefix("haptic.").split(".")
    table, entity = [*groups, "", ""][:2] if groups else ("", "")
    return HapticField(name, table, ".".join(groups[1:]) or entity)


CONTROLLER, TARGET, TRIAL = HapticField("controller"), HapticField("target"), HapticField("trial")
"""What the task manager alone orders: the slot of the controller, where it drives to, and the number of the trial."""

Numbers = float | Sequence[float] | NDArray[np.float64]
"""A number, or those of a vector."""


@dataclass(frozen=True, slots=True)
class HapticOrder:
    """New numbers of the haptic scene; fields that are not named keep theirs.

    Attributes:
        numbers: Numbers by field.
        obstacle: Obstacle that the controller is to begin, by name; "" for none.
    """

    numbers: Mapping[HapticField, Numbers] = field(default_factory=dict)
    obstacle: str = ""


def shown(values: Mapping[Feature[Any], object]) -> dict[Feature[Any], Any]:
    """Return values of features, each of its feature's type.

    Raises:
        UsageError: A value has another type than its feature.
    """
    return {each: each.read(value) for each, value in values.items()}


@dataclass(frozen=True, slots=True)
class VisualOrder:
    """New values of features of the scenario; features that are not named keep theirs.

    Attributes:
        values: Values by feature, each of the type of its feature, see `shown`.
    """

    values: Mapping[Feature[Any], Any] = field(default_factory=dict)

    def has(self, feature: Feature[Any]) -> bool:
        """Whether a value of a feature is ordered."""
        return feature in self.values

    def get(self, feature: Feature[T]) -> T | None:
        """Return the value that is ordered of a feature, None for none.

        Raises:
            UsageError: It has another type than the feature.
        """
        return feature.read(self.values[feature]) if feature in self.values else None


class Shown:
    """Present values of a scenario's features.

    Args:
        features: The features; the others of an order are not followed.
    """

    def __init__(self, features: Iterable[Feature[Any]]) -> None:
        self._values: dict[Feature[Any], Any] = {each: each.default for each in features}

    def follow(self, order: VisualOrder) -> None:
        """Take the values of an order."""
        self._values.update({each: order.get(each) for each in self._values if order.has(each)})

    def __getitem__(self, feature: Feature[T]) -> T:
        return cast("T", self._values[feature])
