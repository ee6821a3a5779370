"""Calibration of a person, before the tasks: each trial is one step, whose measures are journalled."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from statistics import median
from typing import TYPE_CHECKING, Any, NamedTuple

import msgspec
from msgspec import structs

from mimics_app.contracts.errors import Issue
from mimics_app.contracts.messages.abilities import Abilities
from mimics_app.contracts.messages.board import Card
from mimics_app.contracts.messages.calibration_record import (
    CALIBRATED,
    DIRECTIONS,
    MEASURE_TITLES,
    NOT_MEASURED,
    CalibratedMeasure,
)
from mimics_app.contracts.messages.orders import Feature
from mimics_app.contracts.messages.report_section import ReportedAttempt, ReportSection
from mimics_app.contracts.messages.stage_messages import SoundTrigger
from mimics_app.contracts.ports.scenario_port import TaskContext
from mimics_app.contracts.system.phrases import phrase
from mimics_app.tasks.kinds.calibration.grip_step import GripStep
from mimics_app.tasks.kinds.calibration.question_step import HearingStep, ReadingStep
from mimics_app.tasks.kinds.calibration.range_step import RangeStep
from mimics_app.tasks.kinds.calibration.spec import STEPS, CalibrationSpec, MeasuredGoal, StepName
from mimics_app.tasks.kinds.calibration.step import Cue, Seen, Step, Tone, spread_of
from mimics_app.tasks.kinds.kind import Fault, KindPlay, Measure, TaskBlock, TaskKind, Values
from mimics_app.tasks.observation import Observation
from mimics_app.tasks.walking.walker import STANDS
from mimics_app.tasks.walking.worn_orthosis import legs_in
from mimics_app.world.components.registry import Component

if TYPE_CHECKING:
    from mimics_app.world.files.scene.scene import Scene

__all__ = ["KIND", "LETTER", "LIGHT", "WISH", "CalibrationPlay", "ShownLetter"]


_RUN_IN = 1.0 / 3.0
"""Share of a walk that does not count."""


class WalkingStep(Step):
    """Follows the belt through all walks."""

    def __init__(self, spec: CalibrationSpec, skipped: str) -> None:
        super().__init__(skipped)
        self._spec = spec
        self._since = 0.0
        self._from: tuple[float, float] | None = None  # time [s] and way of the belt [m] from which it counts
        self._means: list[float] = []

    @property
    def cue(self) -> Cue:
        return Cue(phrase("Walk as fast as is comfortable"))

    @property
    def share(self) -> float:
        return len(self._means) / self._spec.repeats

    def take(self, seen: Seen, seconds: float) -> None:
        self._since += seconds
        if self._from is None:
            self._from = (seen.now_s, seen.belt) if self._since >= _RUN_IN * self._spec.walk_s else None
            return
        if self._since < self._spec.walk_s:
            return
        then, way = self._from
        self._means.append((seen.belt - way) / (seen.now_s - then))
        self._since, self._from = 0.0, None
        if len(self._means) == self._spec.repeats:
            self.done = True
            speed = median(self._means)
            if speed < STANDS:
                self.skipped = phrase("the person did not walk")
                return
            self.measures = [CalibratedMeasure("walking", speed, "m/s", len(self._means), spread_of(self._means))]


_ANSWERS = 2.0
"""How far the hand goes for an answer, as a multiple of what counts as one."""


class Wish(NamedTuple):
    """What a simulated person wants in a frame.

    Attributes:
        x, y, z: From where the hand rests to where it is to go [m].
        squeezes: Whether the hand closes with all strength.
    """

    x: float = 0.0
    y: float = 0.0
    z: float = 0.0
    squeezes: bool = False


def wish_of(cue: Cue, able: Abilities, answer: float) -> Wish:
    """Return what a person wants for a cue.

    Args:
        cue: What they see and are asked to do.
        able: What they are able to do; the range of motion itself is the arm's.
        answer: Movement that counts as an answer [m].
    """
    if cue.tone is not None:
        softest = able.hearing_left if cue.tone.side == "left" else able.hearing_right
        return _towards(cue.tone.side, _ANSWERS * answer) if cue.tone.level >= softest else Wish()
    if cue.letter is not None:
        return _towards(cue.letter.direction, _ANSWERS * answer) if cue.letter.height >= able.letter else Wish()
    x, y, z = cue.light or (0.0, 0.0, 0.0)
    if cue.comfortable and cue.direction and able.range_of_motion:
        limits = dict(zip(DIRECTIONS, able.range_of_motion, strict=True))
        far = max(abs(x), abs(y), abs(z))
        return _towards(cue.direction, min(far, able.ease * limits[cue.direction]))
    return Wish(x, y, z, cue.squeeze)


def _towards(direction: str, way: float) -> Wish:
    x, y, z = (way * part for part in DIRECTIONS[direction])
    return Wish(x, y, z)


LIGHT: Feature[tuple[float, ...]] = Feature("calibration.light", ())
"""Where the light is, from where the hand rests [m]; () for no light."""

ShownLetter = tuple[str, float]
"""Direction in which the letter is open, and its height [px of a picture 720 px high]."""
LETTER: Feature[ShownLetter] = Feature("calibration.letter", ("right", 0.0))
"""The letter; of height 0: none."""
WISH = Feature("calibration.wish", Wish())
"""What a simulated person wants."""

_NS = 1e-9
"""A nanosecond [s]."""
_BESIDE = 0.5
"""Distance of a sound from the ears [m]."""
_COLUMNS = {
    **{f"reach_{name}": f"reach_{name}_m" for name in DIRECTIONS},
    "grip": "grip_n",
    "release": "release_s",
    "walking": "walking_mps",
    "hearing_left": "hearing_left_db",
    "hearing_right": "hearing_right_db",
    "letter": "letter_px",
}
"""Column of each measure that has one."""
_UNITS = {"m": "m", "n": "N", "s": "s", "mps": "m/s", "db": "dB", "px": "px"}
"""Unit by the end of a column's name."""


