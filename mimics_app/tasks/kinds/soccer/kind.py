"""Soccer (D2.1 3.3.3): the person walks and kicks a ball in a street, against an opponent or alone."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Annotated, Any, Literal, NamedTuple

from msgspec import Meta, structs

from mimics_app.contracts.errors import Issue
from mimics_app.contracts.messages.board import Card
from mimics_app.contracts.messages.leg_motion import LegMotion
from mimics_app.contracts.messages.orders import Feature, HapticField, Numbers
from mimics_app.contracts.messages.stage_messages import SoundTrigger
from mimics_app.contracts.ports.scenario_port import TaskContext
from mimics_app.contracts.system.phrases import counted_phrase, phrase
from mimics_app.tasks.cards import count_card
from mimics_app.tasks.deflection import DEAD_ZONE
from mimics_app.tasks.kinds.kind import Fault, KindPlay, Measure, TaskBlock, TaskKind, Values
from mimics_app.tasks.kinds.soccer.felt_ball import FeltBall
from mimics_app.tasks.kinds.soccer.match import PACE, Happening, Match, Pitch
from mimics_app.tasks.kinds.soccer.mind import Mind, PlayerView, turn_to_ball
from mimics_app.tasks.observation import Observation
from mimics_app.tasks.walking.head_steering import check_head_tracked, head_aside
from mimics_app.tasks.walking.hip_steering import HipSteering
from mimics_app.tasks.walking.legs import GAITS
from mimics_app.tasks.walking.room_steps import RoomGain
from mimics_app.tasks.walking.throttle import WALK_IN_ROOM, Throttle
from mimics_app.tasks.walking.walk_measures import WALK_MEASURES, WalkSection, speed_card, symmetry_card, walk_values
from mimics_app.tasks.walking.walker import PERSON, STANDS, FigurePose
from mimics_app.tasks.walking.worn_orthosis import OrthosisLegs, legs_in, strikes_in
from mimics_app.world.components.bounds import Figure, Share
from mimics_app.world.components.objects import HapticObject
from mimics_app.world.components.registry import Component

if TYPE_CHECKING:
    from mimics_app.world.files.scene.scene import Scene

__all__ = [
    "ADVICE",
    "BALL",
    "GOALS",
    "KIND",
    "OPPONENT_SHOWN",
    "PERSON_SHOWN",
    "REPLAY_S",
    "Advice",
    "Player",
    "SoccerPlay",
    "SoccerSpec",
]


class Advice(NamedTuple):
    """How a simulated person is advised to play.

    Attributes:
        speed: Share of full speed.
        turn: Rate of turn [rad/s].
        kicks: Whether to kick.
    """

    speed: float = 0.0
    turn: float = 0.0
    kicks: bool = False


ADVICE = Feature("advice", Advice())
BALL = Feature("ball", (0.0, 0.0, 0.0))
"""Place of the ball, world [m]."""
GOALS = Feature("match.goals", 0)
"""Goals of the person."""
REPLAY_S = Feature("match.replay_s", 0.0)
"""How long ago the part of the match was that is shown again [s]; 0: none is."""
Player = tuple[Feature[FigurePose], Feature[tuple[float, float]]]
"""Features of a player: the pose, and the kick: its progress, below 0 for none, and the way of the ankle ahead [m]."""
PERSON_SHOWN: Player = (PERSON, Feature("person.kick", (-1.0, 0.0)))
OPPONENT_SHOWN: Player = (Feature("opponent", FigurePose()), Feature("opponent.kick", (-1.0, 0.0)))

_MOST_TURN = 1.8
"""Rate of turn at full deflection of the hand [rad/s]."""
_MOST_LED_TURN = 0.6
"""The same of who steers by the hips, whose stride takes two seconds [rad/s]."""
_SOUNDS = {
    "kick": "kick",
    "goal": "scored",
    "opponent_goal": "opponent_scored",
    "board": "board",
    "bounce": "bounce",
    "whistle": "whistle",
}
"""Kind of the sound of what happens in a match."""
_CHEERS = {"goal": "cheer", "opponent_goal": "applause"}
"""What the crowd does after a goal: it is beside itself, or polite."""
_LED_KICK = 2.5
"""Largest speed of a foot in an orthosis [m/s], which an opponent's kick is measured by."""
_WHERE = (phrase("ahead"), phrase("left"), phrase("right"), phrase("behind"))
_TURNS = (
    "",
    phrase("The ball is left: move the hand to the left to turn"),
    phrase("The ball is right: move the hand to the right to turn"),
    phrase("The ball is behind: move the hand aside to turn"),
)
_HIP_TURNS = (
    "",
    phrase("The ball is left: swing the right leg further"),
    phrase("The ball is right: swing the left leg further"),
    phrase("The ball is behind: swing one leg further"),
)
_HEAD_TURNS = (
    "",
    phrase("The ball is left: look to the left"),
    phrase("The ball is right: look to the right"),
    phrase("The ball is behind: look aside"),
)
"""Where something is, and what to do where the ball is there, by `_side`: by hand, by the hips, by the head."""
_AHEAD = 0.7
"""Angle from the heading within which something is ahead, or behind [rad]."""
_MODERATE = 0.5
"""Skill with which a simulated person plays."""


