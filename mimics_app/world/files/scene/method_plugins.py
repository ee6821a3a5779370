"""Methods of other packages, and the uses scenes have for groups of methods.

A package offers entry points of the group `mimics_app.methods` (name: its own, object: a `MethodPlugin`): further
methods of an existing group, or a new group with its use. `mimics lab` measures and charts them beside the built-in
ones, and the planner takes them where they are the cheapest within a scene's tolerance; the code that runs them reads
`Scene.methods`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import cast

from mimics_app.contracts.errors import nearest
from mimics_app.contracts.ports.method_table import Row
from mimics_app.contracts.ports.methods import Registry, Settings
from mimics_app.contracts.ports.plugins import PluginGroup
from mimics_app.world.components.tolerance_units import FIELD_OF_UNIT
from mimics_app.world.files.scene.scene import Scene

__all__ = ["PLUGINS", "MethodPlugin", "Use", "method_plugins"]


def _anything(scene: Scene, settings: Settings) -> bool:
    return True


def _never(settings: Settings) -> bool:
    return False


def _one(scene: Scene) -> int:
    return 1


def _nothing_named(scene: Scene) -> Settings | None:
    return None


@dataclass(frozen=True, slots=True)
class Use:
    """Use of a group of methods in scenes.

    Attributes:
        what: Short description.
        used: Predicate: the scene uses the group.
        named: Settings of the method that a scene names; None where it leaves the choice to the planner.
        allowed: Predicate: the planner may take a method, by its settings, for a scene that names none.
        pixels: Size of the frame its costs were measured at [px], where they grow with it and count in the frame's
            budget; 0 where they do not.
        within: Part of `explain` whose cost includes this one's; "" where it counts on its own.
        count: Number of times a scene pays its cost in a tick, for a group of the haptic loop.
        only_live: Predicate: the planner takes a method, by its settings, only for live software rendering.
    """

    what: str
    used: Callable[[Scene], bool]
    named: Callable[[Scene], Settings | None] = _nothing_named
    allowed: Callable[[Scene, Settings], bool] = _anything
    pixels: int = 0
    within: str = ""
    count: Callable[[Scene], int] = _one
    only_live: Callable[[Settings], bool] = _never


@dataclass(frozen=True, slots=True)
class MethodPlugin:
    """Methods of one group, from another package.

    Attributes:
        group: Name of an existing group, or of a new one.
        register: Adds the methods to a registry, and describes the group where it is new. Only the laboratory calls
            it, so compiled code is imported inside it.
        rows: Measurements by the package's author, which the planner uses until this machine has its own
            (`mimics lab measure --save`). Costs are relative to the reference loop.
        use: Use of a new group, whose errors are in a unit that a tolerance bounds (`FIELD_OF_UNIT`). None: the planner
            knows the group, or does not choose in it.
    """

    group: str
    register: Callable[[Registry], None]
    rows: tuple[Row, ...] = ()
    use: Use | None = None


def _fault_of(_: str, loaded: object) -> str:
    if not isinstance(loaded, MethodPlugin):
        return f"is not a {__name__}.MethodPlugin"
    for row in loaded.rows:
        if loaded.use is not None and row.unit not in FIELD_OF_UNIT:
            return f'has errors in "{row.unit}", which no tolerance bounds; {nearest(row.unit, FIELD_OF_UNIT)}'
    return ""


PLUGINS = PluginGroup("mimics_app.methods", _fault_of)


@cache
def method_plugins() -> tuple[MethodPlugin, ...]:
    """Return the method plug-ins of installed packages, by name of the entry point.

    One that cannot be imported, or is not a `MethodPlugin`, is skipped and reported on stderr once.
    """
    return tuple(cast(MethodPlugin, plugin) for _, plugin in PLUGINS.load_sound("entry of methods"))