_NAMES = {"release": phrase("letting go"), "letter": phrase("smallest letter")}
"""Names of measures whose own name says too little."""
_FIGURES = {
    "m": phrase("{name:s} {value:.0f} cm"),
    "s": phrase("{name:s} {value:.2f} s"),
    "m/s": phrase("{name:s} {value:.2f} m/s"),
    "N": phrase("{name:s} {value:.0f} N"),
    "dB": phrase("{name:s} {value:.0f} dB"),
    "px": phrase("{name:s} {value:.0f} px"),
}
"""Phrase of a measure by its unit."""


class CalibrationPlay(KindPlay):
    """The steps of a session.

    Args:
        spec: Section of the task.
        context: Properties of the scene.
        labels: Steps of the trials in order.
        seed: Seed of questions and their order.
    """

    def __init__(self, spec: CalibrationSpec, context: TaskContext, labels: Sequence[str], seed: int) -> None:
        self._spec, self._context, self._seed = spec, context, seed
        self._rest, self._ears = context.places[spec.rest], context.places[spec.ears]
        self._on_belt = legs_in(context) is not None
        self._events: list[tuple[str, Mapping[str, object]]] = []
        self._sounds: list[SoundTrigger] = []
        self._paused_ns = 0
        self.begin_trial(labels[0], 0)

    def begin_trial(self, label: str, number: int) -> None:
        self._label, self._number = label, number
        self.begin_attempt()

    def begin_attempt(self) -> None:
        self._step = self._made(self._label)
        self._noted, self._played = False, 0
        self._travels = False

    def start_attempt(self, seen: Observation) -> None:
        self._travels = True

    def see(self, seen: Observation, settings: Mapping[str, object]) -> Observation:
        return structs.replace(seen, progress=1.0 if self._step.done else self._step.share)

    def pause(self, paused_ns: int) -> None:
        self._paused_ns += paused_ns

    def travel(self, seen: Observation, seconds: float) -> None:
        if not self._step.done:
            self._step.take(self._seen(seen), seconds)
        tone = self._step.cue.tone
        if tone is not None and tone.number != self._played:
            self._played = tone.number
            self._sounds.append(self._sound(tone, seen.now_ns))
        if self._step.done and not self._noted:
            self._noted = True
            self._note(seen.now_ns)

    def take_events(self) -> Sequence[tuple[str, Mapping[str, object]]]:
        events, self._events = self._events, []
        return events

    def take_sounds(self) -> tuple[SoundTrigger, ...]:
        sounds, self._sounds = tuple(self._sounds), []
        return sounds

    @property
    def visual(self) -> Mapping[Feature[Any], object]:
        cue = self._step.cue if self._travels and not self._step.done else Cue("")
        letter: ShownLetter = ("right", 0.0) if cue.letter is None else (cue.letter.direction, cue.letter.height)
        able = self._context.abilities
        wish = Wish() if able is None else wish_of(cue, able, self._spec.answer)
        return {LIGHT: cue.light or (), LETTER: letter, WISH: wish}

    @property
    def prompt(self) -> str:
        return self._step.cue.prompt

    @property
    def asks(self) -> bool:
        return self._label in ("hearing", "reading")

    @property
    def measures(self) -> Values:
        found = {measure.name: measure.value for measure in self._step.measures}
        return {column: found.get(name) for name, column in _COLUMNS.items()}

    def outcome_words(self, row: Mapping[str, object], *, finished: bool) -> str:
        if self._step.skipped:
            return phrase("{step:s} is not measured: {why}", step=self._label.capitalize(), why=self._step.skipped)
        if not finished:
            return phrase("{step:s} is not measured to its end", step=self._label)
        found = ", ".join(map(_words, _shown(self._step.measures)))
        return phrase("{step:s} measured: {found}", step=self._label.capitalize(), found=found)

    def holds(self, goal: Component, seen: Observation) -> bool:
        return self._step.done

    def cards(self, seen: Observation, finished: int) -> Mapping[str, Card]:
        return {"step": Card(phrase("Step"), self._label, width=170.0)}

    def _made(self, label: str) -> Step:
        """Return a step that begins."""
        spec, number, why = self._spec, self._number, self._why_skipped(label)
        if label == "grip":
            return GripStep(spec, why)
        if label == "walking":
            return WalkingStep(spec, why)
        if label == "hearing":
            return HearingStep(spec, self._seed, number, why)
        if label == "reading":
            return ReadingStep(spec, self._seed, number, why)
        return RangeStep(spec, why)

    def _why_skipped(self, label: str) -> str:
        """Return why a step cannot be measured here, "" where it can."""
        if label == "walking":
            return "" if self._on_belt else phrase("this device has no belt")
        if self._on_belt:
            return phrase("this device holds the legs")
        if label in ("range", "grip") and self._context.by_pointer:
            return phrase("a mouse or gamepad does not measure it")
        return phrase("the sound is off") if label == "hearing" and not self._context.audible else ""

    def _seen(self, seen: Observation) -> Seen:
        x, y, z = (here - rest for here, rest in zip(seen.hip_world, self._rest, strict=True))
        now_s, shown_s = ((t_ns - self._paused_ns) * _NS for t_ns in (seen.now_ns, seen.shown_ns))
        return Seen(now_s, shown_s, (x, y, z), seen.grasp, seen.snapshot.belt_travel)

    def _sound(self, tone: Tone, now_ns: int) -> SoundTrigger:
        x, y, z = self._ears
        aside = _BESIDE if tone.side == "right" else -_BESIDE
        return SoundTrigger("test_tone", now_ns, (x + aside, y, z), strength=10.0 ** (tone.level / 20.0))

    def _note(self, now_ns: int) -> None:
        where = {"t_ns": now_ns, "trial": self._number}
        if self._step.skipped:
            self._events.append((NOT_MEASURED, {**where, "step": self._label, "why": self._step.skipped}))
        for measure in self._step.measures:
            self._events.append((CALIBRATED, {**where, **msgspec.to_builtins(measure)}))


