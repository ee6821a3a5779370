"""The planner: per group of methods the cheapest one whose measured error is within the scene's tolerance.

What refines a live picture must also be borne by its frame's time: half of it, shared out from what is missed most to
what is missed least. A study gives up no accuracy for time.

It reads a table of figures and measures nothing, so a plan is the same on every machine and at every start: the shipped
table (`assets/methods.json`), or the one a person saved on this machine with `mimics lab measure --save`. What it
chooses are settings, and they are what runs: `settle` writes them into the scene before anything is built from it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from mimics_app.app.planner.tolerances import tolerances_of
from mimics_app.app.planner.uses import uses
from mimics_app.app.settings import Profile
from mimics_app.contracts.method_table import Row, Table
from mimics_app.contracts.methods import Settings
from mimics_app.world.components.tolerance_units import FIELD_OF_UNIT
from mimics_app.world.scene.method_plugins import Use, method_plugins
from mimics_app.world.scene.scene import Scene

__all__ = ["ROOM", "Choice", "Costlier", "Plan", "choose", "load_table", "plan_scene", "settle"]


ROOM = 0.5
"""Share of a frame's time for what refines the picture; the other half is for the bodies themselves."""


@dataclass(frozen=True, slots=True)
class Costlier:
    """A more accurate rival that the frame's time does not bear.

    Attributes:
        row: Its figures.
        more_ms: What a frame would take longer than with the group's cheapest [ms].
        room_ms: What there was for it [ms].
    """

    row: Row
    more_ms: float
    room_ms: float


@dataclass(frozen=True, slots=True)
class Choice:
    """One group's outcome.

    Attributes:
        group: Of the table.
        what: What the scene uses it for.
        taken: The method that runs.
        tolerance: Largest accepted error, in the unit of the figures.
        refused: The nearest cheaper rival, whose error is beyond the tolerance; None where nothing cheaper is.
        planner: What the planner would take where the scene names another; None where they agree.
        costlier: What would be taken if the frame had the time; None where that does not decide.
        more_ms: What a frame takes longer than with the group's cheapest [ms]; 0 where no frame has to keep time.
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
    """What a scene runs.

    Attributes:
        profile: Whose tolerances hold where the scene states none.
        tolerances: By field of `systems.tolerances`.
        table: The figures it was chosen by.
        origin: Where those are from: "shipped", "saved" on this machine, or "given" by the caller.
        choices: In the order of `uses`; only groups the scene has a use for.
        pixels: Of the live picture it was made for [px]; 0 where no frame has to keep time.
    """

    profile: Profile
    tolerances: Mapping[str, float]
    table: Table
    origin: str
    choices: tuple[Choice, ...]
    pixels: int = 0

    @property
    def methods(self) -> dict[str, str]:
        """Name of the method that runs, by group: for people."""
        return {choice.group: choice.taken.method for choice in self.choices}

    @property
    def settings(self) -> dict[str, Settings]:
        """Settings of the method that runs, by group: what the product is set to."""
        return {choice.group: choice.taken.settings for choice in self.choices}

    @property
    def without_picture(self) -> Plan:
        """The plan less what is chosen only when a live picture is opened."""
        return replace(self, choices=tuple(choice for choice in self.choices if not uses()[choice.group].pixels))


def choose(rivals: Sequence[Row], tolerance: float, most_us: float = math.inf) -> Row:
    """The cheapest rival whose error is within the tolerance; where none is, the most accurate.

    Of equally cheap ones the more accurate, then the first by name, so that the order of the table decides nothing.

    Args:
        rivals: At least one.
        tolerance: Largest accepted error.
        most_us: What one may cost more than the cheapest [us]; others are passed over.
    """
    least = min(rival.cost_us for rival in rivals)
    borne = [rival for rival in rivals if rival.cost_us - least <= most_us]
    inside = [rival for rival in borne if rival.error <= tolerance]
    if inside:
        return min(inside, key=lambda rival: (rival.cost_us, rival.error, rival.method))
    return min(borne, key=lambda rival: (rival.error, rival.cost_us, rival.method))


def load_table() -> tuple[Table, str]:
    """The figures to plan by, and where they are from: "shipped", or "saved" where this machine measured itself.

    A saved table that holds some groups only stands before the shipped one. Methods of installed packages that are in
    neither stand with the figures their package brings.
    """
    shipped, saved = Table.load_shipped(), Table.load_saved()
    table, origin = (shipped, "shipped") if saved is None else (shipped.with_groups(saved), "saved")
    for plugin in method_plugins():
        table = table.with_rows(plugin.group, plugin.rows)
    return table, origin


def plan_scene(scene: Scene, profile: Profile, table: Table | None = None, pixels: int = 0) -> Plan:
    """Choose for every group the scene has a use for.

    Args:
        scene: What is planned.
        profile: Whose tolerances hold where the scene states none.
        table: None: that of this installation.
        pixels: Of a live picture whose frames have to keep time on the processor [px]; 0: pictures may take their
            time, or a driver draws them of which the table's costs say nothing.
    """
    table, origin = load_table() if table is None else (table, "given")
    tolerances = tolerances_of(scene, profile)
    room_ms = ROOM * tolerances["frame_ms"] if pixels and profile != "study" else math.inf
    choices = list[Choice]()
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
    """Time left in a frame for a group [ms], and the ratio of the picture's size to the table's."""

    room_ms: float
    scale: float

    @property
    def most_us(self) -> float:
        """Return the largest cost above the cheapest method, in terms of the table [us]."""
        return 1e3 * self.room_ms / self.scale if self.scale else math.inf

    def more_ms(self, row: Row, rivals: Sequence[Row]) -> float:
        """Return the added frame time of a method above the cheapest [ms]; 0 for a method not in the table."""
        more = row.cost_us - min(rival.cost_us for rival in rivals)
        return 0.0 if math.isnan(more) else 1e-3 * self.scale * more


def _choice(
    scene: Scene, group: str, use: Use, rows: Sequence[Row], tolerances: Mapping[str, float], budget: _Budget
) -> Choice:
    rivals = [row for row in rows if use.allowed(scene, row.settings)] or list(rows)
    tolerance = tolerances[FIELD_OF_UNIT[rows[0].unit]]
    best, wanted = choose(rivals, tolerance, budget.most_us), choose(rivals, tolerance)
    named = use.named(scene)
    taken = best if named is None else _row_of(named, rows)
    cheaper = [rival for rival in rivals if rival.cost_us < taken.cost_us and not rival.error <= tolerance]
    return Choice(
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
    """Return the row of a method that the scene names; without figures where the table has none."""
    label = ", ".join(f"{field} {value}" for field, value in named.items())
    unknown = Row(label, math.nan, math.nan, math.nan, rows[0].unit, named)
    return next((row for row in rows if row.settings == named), unknown)


def settle(scene: Scene, profile: Profile, plan: Plan | None = None) -> Plan:
    """Plan a scene, where no plan is given, and write the choice into it: whatever is built from it then runs the plan.

    What a live picture gives up for time is chosen when it is opened, as that depends on who draws it.
    """
    plan = plan or plan_scene(scene, profile)
    scene.methods = plan.settings
    return plan