class SoccerSpec(Component, frozen=True):
    """A match; the higher the hand, the faster; aside turns; closing it kicks."""

    person: Annotated[str, Meta(description="Entity that goes where the person is.")]
    ball: Annotated[str, Meta(description="Entity with the model of the ball.")]
    opponent: Annotated[str | None, Meta(description="Entity with the opponent's model; absent: alone.")] = None
    felt: Annotated[
        str | None,
        Meta(
            description="Haptic object that is the ball for the feet of who walks in an orthosis, placed at the height "
            "of a ball on the ground; absent: it is not felt."
        ),
    ] = None
    middle: Annotated[
        tuple[Figure, Figure, Figure], Meta(description="Middle of the pitch, world [m]; its length is along z.")
    ] = (0.0, 0.0, 0.0)
    skill: Annotated[Share, Meta(description="Skill of the opponent, 0 to 1, unless a parameter sets it.")] = 0.4
    pace: Annotated[
        float,
        Meta(
            ge=0.5,
            le=3.0,
            description="Largest speed of the opponent over the fastest that the person has been, unless a parameter "
            "sets it.",
        ),
    ] = PACE
    match_s: Annotated[float, Meta(ge=5.0, le=3600.0, description="Length of a match [s].")] = 90.0
    wins_at: Annotated[int, Meta(ge=1, le=99, description="Goals that end a match earlier.")] = 3
    gait: Annotated[
        Literal["healthy", "hemiparetic", "severe"], Meta(description="Legs of who walks without an orthosis.")
    ] = "healthy"
    heading: Annotated[
        Literal["path", "hips", "head"],
        Meta(
            description="Where who walks in an orthosis goes: towards the ball, to the side to which they turn by "
            "swinging the other leg further, or, with any device, to where the tracked head looks."
        ),
    ] = "path"
    room_gain: RoomGain = None
    fastest: Annotated[float, Meta(gt=0.0, le=2.5, description="Speed at full deflection of the hand [m/s].")] = 1.4
    kick_speed: Annotated[float, Meta(gt=0.5, le=15.0, description="Speed of the foot in a kick [m/s].")] = 7.0
    deflection: Annotated[float, Meta(gt=DEAD_ZONE, le=0.5, description="Full deflection of the hand [m].")] = 0.1


class FinalWhistle(Component, frozen=True, tag="final_whistle", tag_field="kind"):
    """The match is over."""

    hold_s: Annotated[float, Meta(ge=0.0, le=60.0, description="For how long [s].")] = 0.0