def _shown(measures: Sequence[CalibratedMeasure]) -> list[CalibratedMeasure]:
    """Return the measures that have a column: comfortable reaches are in the journal only."""
    return [measure for measure in measures if measure.name in _COLUMNS]


def _words(measure: CalibratedMeasure) -> str:
    name = measure.name.partition("_")[2] or measure.name
    name, value = _NAMES.get(name, name), measure.value * (100.0 if measure.unit == "m" else 1.0)
    measured = phrase(_FIGURES[measure.unit], name=name, value=value)
    return phrase("{measured:s} or more", measured=measured) if measure.at_least else measured


class CalibrationSection(ReportSection):
    """Section of runs with steps of a calibration."""

    heading = phrase("Calibration")

    def takes(self, facts: Mapping[str, Any], attempts: Sequence[ReportedAttempt]) -> bool:
        return any("reach_right_m" in attempt.row for attempt in attempts)

    def tiles(self, task: Mapping[str, Any]) -> Mapping[str, tuple[Any, str]]:
        return {
            MEASURE_TITLES[name]: (task.get(column), _UNITS[column.rpartition("_")[2]])
            for name, column in _COLUMNS.items()
        }


def _column(name: str, what: str) -> Measure:
    """Return a measure without weight in the score."""
    return Measure.totalled(name, name, what, 1.0, 0.0)


