"""What a scene may contain: component types, sections, and the checks that look at meaning.

Stages above `world` add their own at import time, so that one validator serves `mimics check` and `mimics run` alike.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TypeVar

import msgspec

from mimics_app.contracts.errors import Issue

if TYPE_CHECKING:
    from mimics_app.world.scene.scene import Scene

__all__ = [
    "Component",
    "ComponentCheck",
    "Section",
    "SectionCheck",
    "checks_of",
    "component",
    "component_types",
    "limits",
    "register_check",
    "register_component",
    "register_limit",
    "register_section",
    "register_system",
    "section_of",
    "system_types",
]


class Component(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Base of everything read from a scene file: immutable, no unknown fields, SI units."""


ComponentCheck = Callable[[Any, str, "Scene"], list[Issue]]
"""(struct, pointer into the resolved scene, scene) -> faults; make them with `scene.issue(pointer + "/field", ...)`."""

SectionCheck = Callable[[Any, "Scene"], list[Issue]]
"""(struct, scene) -> faults of a section such as `task`."""


class Section(msgspec.Struct, frozen=True):
    """A top-level section of the scene file that a stage owns."""

    type: type[msgspec.Struct]
    check: SectionCheck | None


_components: dict[str, type[msgspec.Struct]] = {}
_systems: dict[str, type[msgspec.Struct]] = {}
_sections: dict[str, Section] = {}
_checks: dict[str, list[ComponentCheck]] = {}
_limits: dict[str, int] = {}

S = TypeVar("S", bound=type[msgspec.Struct])


def register_component(name: str, struct: type[msgspec.Struct]) -> None:
    """Let scenes use component `name`; ValueError when another type has that name."""
    _add(_components, "component", name, struct)


def component(name: str) -> Callable[[S], S]:
    """Class decorator: let scenes use this Struct as component `name`."""

    def decorate(struct: S) -> S:
        register_component(name, struct)
        return struct

    return decorate


def register_system(name: str, struct: type[msgspec.Struct]) -> None:
    """Let scenes set system `name` under `systems`; ValueError when another type has that name."""
    _add(_systems, "system", name, struct)


def register_section(name: str, struct: type[msgspec.Struct], check: SectionCheck | None = None) -> None:
    """Give the top-level section `name` (e.g. "task") its type and the check of its meaning. The last one counts."""
    _sections[name] = Section(struct, check)


def register_check(component_type: str, check: ComponentCheck) -> None:
    """Have `check` look at every component of this type once the whole scene is decoded; twice registered is once."""
    checks = _checks.setdefault(component_type, [])
    if check not in checks:
        checks.append(check)


def register_limit(component_type: str, most: int) -> None:
    """Let no scene have more components of this type: counted before any of them is looked at."""
    _limits[component_type] = most


def limits() -> dict[str, int]:
    """Most components of a scene, by type; the others are as many as its entities."""
    return dict(_limits)


def component_types() -> dict[str, type[msgspec.Struct]]:
    """Every component type by name."""
    return dict(_components)


def system_types() -> dict[str, type[msgspec.Struct]]:
    """Every system's settings type by name."""
    return dict(_systems)


def section_of(name: str) -> Section | None:
    """What was registered for a top-level section, or None."""
    return _sections.get(name)


def checks_of(component_type: str) -> list[ComponentCheck]:
    """The checks of one component type, in the order they were registered."""
    return list(_checks.get(component_type, ()))


def _add(table: dict[str, type[msgspec.Struct]], kind: str, name: str, struct: type[msgspec.Struct]) -> None:
    if table.setdefault(name, struct) is not struct:
        raise ValueError(f'{kind} "{name}" is registered twice')