class SoccerPlay(KindPlay):
    """The matches of a session.

    Args:
        spec: Section of the task.
        seed: Seed of all that is random.
        advises: Tell the scenario how a simulated person plays.
        orthosis: Reads the legs in a gait orthosis; None: the person's own walk.
        felt: The ball at the feet in that orthosis; None: it is not felt.
    """

    def __init__(
        self,
        spec: SoccerSpec,
        seed: int,
        *,
        advises: bool,
        orthosis: OrthosisLegs | None = None,
        felt: FeltBall | None = None,
    ) -> None:
        self._orthosis, self._felt = orthosis, felt
        self._spec, self._seed, self._number, self._advises = spec, seed, 0, advises
        self._throttle = Throttle(
            spec.deflection, spec.fastest, room_gain=spec.room_gain, by_head=spec.heading == "head"
        )
        self._sounds: list[SoundTrigger] = []
        self._events: list[tuple[str, Mapping[str, object]]] = []
        self.begin_attempt()

    def begin_trial(self, label: str, number: int) -> None:
        self._number = number
        self.begin_attempt()

    def begin_attempt(self) -> None:
        spec, seed = self._spec, self._seed * 1000 + self._number
        skill = None if spec.opponent is None else spec.skill
        kick = spec.kick_speed if self._orthosis is None else min(spec.kick_speed, _LED_KICK)
        self._match = Match(Pitch(), GAITS[spec.gait], skill, seed, kick)
        self._match.pace = spec.pace
        self._match.felt = self._felt is not None
        if self._felt is not None:
            self._felt.restart()
        self._mind = Mind(_MODERATE, self._match.rng)
        self._hips = HipSteering() if self.led and spec.heading == "hips" else None
        self._seconds, self._hushed_s = 0.0, 0.0
        self._won = False
        self._advice = Advice()

    def start_attempt(self, seen: Observation) -> None:
        self._throttle.start(seen)

    def see(self, seen: Observation, settings: Mapping[str, object]) -> Observation:
        skill = settings.get("opponent_skill")
        if isinstance(skill, int | float) and self._match.mind is not None:
            self._match.mind.skill = float(skill)
        pace = settings.get("opponent_pace")
        if isinstance(pace, int | float):
            self._match.pace = float(pace)
        return structs.replace(seen, progress=min(self._seconds / self._spec.match_s, 1.0))

    def travel(self, seen: Observation, seconds: float) -> None:
        self._throttle.read(seen, seconds)
        throttle, match = self._throttle, self._match
        if self._orthosis is None:
            happened = match.step(throttle.speed, -_MOST_TURN * throttle.aside, throttle.kicks, seconds)
        else:  # legs walk and kick
            legs = self._orthosis.read(seen.q, strikes_in(seen), seconds)
            happened = self._step_by_legs(legs, self._turn(legs, seen, seconds), seen, seconds)
        self._seconds += seconds
        for each in happened:
            self._take(each, seen)
        self._excite(seen, seconds)
        if self._advises:
            wanted = self._mind.decide(match.view_of_person())
            self._advice = Advice(round(wanted.speed, 3), round(wanted.turn, 3), bool(wanted.kicks))

    def _turn(self, legs: LegMotion, seen: Observation, seconds: float) -> float:
        """Return the rate of turn to the left of who walks in an orthosis [rad/s]."""
        if self._hips is not None:
            return -_MOST_LED_TURN * self._hips.read(legs, seconds)
        if self._spec.heading == "head":
            return -_MOST_LED_TURN * head_aside(seen.head)
        return turn_to_ball(self._match.view_of_person())

    def take_sounds(self) -> tuple[SoundTrigger, ...]:
        sounds, self._sounds = tuple(self._sounds), []
        return sounds

    def take_events(self) -> Sequence[tuple[str, Mapping[str, object]]]:
        events, self._events = self._events, []
        return events

    @property
    def visual(self) -> Mapping[Feature[Any], object]:
        match, (mx, my, mz) = self._match, self._spec.middle
        x, y, z = (match.ball.place + (mx, my, mz)).tolist()
        seen: dict[Feature[Any], object] = {BALL: (round(x, 4), round(y, 4), round(z, 4)), ADVICE: self._advice}
        seen |= {GOALS: match.goals, REPLAY_S: round(match.replay_s, 4)}
        for (pose, kick), player in ((PERSON_SHOWN, match.person), (OPPONENT_SHOWN, match.opponent)):
            walker, kicked = player.walker, player.kicking_ankle()
            seen[pose] = walker.pose(my)._replace(x=round(walker.x + mx, 5), z=round(walker.z + mz, 5))
            seen[kick] = (round(player.kick, 4), round(0.0 if kicked is None else kicked, 4))
        return seen

    @property
    def orders(self) -> Mapping[HapticField, Numbers]:
        return {} if self._felt is None else self._felt.orders

    @property
    def led(self) -> bool:
        return self._orthosis is not None

    @property
    def lever(self) -> bool:
        return True

    @property
    def prompt(self) -> str:
        match = self._match
        if match.pause_s > 0.0:
            score = f"{match.goals} : {match.opponent_goals}"
            if match.replay_s > 0.0:
                return phrase("{score}   seen again", score=score)
            return phrase("Goal! {score}", score=score) if self._won else phrase("Never mind: {score}", score=score)
        view = match.view_of_person()
        by_head = self._spec.heading == "head"
        if self.led and not by_head:
            return "" if self._hips is None else _HIP_TURNS[_side(view, view.ball)]
        side = (_HEAD_TURNS if by_head else _TURNS)[_side(view, view.ball)]
        if self.led or side or match.person.walker.speed > STANDS:
            return side
        if self._spec.room_gain is not None:
            return WALK_IN_ROOM
        return phrase("Raise the hand to walk, aside to turn. Close it (mouse button, G or K) to kick")

    @property
    def measures(self) -> Values:
        match = self._match
        return {
            **walk_values(match.person.walker, self._seconds),
            "goals": float(match.goals),
            "opponent_goals": float(match.opponent_goals),
            "kicks": float(match.kicks),
        }

    def outcome_words(self, row: Mapping[str, object], *, finished: bool) -> str:
        score = f"{row['goals']:.0f} : {row['opponent_goals']:.0f}"
        kicks = row["kicks"]
        return counted_phrase(
            "{score}, the ball was touched {n:d} time",
            "{score}, the ball was touched {n:d} times",
            int(kicks) if isinstance(kicks, float) else 0,
            score=score,
        )

    def holds(self, goal: Component, seen: Observation) -> bool:
        match = self._match
        most = max(match.goals, match.opponent_goals)
        return self._seconds >= self._spec.match_s or (most >= self._spec.wins_at and match.pause_s > 0.0)

    def cards(self, seen: Observation, finished: int) -> Mapping[str, Card]:
        match, view = self._match, self._match.view_of_person()
        left = max(self._spec.match_s - self._seconds, 0.0)
        return {
            "goals": Card(phrase("You : red"), f"{match.goals} : {match.opponent_goals}", width=130.0),
            "left": Card(phrase("Left"), f"{left:.0f} s", width=100.0),
            "ball": Card(
                phrase("Ball: {where}", where=_WHERE[_side(view, view.ball)]), _far(view, view.ball), width=130.0
            ),
            "goal": Card(
                phrase("Goal: {where}", where=_WHERE[_side(view, view.goal)]), _far(view, view.goal), width=130.0
            ),
            "speed": speed_card(match.person.walker.speed, self._spec.fastest, led=self.led),
            "steps": count_card(phrase("Steps"), match.person.walker.footfalls.count),
            "kicks": count_card(phrase("Touches"), match.kicks),
            "symmetry": symmetry_card(match.person.walker.footfalls),
        }

    def _step_by_legs(self, legs: LegMotion, turn: float, seen: Observation, seconds: float) -> list[Happening]:
        """Play for a frame by the legs in the orthosis, whose feet meet a ball that is felt in the haptic loop."""
        match, felt = self._match, self._felt
        if felt is None:
            return match.step(0.0, turn, self._throttle.kicks, seconds, legs)
        match.held = felt.held
        happened = match.step(0.0, turn, False, seconds, legs)
        met = felt.follow(seen, match.ball, match.person.walker)
        return happened + match.note_touch(match.person, met) if met > 0.0 else happened

    def _take(self, happening: Happening, seen: Observation) -> None:
        """Let something be heard, and written down."""
        x, y, z = (a + b for a, b in zip(happening.place, self._spec.middle, strict=True))
        self._sounds.append(SoundTrigger(_SOUNDS[happening.kind], seen.now_ns, (x, y, z), strength=happening.strength))
        cheer = _CHEERS.get(happening.kind)
        if cheer is not None:
            self._won = happening.kind == "goal"
            self._sounds.append(SoundTrigger(cheer, seen.now_ns, (x, 2.0, z)))
        if happening.kind not in ("board", "bounce"):
            self._events.append(("soccer", {"t_ns": seen.now_ns, "what": happening.kind, "x": x, "z": z}))

    def _excite(self, seen: Observation, seconds: float) -> None:
        """Let the crowd be heard when the ball comes near a goal."""
        self._hushed_s = max(self._hushed_s - seconds, 0.0)
        ball = self._match.ball
        near = abs(ball.place[2]) > 0.6 * self._match.pitch.half_length and abs(ball.velocity[2]) > 3.0
        if near and self._hushed_s == 0.0:
            self._hushed_s = 6.0
            x, _, z = (ball.place + self._spec.middle).tolist()
            self._sounds.append(SoundTrigger("gasp", seen.now_ns, (x, 2.0, z)))