class CalibrationKind(TaskKind):
    """Measures of the person as a task."""

    name, section, goals = "calibration", CalibrationSpec, (MeasuredGoal,)
    measures = (
        *(_column(f"reach_{name}_m", f"How far the hand gets, {name} [m].") for name in DIRECTIONS),
        _column("grip_n", "Grip strength [N]."),
        _column("release_s", "Time from the word to the open hand [s]."),
        _column("walking_mps", "Comfortable walking speed [m/s]."),
        _column("hearing_left_db", "Softest level perceived from the left [dB, 0 as authored]."),
        _column("hearing_right_db", "Softest level perceived from the right [dB, 0 as authored]."),
        _column("letter_px", "Height of the smallest letter that was read [px of a picture 720 px high]."),
    )
    completes = "measured"
    cards = ("step",)
    touches = False
    scored = False
    journals = (CALIBRATED, NOT_MEASURED)
    report = CalibrationSection()

    def check(self, spec: TaskBlock, pointer: str) -> Iterator[Fault]:
        yield from super().check(spec, pointer)
        if spec.find(CalibrationSpec) is None:
            return
        for b, label in enumerate(_labels(spec)):
            if label not in STEPS:
                yield f"{pointer}/trials/{b}", f'there is no step "{label}"', f"known: {', '.join(STEPS)}"

    def check_scene(self, spec: TaskBlock, scene: Scene) -> list[Issue]:
        section = spec.find(CalibrationSpec)
        if section is None:
            return []
        named = {f"/task/calibration/{field}": getattr(section, field) for field in ("rest", "light", "letter", "ears")}
        return scene.check_names(named, "no entity", scene.by_id)

    def open(self, spec: TaskBlock, context: TaskContext, seed: int) -> CalibrationPlay:
        section = spec.find(CalibrationSpec)
        assert section is not None
        return CalibrationPlay(section, context, _labels(spec) or list[StepName](STEPS), seed)


def _labels(spec: TaskBlock) -> list[str]:
    blocks = spec.trials if not isinstance(spec.trials, str) else []
    return [trial.label for block in blocks for trial in block.trials]


KIND = CalibrationKind()
