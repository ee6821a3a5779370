"""City walk (D2.1 Table 1): a person walks along a path at a speed of their own, led by the hand like a throttle."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any, Literal

from msgspec import Meta, structs

from mimics_app.contracts.errors import Issue
from mimics_app.contracts.loop.gait_state import GaitState
from mimics_app.contracts.messages.board import Card
from mimics_app.contracts.messages.orders import Feature
from mimics_app.contracts.messages.stage_messages import SoundTrigger
from mimics_app.contracts.ports.scenario_port import TaskContext
from mimics_app.contracts.system.phrases import counted_phrase, phrase
from mimics_app.tasks.cards import count_card
from mimics_app.tasks.deflection import DEAD_ZONE
from mimics_app.tasks.kinds.city_walk.street_obstacles import MATERIALS, StreetObstacle, StreetObstacles
from mimics_app.tasks.kinds.kind import KindPlay, Measure, TaskBlock, TaskKind, Values
from mimics_app.tasks.observation import Observation
from mimics_app.tasks.walking.encouragement import Encouragement
from mimics_app.tasks.walking.head_steering import check_head_tracked
from mimics_app.tasks.walking.legs import GAITS
from mimics_app.tasks.walking.room_steps import RoomGain
from mimics_app.tasks.walking.throttle import WALK_IN_ROOM, Throttle
from mimics_app.tasks.walking.walk_measures import WALK_MEASURES, WalkSection, speed_card, symmetry_card, walk_values
from mimics_app.tasks.walking.walker import PERSON, STANDS, Walker
from mimics_app.tasks.walking.worn_orthosis import OrthosisLegs, legs_in, strikes_in
from mimics_app.world.components.registry import Component
from mimics_app.world.components.walking import PathWalker

if TYPE_CHECKING:
    from mimics_app.world.files.scene.scene import Scene

__all__ = ["ALONG", "KIND", "LOOKS", "OPENED", "SPEED", "STOPPED", "TAPPING", "CityWalkPlay", "CityWalkSpec"]

ALONG = Feature("walk.along", 0.0)
"""Way of the person along the path [m]."""
SPEED = Feature("walk.speed", 0.0)
"""Speed of the person [m/s]."""
OPENED: Feature[tuple[float, ...]] = Feature("walk.opened", ())
"""How far each obstacle is open, 0 to 1, in the order of `CityWalkSpec.obstacles`."""
TAPPING = Feature("walk.tapping", (-1.0, 0.0))
"""Foot that touches an obstacle by hand: share of the touch that is over, below 0 for none, and the ankle ahead [m]."""
STOPPED = Feature("walk.stopped", False)
"""Whether an obstacle is in the way of a person who walks by hand."""
LOOKS = Feature("walk.looks", True)
"""Whether the hand looks about; it does not where a foot of an orthosis is the point of contact, nor in a room."""
_NAMES = {
    "kerb": phrase("A kerb"),
    "box": phrase("A box"),
    "low_wall": phrase("A low wall"),
    "door": phrase("A door"),
}
"""Kinds of obstacles in words."""
_SLOWS = 0.7
"""Deceleration of a person before an obstacle [m/s^2]."""


class CityWalkSpec(Component, frozen=True):
    """A walk along a path; the higher the hand above where the trial began, the faster."""

    person: Annotated[str, Meta(description="Entity with a `path_walker` that goes where the person is.")]
    fastest: Annotated[
        float, Meta(gt=0.0, le=2.5, description="Walking speed at full deflection of the hand [m/s].")
    ] = 1.4
    gait: Annotated[
        Literal["healthy", "hemiparetic", "severe"], Meta(description="Legs of who walks without an orthosis.")
    ] = "healthy"
    deflection: Annotated[float, Meta(gt=DEAD_ZONE, le=0.5, description="Full deflection of the hand [m].")] = 0.1
    room_gain: RoomGain = None
    obstacles: Annotated[
        tuple[StreetObstacle, ...],
        Meta(max_length=20, description="Obstacles on the way, felt with the foot in a gait orthosis."),
    ] = ()


class Walked(Component, frozen=True, tag="walked", tag_field="kind"):
    """The person has walked a distance."""

    metres: Annotated[float, Meta(gt=0.0, le=1e5, description="Distance [m].")]
    orthosis_metres: Annotated[
        Annotated[float, Meta(gt=0.0, le=1e5)] | None,
        Meta(description="Distance in a gait orthosis, whose belt is slower [m]; null: the same."),
    ] = None
    hold_s: Annotated[float, Meta(ge=0.0, le=60.0, description="For how long [s].")] = 0.0

    def distance(self, worn: bool) -> float:
        """Return the distance to walk [m].

        Args:
            worn: Whether the person walks in a gait orthosis.
        """
        return self.orthosis_metres if worn and self.orthosis_metres is not None else self.metres


class CityWalkPlay(KindPlay):
    """The walks of a session.

    Args:
        spec: Section of the task.
        metres: Distance to be walked [m].
        orthosis: Reads the legs in a gait orthosis; None: the person's own walk.
    """

    def __init__(self, spec: CityWalkSpec, metres: float, orthosis: OrthosisLegs | None = None) -> None:
        self._spec, self._metres, self._orthosis = spec, metres, orthosis
        self._throttle = Throttle(spec.deflection, spec.fastest, room_gain=spec.room_gain)
        self._rate = 1.0
        self.begin_attempt()

    def begin_attempt(self) -> None:
        self._along, self._speed, self._seconds = 0.0, 0.0, 0.0
        self._walker = Walker(GAITS[self._spec.gait], 0)
        self._obstacles = StreetObstacles(self._spec.obstacles, self._rate)
        self._call, self._stopped = "", False
        self._sounds: list[SoundTrigger] = []
        self._taps = 0
        self._encouragement = Encouragement()

    def start_attempt(self, seen: Observation) -> None:
        self._throttle.start(seen)

    def see(self, seen: Observation, settings: Mapping[str, object]) -> Observation:
        rate = settings.get("obstacle_rate")
        if isinstance(rate, int | float) and rate != self._rate:
            self._rate = float(rate)
            if not self._seconds:  # whoever is on the way meets what was there
                self._obstacles = StreetObstacles(self._spec.obstacles, self._rate)
        return structs.replace(seen, progress=min(self._along / self._metres, 1.0))

    def travel(self, seen: Observation, seconds: float) -> None:
        """Walk for a frame."""
        obstacles = self._obstacles
        if self._orthosis is None:
            self._throttle.read(seen, seconds)
            tap = obstacles.meet(self._along, self._throttle.kicks, seconds)
            self._stopped = obstacles.stops(self._along)
            slows = math.sqrt(2.0 * _SLOWS * obstacles.room(self._along))
            wanted = min(self._throttle.speed, slows)
            self._walker.step(0.0 if self._stopped else wanted, 0.0, seconds)
        else:
            self._walker.step_by_legs(self._orthosis.read(seen.q, strikes_in(seen), seconds), 0.0, seconds)
            self._call = obstacles.call(self._along, seen)
            tap = obstacles.step(self._along, seen, seconds)
            self._stopped = GaitState.STOPPING <= seen.snapshot.gait_state <= GaitState.RESUMING
        self._speed, self._along = self._walker.speed, self._walker.walked + obstacles.led
        if not self._stopped:
            self._seconds += seconds
            self._encouragement.follow(self._along / self._metres, seconds)
        if tap is not None:
            self._taps += 1
            material = MATERIALS[tap.obstacle.kind]
            self._sounds.append(SoundTrigger("obstacle_touch", seen.now_ns, None, material, tap.strength))

    def take_sounds(self) -> tuple[SoundTrigger, ...]:
        sounds, self._sounds = tuple(self._sounds), []
        return sounds

    def take_obstacle(self) -> str:
        call, self._call = self._call, ""
        return call

    @property
    def visual(self) -> Mapping[Feature[Any], object]:
        return {
            PERSON: self._walker.pose(),
            ALONG: round(self._along, 4),
            SPEED: round(self._speed, 4),
            OPENED: self._obstacles.opened,
            TAPPING: self._obstacles.swing,
            STOPPED: self._stopped and self._orthosis is None,
            LOOKS: self._orthosis is None and self._spec.room_gain is None,
        }

    @property
    def led(self) -> bool:
        return self._orthosis is not None

    @property
    def lever(self) -> bool:
        return True

    @property
    def prompt(self) -> str:
        ahead, left = self._obstacles.ahead, self._obstacles.touches_left(self._along)
        if left > 0 and self._orthosis is None and ahead is not None:
            return counted_phrase(
                "{what} is in the way: touch it {n:d} time (mouse button, G or K)",
                "{what} is in the way: touch it {n:d} times (mouse button, G or K)",
                left,
                what=_NAMES[ahead.kind],
            )
        stands = self._orthosis is None and not self._stopped and self._speed < STANDS
        if stands and self._spec.room_gain is not None:
            return WALK_IN_ROOM
        return (
            self._encouragement.words
            if not stands
            else phrase("Raise the hand to walk, lower it to stop; aside to look about")
        )

    @property
    def measures(self) -> Values:
        explored = float(self._obstacles.explored) if self._spec.obstacles else None
        there = self._obstacles.within(self._metres)
        met = self._obstacles.explored / there if there else None
        own = {"walked_m": self._along, "taps": float(self._taps), "obstacles": explored, "obstacles_met": met}
        return {**own, **walk_values(self._walker, self._seconds)}

    def outcome_words(self, row: Mapping[str, object], *, finished: bool) -> str:
        if finished:
            return phrase("{metres:.0f} m walked in {seconds:.0f} s", metres=self._along, seconds=row["time_s"])
        return phrase("{metres:.0f} of {all:.0f} m walked", metres=self._along, all=self._metres)

    def holds(self, goal: Component, seen: Observation) -> bool:
        assert isinstance(goal, Walked)
        return self._along >= goal.distance(self._orthosis is not None)

    def cards(self, seen: Observation, finished: int) -> Mapping[str, Card]:
        speed = speed_card(self._speed, self._spec.fastest, led=self.led)
        walked = phrase("{metres:.0f} of {all:.0f} m", metres=self._along, all=self._metres)
        even = symmetry_card(self._walker.footfalls)
        return {
            "speed": speed,
            "symmetry": even,
            "walked": Card(phrase("Walked"), walked, width=220.0),
            "steps": count_card(phrase("Steps"), self._walker.footfalls.count),
        }


class CityWalkKind(TaskKind):
    """Walking as a task."""

    name, section, goals = "city_walk", CityWalkSpec, (Walked,)
    measures = (
        Measure.totalled("walked_m", "walked", "Distance walked [m].", 60.0, 0.0, sums=True),
        Measure.totalled("obstacles", "obstacles", "Obstacles that a foot touched.", 4.0, 0.0, sums=True),
        Measure.totalled("obstacles_met", "obstacles_met", "Share of those in the way that a foot touched.", 1.0, 0.0),
        Measure.totalled("taps", "taps", "Touches of obstacles with a foot.", 8.0, 0.0, sums=True),
        *WALK_MEASURES,
    )
    targets = ("obstacle_rate",)
    completes = "walks"
    cards = ("speed", "walked", "steps", "symmetry")
    label = phrase("Path")
    touches = False
    report = WalkSection(
        "walked_m", {phrase("obstacles explored"): "obstacles", phrase("touches of obstacles"): "taps"}
    )

    def check_scene(self, spec: TaskBlock, scene: Scene) -> list[Issue]:
        walk = spec.find(CityWalkSpec)
        if walk is None:
            return []
        issues = scene.check_entity_with(PathWalker, "/task/city_walk/person", walk.person)
        if walk.room_gain is not None:
            issues += check_head_tracked(scene, "/task/city_walk/room_gain")
        for number, obstacle in enumerate(walk.obstacles):
            pointer = f"/task/city_walk/obstacles/{number}"
            issues += scene.check_entity(f"{pointer}/entity", obstacle.entity)
            if obstacle.frame is not None:
                issues += scene.check_entity(f"{pointer}/frame", obstacle.frame)
        return issues

    def open(self, spec: TaskBlock, context: TaskContext, seed: int) -> CityWalkPlay:
        section = spec.find(CityWalkSpec)
        assert section is not None
        orthosis = legs_in(context)
        metres = [goal.distance(orthosis is not None) for goal in spec.goals if isinstance(goal, Walked)]
        return CityWalkPlay(section, max(metres, default=100.0), orthosis)


KIND = CityWalkKind()
