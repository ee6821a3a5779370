"""Force fields by name: built-in ones, those a scenario brings, and plug-ins of the group mimics_app.force_fields.

A field is a compiled function of the signature `contracts.loop_ports.FIELD`.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib.metadata import entry_points
from typing import TYPE_CHECKING, Any

import numpy as np

from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.errors import Issue, nearest
from mimics_app.contracts.loop_ports import FIELD, FIELD_PARAMETERS
from mimics_app.world.components.objects import ForceField
from mimics_app.world.scene.scene import Scene

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

__all__ = ["ENTRY_POINT_GROUP", "Field", "add_field", "check_field", "field_names", "find_field"]

Field = Callable[[Vec, Vec, Vec, float, Vec], None]

ENTRY_POINT_GROUP = "mimics_app.force_fields"


_BUILT_IN = ("cord", "curl", "saddle", "well")
"""Fields of `cord_field` and `standard_fields`, which are imported and compiled when one of theirs is requested."""

_FIELDS: dict[str, Field] = {}
"""Fields that were added, or requested, by name."""


def add_field(name: str, field: Field) -> None:
    """Let scenes use a field of a scenario: a function compiled with `typed_kernel(FIELD)`.

    Raises:
        ValueError: another one has that name.
    """
    if name in _BUILT_IN or _FIELDS.setdefault(name, field) is not field:
        raise ValueError(f'force field "{name}" is there twice')


def field_names() -> list[str]:
    """Names of all fields that can be requested."""
    return sorted({*_BUILT_IN, *_FIELDS, *(point.name for point in entry_points(group=ENTRY_POINT_GROUP))})


def find_field(name: str) -> Field:
    """The compiled function of that name.

    Raises:
        KeyError: there is none; the message names the nearest.
        ValueError: its plug-in cannot be imported, it is no compiled field, or a trial call raised.
    """
    if name in _BUILT_IN:
        return _built_in(name)
    if name not in _FIELDS:
        points = {point.name: point for point in entry_points(group=ENTRY_POINT_GROUP)}
        if name not in points:
            raise KeyError(f'no force field "{name}"; {nearest(name, field_names())}')
        _FIELDS[name] = _tried(_loaded(points[name]))
    return _FIELDS[name]


def check_field(field: ForceField, pointer: str, scene: Scene) -> list[Issue]:
    """Faults of the function a scene names: find it, compile it, and call it once."""
    try:
        find_field(field.function)
    except (KeyError, ValueError) as error:
        what, _, fix = str(error.args[0]).partition("; ")
        return [scene.issue(f"{pointer}/function", what, fix)]
    return []


def _built_in(name: str) -> Field:
    if name == "cord":
        from mimics_app.rendering.haptic.cord_field import cord

        return cord
    from mimics_app.rendering.haptic import standard_fields

    return getattr(standard_fields, name)


def _loaded(point: EntryPoint) -> object:
    try:
        return point.load()
    except Exception as error:
        raise ValueError(f'the plug-in of "{point.name}" cannot be loaded: {type(error).__name__}: {error}') from error


def _tried(field: Any) -> Field:
    """A field that has the signature and does not raise where nothing is special."""
    compiled = getattr(field, "nopython_signatures", [])
    if FIELD not in compiled:
        raise ValueError("it is not compiled for the loop; decorate it with typed_kernel(FIELD)")
    try:
        field(np.zeros(FIELD_PARAMETERS), np.full(3, 0.01), np.full(3, 0.1), 0.0, np.zeros(3))
    except Exception as error:  # noqa: BLE001  anything it raises would end the loop
        raise ValueError(
            f"it raises {type(error).__name__}, which would end the loop; return a force instead"
        ) from None
    return field
