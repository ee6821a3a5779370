"""Guided walk (D2.1 3.4.2): an avatar under a learning system brings a person to a place by its actions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Annotated, Any, Literal

import numpy as np
from msgspec import Meta, structs

from mimics_app.contracts.errors import Issue
from mimics_app.contracts.messages.board import Card
from mimics_app.contracts.messages.orders import Feature
from mimics_app.contracts.messages.report_section import ReportedAttempt, ReportSection
from mimics_app.contracts.ports.scenario_port import TaskContext
from mimics_app.contracts.system.phrases import phrase
from mimics_app.tasks.cards import count_card
from mimics_app.tasks.deflection import deflection
from mimics_app.tasks.kinds.guided_walk.walk_people import STEP_S, Alley, Deed, Guide, Walker
from mimics_app.tasks.kinds.kind import KindPlay, Measure, StepResult, TaskBlock, TaskKind, Values
from mimics_app.tasks.observation import Observation
from mimics_app.world.components.registry import Component

if TYPE_CHECKING:
    from mimics_app.world.files.scene.scene import Scene

__all__ = ["AVATAR_AT", "DEED", "KIND", "NEAREST", "PERSON_AT", "GuidedWalkPlay", "GuidedWalkSpec"]

Condition = Literal["intimate", "social", "random"]

NEAREST: dict[str, float] = {"intimate": 0.38, "social": 1.2, "random": 0.38}
"""Smallest distance of the avatar in each condition [m]: Kastanis & Slater, ACM TAP 9(1), 2012."""

PERSON_AT = Feature("walk.person", (0.0, 0.0))
AVATAR_AT = Feature("walk.avatar", (-2.0, 0.0))
"""Where the two are, along the alley and to its right [m]."""
DEED = Feature("walk.deed", 3)
"""Number of the avatar's action."""
_WORDS = (
    phrase("The avatar approaches"),
    phrase("The avatar steps back"),
    phrase("The avatar walks round you"),
    phrase("The avatar waits"),
    phrase("The avatar beckons"),
    phrase("The avatar points"),
)
_WALKING = 0.8
"""Walking speed at full deflection of the hand [m/s]."""
_DEFLECTION = 0.1
"""Full deflection of the hand from where the trial began [m]."""


class GuidedWalkSpec(Component, frozen=True):
    """An avatar brings a person to a place."""

    avatar: Annotated[str, Meta(description="Entity of the avatar.")]
    person: Annotated[str, Meta(description="Entity that goes where the person is, with the camera below it.")]
    place: Annotated[str, Meta(description="Entity at the place to be brought to.")]
    condition: Annotated[
        Condition, Meta(description="How near the avatar may come: 0.38 m, 1.2 m; 'random' does anything, at 0.38 m.")
    ] = "intimate"
    walker: Annotated[
        Literal["simulated", "hand"],
        Meta(description="Walker: a simulated person, or the person, by the hand: forwards or up, and to the sides."),
    ] = "simulated"


class AtThePlace(Component, frozen=True, tag="at_the_place", tag_field="kind"):
    """The person is at the place of the guided walk."""

    hold_s: Annotated[float, Meta(ge=0.0, le=60.0, description="For how long [s].")] = 0.0


