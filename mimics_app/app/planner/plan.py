"""The planner: it chooses from each group of methods the cheapest one whose measured error is within the tolerance.

Methods that refine a live picture must also fit into half of its frame time, in the order of `uses`. A study sacrifices
no accuracy for time.

The planner reads a table of costs and errors and measures nothing, so a plan is the same on every machine and at every
start: the shipped table (`assets/methods.json`), or the one saved on this machine with `mimics lab measure --save`. Its
results are settings, which `apply_plan` writes into the scene before anything is built from it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from mimics_app.app.planner.tolerances import tolerances_of
from mimics_app.app.planner.uses import uses
from mimics_app.app.settings import Profile
from mimics_app.contracts.ports.method_table import Row, Table
from mimics_app.contracts.ports.methods import Settings
from mimics_app.world.components.tolerance_units import FIELD_OF_UNIT
from mimics_app.world.files.scene.method_plugins import Use, method_plugins
from mimics_app.world.files.scene.scene import Scene

__all__ = ["ROOM", "Costlier", "Plan", "PlannedMethod", "apply_plan", "choose", "load_table", "plan_scene"]


ROOM = 0.5
"""Share of the frame time for methods that refine the picture; the other half is for drawing the objects."""


@dataclass(frozen=True, slots=True)
class Costlier:
    """A more accurate rival that the frame time does not allow.

    Attributes:
        row: Its row of the table.
        more_ms: Added frame time over the cheapest rival [ms].
        room_ms: Time that was available [ms].
    """

    row: Row
    more_ms: float
    room_ms: float


@dataclass(frozen=True, slots=True)
class PlannedMethod:
    """Choice from one group.

    Attributes:
        group: Group of the table.
        what: Purpose in the scene.
        taken: The method that runs.
        tolerance: Largest accepted error, in the unit of the row.
        refused: The nearest cheaper rival, whose error exceeds the tolerance; None without one.
        planner: The planner's choice where the scene names another method; None where they agree.
        costlier: The choice without a limit of the frame time; None where the limit does not decide.
        more_ms: Added frame time over the cheapest rival [ms]; 0 where the frame time is free.
    """

    group: str
    what: str
    taken: Row
    tolerance: float
    refused: Row | None
    planner: Row | None = None
    costlier: Costlier | None = None
    more_ms: float = 0.0


@dataclass(frozen=True, slots=True)
class Plan:
    """The methods that a scene runs.

    Attributes:
        profile: Profile whose tolerances hold where the scene states none.
        tolerances: Tolerance by field of `systems.tolerances`.
        table: The table of costs and errors.
        origin: Origin of the table: "shipped", "saved" on this machine, or "given" by the caller.
        choices: Choices in the order of `uses`, of the groups that the scene uses.
        pixels: Size of the live picture [px]; 0 where the frame time is free.
    """

    profile: Profile
    tolerances: Mapping[str, float]
    table: Table
    origin: str
    choices: tuple[PlannedMethod, ...]
    pixels: int = 0

    @property
    def methods(self) -> dict[str, str]:
        """Name of the method that runs, by group."""
        return {choice.group: choice.taken.method for choice in self.choices}

    @property
    def settings(self) -> dict[str, Settings]:
        """Settings of the method that runs, by group."""
        return {choice.group: choice.taken.settings for choice in self.choices}

    @property
    def without_picture(self) -> Plan:
        """The plan without the choices that are made when a live picture is opened."""
        return replace(self, choices=tuple(choice for choice in self.choices if not uses()[choice.group].pixels))


def choose(rivals: Sequence[Row], tolerance: float, most_us: float = math.inf) -> Row:
    """Return the cheapest rival whose error is within the tolerance; without one, the most accurate.

    Of equal costs the more accurate, then the first by name: the order of the table has no influence.

    Args:
        rivals: At least one rival.
        tolerance: Largest accepted error.
        most_us: Largest cost above the cheapest rival [us]; costlier ones are ignored.
    """
    least = min(rival.cost_us for rival in rivals)
    affordable = [rival for rival in rivals if rival.cost_us - least <= most_us]
    accurate = [rival for rival in affordable if rival.error <= tolerance]
    if accurate:
        return min(accurate, key=lambda rival: (rival.cost_us, rival.error, rival.method))
    return min(affordable, key=lambda rival: (rival.error, rival.cost_us, rival.method))


def load_table() -> tuple[Table, str]:
    """Return the table of this installation and its origin: "shipped", or "saved" where this machine was measured.

    The groups of a saved table replace those of the shipped one. Methods of installed packages that are in neither have
    the costs and errors stated by their package.
    """
    shipped, saved = Table.load_shipped(), Table.load_saved()
    table, origin = (shipped, "shipped") if saved is None else (shipped.with_groups(saved), "saved")
    for plugin in method_plugins():
        table = table.with_rows(plugin.group, plugin.rows)
    return table, origin


def plan_scene(
    scene: Scene, profile: Profile, table: Table | None = None, pixels: int = 0, *, limited: bool = True
) -> Plan:
    """Choose a method of every group that the scene uses.

    Args:
        scene: The scene.
        profile: Profile whose tolerances hold where the scene states none.
        table: Table of costs and errors; None: that of this installation.
        pixels: Size of a live picture drawn on the processor [px]; 0: the frame time is free, or a graphics card draws,
            for which the costs of the table do not hold.
        limited: False leaves the frame time of a live picture free, too.
    """
    table, origin = load_table() if table is None else (table, "given")
    tolerances = tolerances_of(scene, profile)
    room_ms = ROOM * tolerances["frame_ms"] if pixels and limited and profile != "study" else math.inf
    choices = list[PlannedMethod]()
    for group, use in uses().items():
        if _is_bounded(table.groups.get(group, ())) and use.used(scene):
            scale = pixels / use.pixels if use.pixels else 0.0
            choices.append(_choice(scene, group, use, table.groups[group], tolerances, _Budget(room_ms, scale)))
            room_ms = max(0.0, room_ms - choices[-1].more_ms)
    return Plan(profile, tolerances, table, origin, tuple(choices), pixels)


def _is_bounded(rows: Sequence[Row]) -> bool:
    """Whether a tolerance bounds the errors of a group; of one that this machine measured for a plug-in it may not."""
    return bool(rows) and rows[0].unit in FIELD_OF_UNIT


@dataclass(frozen=True, slots=True)
class _Budget:
    """Frame time left for a group [ms], and the ratio of the picture's size to that of the table."""

    room_ms: float
    scale: float

    @property
    def most_us(self) -> float:
        """Return the largest cost above the cheapest method, at the picture size of the table [us]."""
        return 1e3 * self.room_ms / self.scale if self.scale else math.inf

    def more_ms(self, row: Row, rivals: Sequence[Row]) -> float:
        """Return the added frame time of a method above the cheapest [ms]; 0 for a method not in the table."""
        more = row.cost_us - min(rival.cost_us for rival in rivals)
        return 0.0 if math.isnan(more) else 1e-3 * self.scale * more


