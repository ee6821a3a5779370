"""Registry of component types, systems and sections of scenes, and of the checks of their values.

Packages above `world` register their own on import, so that one validator serves `mimics check` and `mimics run`.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

import msgspec

from mimics_app.contracts.errors import Issue
from mimics_app.world.components.checked_scene import CheckedScene

__all__ = [
    "Component",
    "ComponentCheck",
    "Section",
    "SectionCheck",
    "check_of_system",
    "checks_of",
    "component",
    "component_types",
    "limits",
    "register_check",
    "register_component",
    "register_section",
    "register_system",
    "section_of",
    "system_types",
]


class Component(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Base of all structs of a scene file: immutable, no unknown fields, SI units."""


ComponentCheck = Callable[[Any, str, Any], list[Issue]]
"""(struct, pointer into the resolved scene, scene) -> faults; make them with `scene.issue(pointer + "/field", ...)`."""

SectionCheck = Callable[[Any, Any], list[Issue]]
"""(struct, scene) -> faults of a section such as `task`, or of a system."""


class Section(msgspec.Struct, frozen=True):
    """A top-level section of the scene file, owned by a stage."""

    type: type[msgspec.Struct]
    check: SectionCheck | None


_components: dict[str, type[msgspec.Struct]] = {}
_systems: dict[str, type[msgspec.Struct]] = {}
_sections: dict[str, Section] = {}
_checks: dict[str, list[ComponentCheck]] = {}
_limits: dict[str, int] = {}
_system_checks: dict[str, SectionCheck | None] = {}

S = TypeVar("S", bound=type[msgspec.Struct])


def register_component(name: str, struct: type[msgspec.Struct]) -> None:
    """Register component type `name`; raise ValueError where another type has that name."""
    _add(_components, "component", name, struct)


def component(name: str, *, limit: int | None = None, once: bool = False) -> Callable[[S], S]:
    """Class decorator: register a Struct as component type `name`.

    Args:
        name: Key in scene files.
        limit: Maximum number of them in a scene, counted before any is decoded; None: no limit of its own.
        once: True for a component that the application reads once: a second one, which would be ignored, is a fault.
    """

    def decorate(struct: S) -> S:
        register_component(name, struct)
        if limit is not None:
            _limits[name] = limit
        if once:
            register_check(name, _check_once)
        return struct

    return decorate


def register_system(name: str, struct: type[msgspec.Struct], check: SectionCheck | None = None) -> None:
    """Register type and check of the settings of system `name`; raise ValueError where another type has that name."""
    _add(_systems, "system", name, struct)
    _system_checks[name] = check


def register_section(name: str, struct: type[msgspec.Struct], check: SectionCheck | None = None) -> None:
    """Register the type and check of the top-level section `name`, e.g. "task"; a later call replaces them."""
    _sections[name] = Section(struct, check)


def register_check(component_type: str, check: ComponentCheck) -> None:
    """Register a check of every component of this type, run once the whole scene is decoded; idempotent."""
    checks = _checks.setdefault(component_type, [])
    if check not in checks:
        checks.append(check)


def limits() -> dict[str, int]:
    """Return the maximum number of components of a scene, by type; other types have no limit of their own."""
    return dict(_limits)


def component_types() -> dict[str, type[msgspec.Struct]]:
    """Return every component type by name."""
    return dict(_components)


def system_types() -> dict[str, type[msgspec.Struct]]:
    """Return the type of every system's settings by name."""
    return dict(_systems)


def section_of(name: str) -> Section | None:
    """Return the registered top-level section, or None."""
    return _sections.get(name)


def check_of_system(name: str) -> SectionCheck | None:
    """Return the check of a system's settings, or None."""
    return _system_checks.get(name)


def checks_of(component_type: str) -> list[ComponentCheck]:
    """Return the checks of one component type, in order of registration."""
    return list(_checks.get(component_type, ()))


def _check_once(own: msgspec.Struct, pointer: str, scene: CheckedScene) -> list[Issue]:
    first = scene.components(type(own))[0][2]
    if pointer == first:
        return []
    name = pointer.rpartition("/")[2]
    return [scene.issue(pointer, f'a second "{name}"; the first is {scene.place(first)}', "keep one")]


def _add(table: dict[str, type[msgspec.Struct]], kind: str, name: str, struct: type[msgspec.Struct]) -> None:
    if table.setdefault(name, struct) is not struct:
        raise ValueError(f'{kind} "{name}" is registered twice')
