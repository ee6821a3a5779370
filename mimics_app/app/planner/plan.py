"""The planner: per group of methods the cheapest one whose measured error is within the scene's tolerance.

It reads a table of figures and measures nothing, so a plan is the same on every machine and at every start: the shipped
table (`assets/methods.json`), or the one a person saved on this machine with `mimics lab measure --save`. What it
chooses is what runs: `settle` writes it into the scene before anything is built from it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import msgspec

from mimics_app.app.planner.tolerances import FIELD_OF_UNIT, tolerances_of
from mimics_app.app.settings import Profile
from mimics_app.lab.table import Row, Table
from mimics_app.world.components.robot import Admittance, Tunnel
from mimics_app.world.components.systems import AudioSettings, HapticSettings
from mimics_app.world.components.visible import Sound
from mimics_app.world.scene.scene import Scene

__all__ = ["USES", "Choice", "Plan", "Use", "choose", "load_table", "plan_scene", "settle"]


@dataclass(frozen=True, slots=True)
class Use:
    """What a scene uses a group of methods for.

    Attributes:
        what: In words.
        needs: The component without which a scene has no use for it.
        named: The method a scene names; "" where it leaves the choice to the planner.
    """

    what: str
    needs: type[msgspec.Struct]
    named: Callable[[Scene], str]


def _named_projection(scene: Scene) -> str:
    haptic = scene.systems.get("haptic")
    return haptic.projection if isinstance(haptic, HapticSettings) and haptic.projection != "auto" else ""


def _named_form(scene: Scene) -> str:
    found = scene.components(Admittance)
    return found[0][1].form if found else Admittance().form


def _named_spatialiser(scene: Scene) -> str:
    audio = scene.systems.get("audio")
    if not isinstance(audio, AudioSettings) or audio.hrtf == "auto":
        return ""
    return "hrtf" if audio.hrtf else "stereo"


USES: Mapping[str, Use] = {
    "tunnel projection": Use("closest point of the tunnel's bisector", Tunnel, _named_projection),
    "tunnel frame": Use("frame carried along the bisector", Tunnel, lambda _: "double reflection"),
    "admittance form": Use("motion of the virtual mass", Tunnel, _named_form),
    "spatialiser": Use("direction of sounds", Sound, _named_spatialiser),
}
"""Groups the planner knows, by name. A method named for every scene alike is one the compiled tick has no rival of."""


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
    """

    group: str
    what: str
    taken: Row
    tolerance: float
    refused: Row | None
    planner: Row | None = None


@dataclass(frozen=True, slots=True)
class Plan:
    """What a scene runs.

    Attributes:
        profile: Whose tolerances hold where the scene states none.
        tolerances: By field of `systems.tolerances`.
        table: The figures it was chosen by.
        origin: Where those are from: "shipped", "saved" on this machine, or "given" by the caller.
        choices: In the order of `USES`; only groups the scene has a use for.
    """

    profile: Profile
    tolerances: Mapping[str, float]
    table: Table
    origin: str
    choices: tuple[Choice, ...]

    @property
    def methods(self) -> dict[str, str]:
        """Name of the method that runs, by group."""
        return {choice.group: choice.taken.method for choice in self.choices}


def choose(rivals: Sequence[Row], tolerance: float) -> Row:
    """The cheapest rival whose error is within the tolerance; where none is, the most accurate.

    Of equally cheap ones the more accurate, then the first by name, so that the order of the table decides nothing.
    """
    inside = [rival for rival in rivals if rival.error <= tolerance]
    if inside:
        return min(inside, key=lambda rival: (rival.cost_us, rival.error, rival.method))
    return min(rivals, key=lambda rival: (rival.error, rival.cost_us, rival.method))


def load_table() -> tuple[Table, str]:
    """The figures to plan by, and where they are from: "shipped", or "saved" where this machine measured itself.

    A saved table that holds some groups only stands before the shipped one.
    """
    shipped, saved = Table.load_shipped(), Table.load_saved()
    return (shipped, "shipped") if saved is None else (shipped.with_groups(saved), "saved")


def plan_scene(scene: Scene, profile: Profile, table: Table | None = None) -> Plan:
    """Choose for every group the scene has a use for; reads the table of this installation unless one is given."""
    table, origin = load_table() if table is None else (table, "given")
    tolerances = tolerances_of(scene, profile)
    choices = [
        _choice(scene, group, use, table.groups[group], tolerances)
        for group, use in USES.items()
        if group in table.groups and scene.components(use.needs)
    ]
    return Plan(profile, tolerances, table, origin, tuple(choices))


def _choice(scene: Scene, group: str, use: Use, rivals: Sequence[Row], tolerances: Mapping[str, float]) -> Choice:
    tolerance = tolerances[FIELD_OF_UNIT[rivals[0].unit]]
    best = choose(rivals, tolerance)
    named = use.named(scene)
    taken = next((rival for rival in rivals if rival.method == named), best) if named else best
    if named and taken.method != named:  # it runs all the same, whatever this table knows of it
        taken = Row(named, math.nan, math.nan, math.nan, rivals[0].unit)
    cheaper = [rival for rival in rivals if rival.cost_us < taken.cost_us and not rival.error <= tolerance]
    refused = max(cheaper, key=lambda rival: rival.cost_us, default=None)
    return Choice(group, use.what, taken, tolerance, refused, None if best == taken else best)


def settle(scene: Scene, profile: Profile) -> Plan:
    """Plan a scene and write the choice into it: whatever is built from the scene afterwards runs the plan."""
    plan = plan_scene(scene, profile)
    scene.methods = plan.methods
    return plan