def _choice(
    scene: Scene, group: str, use: Use, rows: Sequence[Row], tolerances: Mapping[str, float], budget: _Budget
) -> PlannedMethod:
    allowed = [row for row in rows if use.allowed(scene, row.settings)] or list(rows)
    rivals = [row for row in allowed if budget.scale or not use.only_live(row.settings)] or allowed
    tolerance = tolerances[FIELD_OF_UNIT[rows[0].unit]]
    best, wanted = choose(rivals, tolerance, budget.most_us), choose(rivals, tolerance)
    named = use.named(scene)
    taken = best if named is None else _row_of(named, rows)
    cheaper = [rival for rival in rivals if rival.cost_us < taken.cost_us and not rival.error <= tolerance]
    return PlannedMethod(
        group=group,
        what=use.what,
        taken=taken,
        tolerance=tolerance,
        refused=max(cheaper, key=lambda rival: rival.cost_us, default=None),
        planner=None if best == taken else best,
        costlier=None
        if named is not None or wanted == best
        else Costlier(wanted, budget.more_ms(wanted, rivals), budget.room_ms),
        more_ms=budget.more_ms(taken, rivals if named is None else rows),
    )


def _row_of(named: Settings, rows: Sequence[Row]) -> Row:
    """Return the row of a method that the scene names; with NaN where it is not in the table."""
    label = ", ".join(f"{field} {value}" for field, value in named.items())
    unknown = Row(label, math.nan, math.nan, math.nan, rows[0].unit, named)
    return next((row for row in rows if row.settings == named), unknown)


def apply_plan(scene: Scene, profile: Profile, plan: Plan | None = None) -> Plan:
    """Write a plan into the scene, so that everything built from it runs its methods; None: plan the scene first.

    Methods that depend on the frame time are chosen when a live picture is opened, because they depend on the driver.
    """
    plan = plan or plan_scene(scene, profile)
    scene.methods = plan.settings
    return plan