class GuidedWalkPlay(KindPlay):
    """The walks of a session.

    Args:
        spec: Section of the task.
        seed: Seed of the walkers and of the random condition.
    """

    def __init__(self, spec: GuidedWalkSpec, seed: int) -> None:
        self._spec, self._alley = spec, Alley()
        self._rng = np.random.default_rng([seed, 342])
        self._hand_from = 0.0 + 0.0j
        self.begin_attempt()

    def begin_attempt(self) -> None:
        self._walker = Walker(self._rng, self._alley)
        self._guide = Guide(self._rng, self._alley, NEAREST[self._spec.condition])
        self._since, self._steps, self._step = 0.0, 0, None  # type: tuple[float, int, StepResult | None]
        self._shown = (self._walker.at, self._guide.at)
        self._left = self._alley.left(self._walker.at)
        self._reached = False

    def start_attempt(self, seen: Observation) -> None:
        self._hand_from = _hand(seen)

    def see(self, seen: Observation, settings: Mapping[str, object]) -> Observation:
        wanted = settings.get("avatar_deed", Deed.WAIT)
        self._wanted = Deed(int(np.clip(round(wanted), 0, 5))) if isinstance(wanted, int | float) else Deed.WAIT
        whole = abs(self._alley.place - self._alley.start)
        progress = min(max(1.0 - self._alley.left(self._walker.at) / whole, 0.0), 1.0)
        return structs.replace(seen, progress=progress)

    def travel(self, seen: Observation, seconds: float) -> None:
        """Advance the walk: by the hand in every frame; simulated walker and avatar in steps."""
        if self._spec.walker == "hand":
            self._walk_by_hand(seen, seconds)
        self._since += seconds
        self._glide(seconds)
        if self._alley.left(self._walker.at) <= self._alley.within:
            self._reached = True
        if self._since >= STEP_S - 1e-6:
            self._since -= STEP_S
            self._end_step()

    @property
    def step(self) -> StepResult | None:
        step, self._step = self._step, None
        return step

    @property
    def visual(self) -> Mapping[Feature[Any], object]:
        person, avatar = ((round(place.real, 4), round(place.imag, 4)) for place in self._shown)
        return {PERSON_AT: person, AVATAR_AT: avatar, DEED: int(self._guide.deed)}

    @property
    def lever(self) -> bool:
        return True

    @property
    def prompt(self) -> str:
        deed = _WORDS[self._guide.deed]
        if self._spec.walker == "simulated":
            return phrase("{deed}; the walker answers on its own", deed=deed)
        return phrase("Go to the green ring: hand up walks on, down back, left and right aside. {deed}", deed=deed)

    @property
    def measures(self) -> Values:
        return {"walk_steps": self._steps, "walk_left_m": self._alley.left(self._walker.at)}

    def outcome_words(self, row: Mapping[str, object], *, finished: bool) -> str:
        if finished:
            return phrase("The place is reached, in {seconds:.0f} s", seconds=row["time_s"])
        return phrase("{metres:.1f} m left to the place", metres=self._alley.left(self._walker.at))

    def holds(self, goal: Component, seen: Observation) -> bool:
        return self._reached

    def cards(self, seen: Observation, finished: int) -> Mapping[str, Card]:
        gap = abs(self._walker.at - self._guide.at)
        return {"gap": Card(phrase("Distance"), f"{gap:.2f} m"), "steps": count_card(phrase("Steps"), self._steps)}

    def _walk_by_hand(self, seen: Observation, seconds: float) -> None:
        moved = _hand(seen) - self._hand_from
        share = complex(deflection(moved.real, _DEFLECTION), deflection(moved.imag, _DEFLECTION))
        self._walker.at = self._alley.inside(self._walker.at + share * _WALKING * seconds)

    def _glide(self, seconds: float) -> None:
        """Move the shown places smoothly towards those of the last step."""
        share, (walker, guide) = min(seconds / 0.4, 1.0), self._shown
        self._shown = (walker + share * (self._walker.at - walker), guide + share * (self._guide.at - guide))

    def _end_step(self) -> None:
        """End the step with its result, after the actions of the avatar and of the simulated walker."""
        deed = Deed(int(self._rng.integers(6))) if self._spec.condition == "random" else self._wanted
        self._guide.do(deed, self._walker.at)
        if self._spec.walker == "simulated":
            self._walker.answer(self._guide.at, deed)
        left = self._alley.left(self._walker.at)
        observed = self._alley.observe(self._walker.at, self._guide.at)
        self._step = StepResult(self._left - left, {**observed, "deed": float(deed)})
        self._left = left
        self._steps += 1


def _hand(seen: Observation) -> complex:
    """Return where the hand is: forwards or up, plus i times to the right [m]."""
    right, up, back = seen.hip_world
    return complex(up - back, right)


class GuidedWalkSection(ReportSection):
    """Section of runs with trials of the walk."""

    def takes(self, facts: Mapping[str, Any], attempts: Sequence[ReportedAttempt]) -> bool:
        return any("walk_steps" in attempt.row for attempt in attempts)

    def tiles(self, task: Mapping[str, Any]) -> Mapping[str, tuple[Any, str]]:
        return {
            phrase("steps of the avatar"): (task.get("walk_steps"), ""),
            phrase("left to the place"): (task.get("walk_left_m"), "m"),
        }


class GuidedWalkKind(TaskKind):
    """Proxemics as a task."""

    name, section, goals = "guided_walk", GuidedWalkSpec, (AtThePlace,)
    measures = (
        Measure.totalled("walk_steps", "walk_steps", "Steps of the avatar.", 10.0, 210.0, sums=True),
        Measure.totalled("walk_left_m", "walk_left", "Distance left to the place [m].", 0.3, 3.0),
    )
    targets = ("avatar_deed",)
    completes = "brought"
    cards = ("gap", "steps")
    label = phrase("Path")
    touches = False
    report = GuidedWalkSection()

    def check_scene(self, spec: TaskBlock, scene: Scene) -> list[Issue]:
        walk = spec.find(GuidedWalkSpec)
        if walk is None:
            return []
        named = {f"/task/guided_walk/{field}": getattr(walk, field) for field in ("avatar", "person", "place")}
        return scene.check_names(named, "no entity", scene.by_id)

    def open(self, spec: TaskBlock, context: TaskContext, seed: int) -> GuidedWalkPlay:
        section = spec.find(GuidedWalkSpec)
        assert section is not None
        return GuidedWalkPlay(section, seed)


KIND = GuidedWalkKind()
