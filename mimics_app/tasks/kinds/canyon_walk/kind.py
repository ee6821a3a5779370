"""Walk over a canyon (D2.1 3.3.2): from a broad street towards a narrow beam, and over it in sections."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Annotated, Any, Literal

from msgspec import Meta, field, structs

from mimics_app.contracts.errors import Issue
from mimics_app.contracts.messages.board import Card, Tone
from mimics_app.contracts.messages.leg_motion import LegMotion
from mimics_app.contracts.messages.orders import Feature, HapticField, Numbers
from mimics_app.contracts.messages.stage_messages import SoundTrigger
from mimics_app.contracts.ports.scenario_port import TaskContext
from mimics_app.contracts.system.phrases import counted_phrase, phrase
from mimics_app.tasks.cards import count_card
from mimics_app.tasks.deflection import DEAD_ZONE
from mimics_app.tasks.kinds.canyon_walk.crossing import Beam, BeamSway, Crossing
from mimics_app.tasks.kinds.kind import Fault, KindPlay, Measure, TaskBlock, TaskKind, Values
from mimics_app.tasks.observation import Observation
from mimics_app.tasks.walking.encouragement import Encouragement
from mimics_app.tasks.walking.head_steering import check_head_tracked, head_aside
from mimics_app.tasks.walking.hip_steering import HipSteering
from mimics_app.tasks.walking.legs import GAITS
from mimics_app.tasks.walking.room_steps import RoomGain
from mimics_app.tasks.walking.throttle import WALK_IN_ROOM, Throttle
from mimics_app.tasks.walking.walk_measures import WALK_MEASURES, WalkSection, speed_card, symmetry_card, walk_values
from mimics_app.tasks.walking.walker import PERSON, STANDS
from mimics_app.tasks.walking.worn_orthosis import OrthosisLegs, legs_in, strikes_in
from mimics_app.world.components.bounds import Extent
from mimics_app.world.components.registry import Component

if TYPE_CHECKING:
    from mimics_app.world.files.scene.scene import Scene

__all__ = ["BEAM_WIDTH", "GUST", "KIND", "SWAY", "TREMBLES", "WIND", "CanyonWalkPlay", "CanyonWalkSpec"]

BEAM_WIDTH = Feature("beam.width", 0.0)
"""Width of the beam [m]."""
TREMBLES = Feature("beam.trembles", 0.0)
"""How much the beam trembles under a step, 0 to 1."""
WIND = Feature("wind.strength", 0.0)
"""Strength of the wind, 0 to 1."""
SWAY = Feature("beam.sway", 0.0)
"""Deflection of the beam by the wind where the person is, to the right [m]."""
GUST = Feature("wind.gust", (0, 0.0))
"""Number of the newest gust, 0 before the first, and the side to which it blows, -1 left, 1 right."""

_CUE_S = 0.5
"""Duration of the cue of a misstep, which swells and fades [s]."""
_CREAK_PER_STEP = 0.35
"""Strength of the creak of the beam under a foot."""
_GUST_SAID = 0.3
"""Push of a gust from which on it is said where it comes from."""
_AGAINST = {
    "hand": (phrase("A gust from the left: lean to the left"), phrase("A gust from the right: lean to the right")),
    "hips": (
        phrase("A gust from the left: swing the right leg further"),
        phrase("A gust from the right: swing the left leg further"),
    ),
    "head": (phrase("A gust from the left: look to the left"), phrase("A gust from the right: look to the right")),
}
"""What to do against a gust from the left and from the right, by what steers."""
_AT_EDGE = {
    "hand": (phrase("The edge is near: lean to the left"), phrase("The edge is near: lean to the right")),
    "hips": (
        phrase("The edge is near: swing the right leg further"),
        phrase("The edge is near: swing the left leg further"),
    ),
    "head": (phrase("The edge is near: look to the left"), phrase("The edge is near: look to the right")),
}
"""What to do near the right edge and near the left one, by what steers."""
_EDGE_NEAR = 0.16
"""Distance of a person's middle from the edge of the beam within which it is near [m]."""
_ASIDE = 0.2
"""Deflection of the hand, or of a person in a room, from which on it is aside."""
_GUST_FROM = 4.0
"""Distance aside from which a gust is heard [m]."""


class SectionSpec(Component, frozen=True):
    """A section of the way, walked as one trial."""

    begin: Annotated[Extent, Meta(description="Where it begins along the way [m].")]
    end: Annotated[Extent, Meta(description="Where it ends [m].")]


