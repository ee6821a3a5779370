"""Methods of other packages, and what scenes use a group of methods for.

A package offers entry points of the group `mimics_app.methods` (name: its own, object: a `MethodPlugin`): rivals for a
group that is there, or a group of its own with what scenes use it for. They are measured and drawn by `mimics lab`
beside the built-in ones, and the planner takes them where they are the cheapest within a scene's tolerance; who runs
them reads `Scene.methods`.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from importlib.metadata import entry_points

from mimics_app.contracts.method_table import Row
from mimics_app.contracts.methods import Registry, Settings
from mimics_app.world.scene.scene import Scene

__all__ = ["ENTRY_POINT_GROUP", "MethodPlugin", "Use", "fault_of_method", "method_plugins"]

ENTRY_POINT_GROUP = "mimics_app.methods"


def _anything(scene: Scene, settings: Settings) -> bool:
    return True


def _one(scene: Scene) -> int:
    return 1


def _nothing_named(scene: Scene) -> Settings | None:
    return None


@dataclass(frozen=True, slots=True)
class Use:
    """What a scene uses a group of methods for.

    Attributes:
        what: In words.
        used: Whether a scene has a use for it.
        named: Settings of the method a scene names; None where it leaves the choice to the planner.
        allowed: Whether the planner may take a method, by its settings, for a scene that names none.
        pixels: Of the frame its costs were measured at [px], where they grow with the picture and are borne by the
            frame's budget; 0 where they are not.
        within: The part of `explain` whose cost holds this one's already; "" where it stands for itself.
        count: How many times a scene pays its cost in a tick, of a group of the haptic loop.
    """

    what: str
    used: Callable[[Scene], bool]
    named: Callable[[Scene], Settings | None] = _nothing_named
    allowed: Callable[[Scene, Settings], bool] = _anything
    pixels: int = 0
    within: str = ""
    count: Callable[[Scene], int] = _one


@dataclass(frozen=True, slots=True)
class MethodPlugin:
    """Methods of one group that a package brings.

    Attributes:
        group: Its name: one that is there, or a new one.
        register: Adds the methods to a registry, and describes the group where it is new. Called by the laboratory
            only, so what is compiled is imported in it.
        rows: What the package's author measured of those that can run: the planner's figures until this machine
            measures (`mimics lab measure --save`). Costs are taken by their ratio to the reference loop.
        use: Of a new group: what scenes use it for. None: the planner knows the group, or is not to choose in it.
    """

    group: str
    register: Callable[[Registry], None]
    rows: tuple[Row, ...] = ()
    use: Use | None = None


@cache
def method_plugins() -> tuple[MethodPlugin, ...]:
    """What installed packages bring, by the name of the entry point.

    One that cannot be imported, or is no `MethodPlugin`, is left out and said on stderr once.
    """
    found = list[MethodPlugin]()
    for point in sorted(entry_points(group=ENTRY_POINT_GROUP)):
        try:
            plugin = point.load()
        except Exception as error:  # noqa: BLE001  whatever a stranger's module does while it is imported
            sys.stderr.write(f'mimics: the methods "{point.name}" cannot be imported: {error}\n')
            continue
        if fault := fault_of_method(plugin):
            sys.stderr.write(f'mimics: the methods "{point.name}" are left out: {fault}\n')
            continue
        found.append(plugin)
    return tuple(found)


def fault_of_method(loaded: object) -> str:
    """Why this cannot be what a package brings; "" where it can."""
    return "" if isinstance(loaded, MethodPlugin) else f"its plug-in is no {__name__}.MethodPlugin"
