"""Force fields by name: built-in ones, those of scenarios, and plug-ins of the group mimics_app.force_fields.

A field is a function compiled with the signature `contracts.loop.loop_ports.FIELD`.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import cast

import numpy as np

from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.errors import Issue, nearest
from mimics_app.contracts.loop.loop_ports import FIELD, FIELD_PARAMETERS
from mimics_app.contracts.ports.plugins import PluginError, PluginGroup
from mimics_app.world.components.objects import ForceField
from mimics_app.world.files.scene.scene import Scene

__all__ = ["PLUGINS", "Field", "add_field", "check_field", "find_field"]

Field = Callable[[Vec, Vec, Vec, float, Vec], None]


def _fault_of(_: str, field: object) -> str:
    """Check the field's signature, and call it once at an ordinary point."""
    if not callable(field) or FIELD not in getattr(field, "nopython_signatures", []):
        return "is not compiled for the loop; decorate it with typed_kernel(FIELD)"
    try:
        field(np.zeros(FIELD_PARAMETERS), np.full(3, 0.01), np.full(3, 0.1), 0.0, np.zeros(3))
    except Exception as error:  # noqa: BLE001  any exception would end the loop
        return f"raises {type(error).__name__}, which would end the loop; return a force instead"
    return ""


PLUGINS = PluginGroup("mimics_app.force_fields", _fault_of)

_BUILT_IN = ("cord", "curl", "saddle", "well")
"""Fields of `cord_field` and `standard_fields`, imported and compiled on request."""

_FIELDS: dict[str, Field] = {}
"""Fields of scenarios and loaded plug-ins, by name."""


def add_field(name: str, field: Field) -> None:
    """Register a field of a scenario, a function compiled with `typed_kernel(FIELD)`.

    Raises:
        ValueError: Another field has this name.
    """
    if name in _BUILT_IN or _FIELDS.setdefault(name, field) is not field:
        raise ValueError(f'there are two force fields "{name}"')


def _field_names() -> list[str]:
    """Return the names of all fields."""
    return sorted({*_BUILT_IN, *_FIELDS, *PLUGINS.names()})


def find_field(name: str) -> Field:
    """Return the compiled field of this name.

    Raises:
        KeyError: No such field; the message names the nearest.
        ValueError: The plug-in cannot be imported, is not a compiled field, or raises in a test call.
    """
    if name in _BUILT_IN:
        return _built_in(name)
    if name not in _FIELDS:
        if name not in PLUGINS.names():
            raise KeyError(f'no force field "{name}"; {nearest(name, _field_names())}')
        try:
            _FIELDS[name] = cast(Field, PLUGINS.load(name))
        except PluginError as error:
            raise ValueError(f'the force field "{name}" is not available: {error}') from error
    return _FIELDS[name]


def check_field(field: ForceField, pointer: str, scene: Scene) -> list[Issue]:
    """Return the faults of the field that a scene names: it is loaded and called once."""
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