class CanyonWalkSpec(Component, frozen=True):
    """A walk over a beam; the higher the hand, the faster; aside leans."""

    person: Annotated[str, Meta(description="Entity that goes where the person is.")]
    beam: Annotated[str, Meta(description="Entity with the model of the beam, 1 m wide, which is scaled.")]
    begins: Annotated[Extent, Meta(description="Length of the street before the beam [m].")] = 20.0
    span: Annotated[Extent, Meta(description="Length of the beam over the canyon [m].")] = 200.0
    width: Annotated[float, Meta(ge=0.2, le=3.0, description="Width of the beam [m], unless a parameter sets it.")] = (
        0.6
    )
    calm: Annotated[bool, Meta(description="For fearful people: no gusts, and half the steady wind.")] = False
    gait: Annotated[
        Literal["healthy", "hemiparetic", "severe"], Meta(description="Legs of who walks without an orthosis.")
    ] = "healthy"
    heading: Annotated[
        Literal["path", "hips", "head"],
        Meta(
            description="Where who walks in an orthosis goes: straight on, to the side to which they turn by "
            "swinging the other leg further, or, with any device, to where the tracked head looks."
        ),
    ] = "path"
    fastest: Annotated[float, Meta(gt=0.0, le=2.5, description="Speed at full deflection of the hand [m/s].")] = 1.3
    deflection: Annotated[float, Meta(gt=DEAD_ZONE, le=0.5, description="Full deflection of the hand [m].")] = 0.1
    room_gain: RoomGain = None
    cues: Annotated[
        tuple[str, ...],
        Meta(
            max_length=2, description="Vibrations that are felt at a misstep: of the left foot, of the right; or one."
        ),
    ] = ()
    cue_force: Annotated[float, Meta(ge=0.0, le=6.0, description="Largest force of such a cue [N].")] = 4.0
    sections: Annotated[
        dict[str, SectionSpec], Meta(max_length=20, description="Sections by the label of their trials.")
    ] = field(default_factory=dict)


class Crossed(Component, frozen=True, tag="crossed", tag_field="kind"):
    """The person has come to the end of the section."""

    hold_s: Annotated[float, Meta(ge=0.0, le=60.0, description="For how long [s].")] = 0.0


