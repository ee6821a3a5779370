"""Carrying (D2.1 3.2.3): pick something up, bring it past obstacles, set it down at a mark."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Annotated, ClassVar, Literal

from msgspec import Meta, structs

from mimics_app.contracts.errors import Issue
from mimics_app.contracts.messages.board import Bar, Card, Tone
from mimics_app.contracts.messages.orders import HapticField, Numbers
from mimics_app.contracts.ports.scenario_port import TaskContext
from mimics_app.contracts.system.phrases import phrase
from mimics_app.tasks.cards import count_card
from mimics_app.tasks.kinds.carry.carried import Carried, CarriedFrame, Stage
from mimics_app.tasks.kinds.carry.report import CarrySection
from mimics_app.tasks.kinds.carry.spec import CarrySpec, GripSpec
from mimics_app.tasks.kinds.kind import Fault, KindPlay, Measure, TaskBlock, TaskKind, Values
from mimics_app.tasks.observation import Observation
from mimics_app.world.components.bounds import Seconds
from mimics_app.world.components.registry import Component

if TYPE_CHECKING:
    from mimics_app.world.files.scene.scene import Scene

__all__ = ["KIND", "PROMPTS", "CarryCondition", "CarryTask", "PlacedGoal"]

PROMPTS: Mapping[Stage, str] = {
    Stage.REACH: phrase("Go to the {body}"),
    Stage.CLOSE: phrase("Close your hand"),
    Stage.CARRY: phrase("Carry it to the mark"),
    Stage.OPEN: phrase("Open your hand"),
}
"""Line of text of each stage."""

_AT_POINTER: Mapping[Stage, str] = {
    Stage.CLOSE: phrase("Close your hand: turn the wheel up"),
    Stage.OPEN: phrase("Open your hand: turn the wheel down"),
}
"""Lines that differ for the mouse."""


_GRASP_ROOM = 1.4
"""Full scale of the grip's bar over the largest right force."""


class PlacedGoal(Component, frozen=True, tag="placed", tag_field="kind"):
    """Set down what `carry` names at its mark, and let it go."""

    hold_s: Annotated[Seconds, Meta(description="How long it must lie there [s].")] = 0.5


class CarryCondition(Component, frozen=True, tag="carry", tag_field="kind"):
    """Something happens to what is carried."""

    what: Annotated[
        Literal["gripped", "dropped", "bruised"],
        Meta(description="It came into the hand, was lost on the way, or was pressed too hard."),
    ]


class _CarryPlay(KindPlay):
    """Counts drops and bruises, and measures the grasp error while the object is carried."""

    def __init__(self, spec: CarrySpec, carried: Carried, *, by_pointer: bool = False) -> None:
        self._spec = spec
        self._prompts = {**PROMPTS, **_AT_POINTER} if by_pointer else PROMPTS
        self._carried = carried
        self._now = CarriedFrame()
        self._shows_stage = False
        self._squared_error_s = 0.0
        self._held_s = 0.0

    @property
    def orders(self) -> Mapping[HapticField, Numbers]:
        return self._carried.orders

    @property
    def words(self) -> Mapping[str, str]:
        return {"body": self._spec.body}

    @property
    def prompt(self) -> str:
        return self._prompts[self._now.stage] if self._shows_stage else ""

    @property
    def measures(self) -> Values:
        error = math.sqrt(self._squared_error_s / self._held_s) if self._held_s > 0.0 else None
        return {"drops": self._now.drops, "bruises": self._now.bruises, "grasp_error_n": error}

    def begin_attempt(self) -> None:
        self._carried.begin_attempt()
        self._now = CarriedFrame()
        self._squared_error_s = self._held_s = 0.0

    def see(self, seen: Observation, settings: Mapping[str, object]) -> Observation:
        within = settings.get("within", self._spec.within)
        self._carried.within = float(within) if isinstance(within, int | float) else self._spec.within
        now = self._carried.see(seen)
        self._shows_stage = now is not None
        if now is None:
            return seen
        self._now = now
        return structs.replace(seen, progress=now.progress, distance=now.distance)

    def travel(self, seen: Observation, seconds: float) -> None:
        if self._now.held:
            self._held_s += seconds
            self._squared_error_s += seconds * self._now.grasp_error**2

    def outcome_words(self, row: Mapping[str, object], *, finished: bool) -> str:
        body = self._spec.body.replace("_", " ")
        if finished:
            return phrase("The {body} is at its mark, in {seconds:.1f} s", body=body, seconds=row["time_s"])
        if self._carried.picked:
            return phrase("the {body} was not set down at its mark", body=body)
        return phrase("the {body} was not picked up", body=body)

    def way(self, goal: Component, seen: Observation) -> float:
        return self._carried.way(seen)

    def holds(self, goal: Component, seen: Observation) -> bool:
        return self._now.placed

    def happens(self, condition: Component, seen: Observation) -> bool:
        return isinstance(condition, CarryCondition) and bool(getattr(self._now, condition.what))

    def cards(self, seen: Observation, finished: int) -> Mapping[str, Card]:
        return {
            "grasp": _grasp_card(seen.grasp, self._spec.grip),
            "placed": count_card(phrase("Placed"), finished, width=130.0),
            "drops": count_card(phrase("Drops"), self._now.drops, width=120.0),
        }