def _side(view: PlayerView, place: complex) -> int:
    """Return on which side the person has a place: 0 ahead, 1 left, 2 right, 3 behind."""
    way = place - view.me
    off = math.remainder(math.atan2(way.real, way.imag) - view.heading, 2.0 * math.pi)
    if abs(off) < _AHEAD:
        return 0
    return 3 if abs(off) > math.pi - _AHEAD else 1 if off > 0.0 else 2


def _far(view: PlayerView, place: complex) -> str:
    """Return the distance of a place in words."""
    return f"{abs(place - view.me):.0f} m"


class SoccerKind(TaskKind):
    """A match as a task."""

    name, section, goals = "soccer", SoccerSpec, (FinalWhistle,)
    measures = (
        *WALK_MEASURES,
        Measure.totalled("goals", "goals", "Goals.", 3.0, 0.0, sums=True),
        Measure.totalled("opponent_goals", "opponent_goals", "Goals of the opponent.", 0.0, 3.0, sums=True),
        Measure.totalled("kicks", "kicks", "Touches of the ball by the person's feet.", 20.0, 0.0, sums=True),
    )
    targets = ("opponent_skill", "opponent_pace")
    completes = "matches"
    cards = ("goals", "left", "ball", "goal", "speed", "steps", "kicks", "symmetry")
    journals = ("soccer",)
    label = phrase("Match")
    touches = False
    report = WalkSection(
        "opponent_goals",
        {
            phrase("goals"): "goals",
            phrase("goals of the opponent"): "opponent_goals",
            phrase("touches of the ball"): "kicks",
        },
    )

    def check(self, spec: TaskBlock, pointer: str) -> Iterator[Fault]:
        yield from super().check(spec, pointer)
        soccer = spec.find(SoccerSpec)
        if soccer is not None and soccer.room_gain is not None and soccer.heading != "head":
            yield f"{pointer}/soccer/heading", "does not turn who walks in a room", 'give "head"'

    def check_scene(self, spec: TaskBlock, scene: Scene) -> list[Issue]:
        soccer = spec.find(SoccerSpec)
        if soccer is None:
            return []
        named = {f"/task/soccer/{field}": getattr(soccer, field) for field in ("person", "ball", "opponent")}
        issues = scene.check_names({k: v for k, v in named.items() if v is not None}, "no entity", scene.by_id)
        if soccer.heading == "head":
            issues += check_head_tracked(scene, "/task/soccer/heading")
        if scene.device in scene.devices and soccer.felt is not None:  # it is an entity of the orthosis
            issues += scene.check_entity_with(HapticObject, "/task/soccer/felt", soccer.felt)
        return issues

    def open(self, spec: TaskBlock, context: TaskContext, seed: int) -> SoccerPlay:
        section = spec.find(SoccerSpec)
        assert section is not None
        felt = None
        if section.felt is not None and section.felt in context.bodies:
            felt = FeltBall(section.felt, context.places[section.felt][1])
        return SoccerPlay(section, seed, advises=context.simulated, orthosis=legs_in(context), felt=felt)


KIND = SoccerKind()