class CanyonWalkPlay(KindPlay):
    """The sections of a session.

    Args:
        spec: Section of the task.
        seed: Seed of gusts and feet.
        orthosis: Reads the legs in a gait orthosis; None: the person's own walk.
    """

    def __init__(self, spec: CanyonWalkSpec, seed: int, orthosis: OrthosisLegs | None = None) -> None:
        self._spec, self._seed, self._number = spec, seed, 0
        self._orthosis = orthosis
        self._throttle = Throttle(
            spec.deflection, spec.fastest, room_gain=spec.room_gain, by_head=spec.heading == "head"
        )
        self._beam = Beam(spec.begins, spec.begins + spec.span, spec.width)
        self._whole = SectionSpec(0.0, self._beam.ends + 5.0)
        self._section = self._whole
        self._sounds: list[SoundTrigger] = []
        self._events: list[tuple[str, Mapping[str, object]]] = []
        self.begin_attempt()

    def begin_trial(self, label: str, number: int) -> None:
        self._section, self._number = self._spec.sections.get(label, self._whole), number
        self.begin_attempt()

    def begin_attempt(self) -> None:
        spec = self._spec
        seed = self._seed * 1000 + self._number
        self._crossing = Crossing(self._beam, GAITS[spec.gait], self._section.begin, seed, calm=spec.calm)
        self._seconds, self._trembles = 0.0, 0.0
        self._sway, self._gusts = BeamSway(), 0
        self._hips = HipSteering() if self.led and spec.heading == "hips" else None
        self._cue_s = [_CUE_S] * len(spec.cues)
        self._encouragement = Encouragement()

    def start_attempt(self, seen: Observation) -> None:
        self._throttle.start(seen)

    def see(self, seen: Observation, settings: Mapping[str, object]) -> Observation:
        wide = settings.get("beam_width")
        if isinstance(wide, int | float):
            self._crossing.beam = widened(self._beam, float(wide))
        return structs.replace(seen, progress=self._done)

    def travel(self, seen: Observation, seconds: float) -> None:
        self._throttle.read(seen, seconds)
        crossing = self._crossing
        falls = crossing.falls
        if self._orthosis is None:
            throttle = self._throttle
            feet, missed, gust = crossing.step(throttle.speed, throttle.aside, seconds)
        else:
            legs = self._orthosis.read(seen.q, strikes_in(seen), seconds)
            lean = self._lean(legs, seen, seconds)
            feet, missed, gust = crossing.step(0.0, lean, seconds, legs)
        self._seconds += seconds
        self._encouragement.follow(self._done, seconds)
        self._trembles = max(self._trembles - 2.0 * seconds, 0.0)
        creaks = self._sway.swing(crossing.wind.strength, seconds)
        if creaks > 0.0:
            self._sound("creak", seen, (crossing.walker.x, 0.0, crossing.walker.z), creaks)
        for foot in feet:
            if crossing.beam.carries(-foot.z):
                self._trembles = 1.0
                self._sound("creak", seen, (foot.x, 0.0, foot.z), _CREAK_PER_STEP)
        self._cue_s = [min(since + seconds, _CUE_S) for since in self._cue_s]
        for foot in missed:
            if self._cue_s:
                self._cue_s[-1 if foot.side == "right" else 0] = 0.0
            self._sound("misstep", seen, (foot.x, 0.0, foot.z))
            self._note("misstep", seen, side=foot.side, off_m=round(abs(foot.x), 4))
        if gust:
            self._gusts += 1
            self._sound("gust", seen, (crossing.walker.x - _GUST_FROM * crossing.wind.side, 1.6, crossing.walker.z))
        if crossing.falls > falls:
            self._sound("fall", seen, (crossing.walker.x, 0.0, crossing.walker.z))
            self._note("fall", seen)
        while crossing.marks:
            self._note("marker", seen, name=crossing.marks.pop(0))

    def _lean(self, legs: LegMotion, seen: Observation, seconds: float) -> float | None:
        """Return the lean of who walks in an orthosis, -1 to 1 to the right; None: they are kept in their line."""
        if self._hips is not None:
            return self._hips.read(legs, seconds)
        return head_aside(seen.head) if self._spec.heading == "head" else None

    def take_sounds(self) -> tuple[SoundTrigger, ...]:
        sounds, self._sounds = tuple(self._sounds), []
        return sounds

    def take_events(self) -> Sequence[tuple[str, Mapping[str, object]]]:
        events, self._events = self._events, []
        return events

    @property
    def orders(self) -> Mapping[HapticField, Numbers]:
        """Forces of the cues: each swells and fades, so that it is felt and has no edge."""
        orders: dict[HapticField, Numbers] = {}
        for name, since in zip(self._spec.cues, self._cue_s, strict=True):
            share = math.sin(math.pi * since / _CUE_S) ** 2 if since < _CUE_S else 0.0
            orders[HapticField("force", "effects", name)] = round(self._spec.cue_force * share, 3)
        return orders

    @property
    def visual(self) -> Mapping[Feature[Any], object]:
        crossing = self._crossing
        return {
            PERSON: crossing.walker.pose(),
            BEAM_WIDTH: crossing.beam.width,
            TREMBLES: round(self._trembles, 3),
            WIND: round(crossing.wind.strength, 3),
            SWAY: round(self._sway.aside, 5),
            GUST: (self._gusts, crossing.wind.side),
        }

    @property
    def led(self) -> bool:
        return self._orthosis is not None

    @property
    def lever(self) -> bool:
        return True

    @property
    def prompt(self) -> str:
        crossing = self._crossing
        if crossing.rests:
            return self._after_fall()
        if self._orthosis is None and crossing.walker.speed < STANDS:
            if self._spec.room_gain is not None:
                return WALK_IN_ROOM
            return phrase("Raise the hand to walk, lower it to stop; move it aside to lean")
        push, steers = crossing.wind.push, self._steered_by
        if steers and abs(push) >= _GUST_SAID:
            return _AGAINST[steers][int(push < 0.0)]
        beam, aside = crossing.beam, crossing.walker.x
        if steers and beam.carries(crossing.along) and abs(aside) > 0.5 * beam.width - _EDGE_NEAR:
            return _AT_EDGE[steers][int(aside < 0.0)]
        return self._encouragement.words

    def _after_fall(self) -> str:
        """Return what to do after a fall: whoever stays aside would fall again."""
        in_room = self._spec.room_gain is not None
        if self._steered_by == "hand" and abs(self._throttle.aside) > _ASIDE:
            if in_room:
                return phrase("Never mind. You are back on the beam: step back to where you began")
            return phrase("Never mind. You are back on the beam: move the hand back to the middle")
        if self.led or in_room:
            return phrase("Never mind. You are back on the beam: breathe, then walk on")
        return phrase("Never mind. You are back on the beam: breathe, then raise the hand")

    @property
    def measures(self) -> Values:
        crossing = self._crossing
        share = 1.0 - crossing.missteps / crossing.on_beam if crossing.on_beam else None
        return {
            **walk_values(crossing.walker, self._seconds),
            "missteps": float(crossing.missteps),
            "on_beam_share": share,
            "foot_off_m": sum(crossing.off) / len(crossing.off) if crossing.off else None,
            "falls": float(crossing.falls),
        }

    def outcome_words(self, row: Mapping[str, object], *, finished: bool) -> str:
        count = self._crossing.missteps
        beside = counted_phrase("{n:d} step beside the beam", "{n:d} steps beside the beam", count)
        missed = beside if count else phrase("no step beside the beam")
        if finished:
            return phrase("Across in {seconds:.0f} s, {missed}", seconds=row["time_s"], missed=missed)
        metres = self._section.end - self._crossing.along
        return phrase("{metres:.0f} m were left, {missed}", metres=metres, missed=missed)

    def holds(self, goal: Component, seen: Observation) -> bool:
        return self._crossing.along >= self._section.end

    def cards(self, seen: Observation, finished: int) -> Mapping[str, Card]:
        crossing, left = self._crossing, max(self._section.end - self._crossing.along, 0.0)
        tone = Tone.WARN if crossing.missteps else Tone.PLAIN
        return {
            "speed": speed_card(crossing.walker.speed, self._spec.fastest, led=self.led),
            "left": Card(phrase("To go"), f"{left:.0f} m", width=150.0),
            "steps": count_card(phrase("Steps"), crossing.walker.footfalls.count),
            "missteps": Card(phrase("Missteps"), f"{crossing.missteps}", tone=tone, width=150.0),
            "symmetry": symmetry_card(crossing.walker.footfalls),
        }

    @property
    def _steered_by(self) -> str:
        """What leans: one of `_AGAINST`, "hand" also for who steps aside in a room; "" for nothing, in a line."""
        heading = self._spec.heading
        if heading == "head" or (self.led and heading == "hips"):
            return heading
        return "" if self.led else "hand"

    @property
    def _done(self) -> float:
        """Share of the section that is done, 0 to 1."""
        begin, end = self._section.begin, self._section.end
        return min(max((self._crossing.along - begin) / (end - begin), 0.0), 1.0)

    def _sound(self, kind: str, seen: Observation, place: tuple[float, float, float], strength: float = 1.0) -> None:
        self._sounds.append(SoundTrigger(kind, seen.now_ns, place, strength=strength))

    def _note(self, kind: str, seen: Observation, **data: object) -> None:
        self._events.append((kind, {"t_ns": seen.now_ns, "along_m": round(self._crossing.along, 3), **data}))