def _grasp_card(newtons: float, grip: GripSpec) -> Card:
    """Return the card of the grasp force [N], with the range of right forces on its bar."""
    full = _GRASP_ROOM * grip.most if grip.most > 0.0 else 1.0
    right = grip.least <= newtons <= grip.most
    tone = Tone.CALM if right else Tone.ACCENT if newtons < grip.least else Tone.WARN
    return Card(phrase("Grip"), f"{newtons:.1f} N", bar=Bar(newtons, full, tone, (grip.least, grip.most)), width=250.0)


class CarryTask(TaskKind):
    """The built-in kind of tasks with a `carry` section."""

    name = "carry"
    section = CarrySpec
    goals: ClassVar[tuple[type[Component], ...]] = (PlacedGoal,)
    conditions: ClassVar[tuple[type[Component], ...]] = (CarryCondition,)
    measures: ClassVar[tuple[Measure, ...]] = (
        Measure.totalled("drops", "drops", "How often what is carried was lost.", 0.0, 4.0, sums=True),
        Measure.totalled("bruises", "bruises", "How often what is carried was pressed too hard.", 0.0, 3.0, sums=True),
        Measure.totalled(
            "grasp_error_n",
            "grasp_error",
            "Root mean square distance of the grasp force from what is right [N].",
            0.0,
            8.0,
        ),
    )
    targets: ClassVar[tuple[str, ...]] = ("within",)
    completes = "placed"
    cards: ClassVar[tuple[str, ...]] = ("grasp", "placed", "drops")
    report = CarrySection()

    def check(self, spec: TaskBlock, pointer: str) -> Iterator[Fault]:
        yield from super().check(spec, pointer)
        carry = spec.find(CarrySpec)
        if carry is None:
            return
        for name in ("lost_outside", "lost_inside"):
            box = getattr(carry, name)
            if box is not None and any(low > high for low, high in zip(box.low, box.high, strict=True)):
                yield f"{pointer}/carry/{name}", "low lies beyond high", "exchange the two"
        if carry.grip.least >= carry.grip.most:
            what = f"{carry.grip.least:g} is not below most, {carry.grip.most:g}"
            yield f"{pointer}/carry/grip/least", what, "lower it"

    def check_scene(self, spec: TaskBlock, scene: Scene) -> list[Issue]:
        """Check that the entities named in the section exist."""
        carry = spec.find(CarrySpec)
        if carry is None:
            return []
        named = {"/task/carry/body": carry.body, "/task/carry/to": carry.to}
        return scene.check_names(named, "no entity", scene.by_id)

    def open(self, spec: TaskBlock, context: TaskContext, seed: int) -> KindPlay:
        carry = spec.find(CarrySpec)
        assert carry is not None
        carried = Carried(carry, context.places[carry.to], seed)
        return _CarryPlay(carry, carried, by_pointer=context.by_pointer)


KIND = CarryTask()