def widened(beam: Beam, width: float) -> Beam:
    """Return a beam of another width [m]."""
    return beam if beam.width == width else Beam(beam.begins, beam.ends, width)


class CanyonWalkKind(TaskKind):
    """Crossing as a task."""

    name, section, goals = "canyon_walk", CanyonWalkSpec, (Crossed,)
    measures = (
        *WALK_MEASURES,
        Measure.totalled("missteps", "missteps", "Feet that came down beside the beam.", 0.0, 10.0, sums=True),
        Measure.totalled("on_beam_share", "on_beam", "Share of the feet that came down on the beam.", 1.0, 0.5),
        Measure.totalled("foot_off_m", "foot_off", "Mean distance of the feet from the beam's middle [m].", 0.06, 0.3),
        Measure.totalled("falls", "falls", "Falls from the beam.", 0.0, 3.0, sums=True),
    )
    targets = ("beam_width",)
    completes = "crossed"
    cards = ("speed", "left", "steps", "missteps", "symmetry")
    journals = ("misstep", "fall", "marker")
    label = phrase("Way")
    touches = False
    report = WalkSection(
        "on_beam_share",
        {
            phrase("missteps"): "missteps",
            phrase("falls"): "falls",
            phrase("share of feet on the beam"): "on_beam_share",
        },
    )

    def check(self, spec: TaskBlock, pointer: str) -> Iterator[Fault]:
        yield from super().check(spec, pointer)
        walk = spec.find(CanyonWalkSpec)
        for name, section in walk.sections.items() if walk is not None else ():
            if not section.end > section.begin:
                yield f"{pointer}/canyon_walk/sections/{name}/end", "is not after its begin", "give a longer section"

    def check_scene(self, spec: TaskBlock, scene: Scene) -> list[Issue]:
        walk = spec.find(CanyonWalkSpec)
        if walk is None:
            return []
        named = {f"/task/canyon_walk/{field}": getattr(walk, field) for field in ("person", "beam")}
        named |= {f"/task/canyon_walk/cues/{number}": name for number, name in enumerate(walk.cues)}
        issues = scene.check_names(named, "no entity", scene.by_id)
        if walk.heading == "head":
            issues += check_head_tracked(scene, "/task/canyon_walk/heading")
        elif walk.room_gain is not None:
            issues += check_head_tracked(scene, "/task/canyon_walk/room_gain")
        return issues

    def open(self, spec: TaskBlock, context: TaskContext, seed: int) -> CanyonWalkPlay:
        section = spec.find(CanyonWalkSpec)
        assert section is not None
        return CanyonWalkPlay(section, seed, legs_in(context))


KIND = CanyonWalkKind()
