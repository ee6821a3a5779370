"""The experiment with the avatar and the cord: baseline, taps, threat, localisation probe, questions, per condition."""

from __future__ import annotations

import random
from collections.abc import Iterator, Mapping, Sequence
from enum import Enum
from pathlib import Path
from statistics import fmean
from typing import TYPE_CHECKING, Any, ClassVar

from msgspec import structs

from mimics_app.contracts.clock import FRAME_NS, SECOND_NS
from mimics_app.contracts.errors import Issue, SceneError
from mimics_app.contracts.messages.board import Card
from mimics_app.contracts.messages.orders import Feature
from mimics_app.contracts.messages.report_section import ReportedAttempt, ReportSection
from mimics_app.contracts.messages.stage_messages import TactileEvent
from mimics_app.contracts.ports.scenario_port import TaskContext
from mimics_app.contracts.system.phrases import phrase
from mimics_app.tasks.cards import count_card
from mimics_app.tasks.kinds.avatar_cord.features import (
    CORD_LENGTH,
    CORD_RADIUS,
    CORD_SHOWN,
    DELAY,
    DISTANCE,
    MIMICRY,
    OWN_BODY,
    PROBE,
    TAP,
    THREAT,
    VIEWPOINT,
    ShownTap,
)
from mimics_app.tasks.kinds.avatar_cord.observations import ANSWERS, TAPS
from mimics_app.tasks.kinds.avatar_cord.questions import Asking
from mimics_app.tasks.kinds.avatar_cord.spec import AvatarCordSpec, ExperimentGoal, QuestionnaireSpec
from mimics_app.tasks.kinds.avatar_cord.tap_schedule import Tap, plan_taps, tap_number
from mimics_app.tasks.kinds.kind import Fault, KindPlay, Measure, TaskBlock, TaskKind
from mimics_app.tasks.observation import Observation
from mimics_app.world.components.cord import CordComponent
from mimics_app.world.components.registry import Component
from mimics_app.world.files.reading.json_text import escape
from mimics_app.world.files.reading.paths import PathFault, find_file
from mimics_app.world.files.reading.struct_file import read_struct_file

if TYPE_CHECKING:
    from mimics_app.world.files.scene.scene import Scene

__all__ = ["KIND", "AvatarCordKind"]


_MAX_BYTES = 1 << 20


def read_questionnaire(name: str, folder: Path, root: Path) -> QuestionnaireSpec:
    """Read a JSON object of what may stand under `task.avatar_cord.questionnaire`.

    Args:
        name: Path of the file from the scene's folder.
        folder: Folder of the scene file.
        root: Folder that it must lie inside.

    Raises:
        SceneError: no such file, no JSON, or with every fault of it.
    """
    try:
        path = find_file(name, folder, root)
    except PathFault as fault:
        raise SceneError(Issue(name, "", fault.what, fault.fix or "check the name")) from fault
    read = read_struct_file(path, QuestionnaireSpec, _MAX_BYTES)
    faults = [Issue(str(path), place, what, fix) for place, what, fix in check_questionnaire(read)]
    if faults:
        raise SceneError(faults)
    return read


def check_questionnaire(questions: QuestionnaireSpec) -> list[tuple[str, str, str]]:
    """Return the faults of a questionnaire: pointer within it, what is wrong, what to do."""
    faults = []
    if questions.least >= questions.most:
        faults.append(("/most", "is not above least", "give the scale's upper end"))
    ids = [item.id for item in questions.items]
    for number, name in enumerate(ids):
        if name in ids[:number]:
            faults.append((f"/items/{number}/id", f'another item is called "{name}"', "give each its own id"))
    return faults


_AHEAD_NS = 2 * FRAME_NS
"""Lead time of a tactile event's order, for the driver of the vibrator [ns]."""
_LEAST_SCALES = ("ownership", "agency", "touch", "location", "control")


class _Phase(Enum):
    BASELINE = "baseline"
    TAPS = "taps"
    QUESTIONS = "questions"
    OVER = "over"


class AvatarCordPlay(KindPlay):
    """One session of the experiment."""

    def __init__(self, spec: AvatarCordSpec, labels: Sequence[str], seed: int, *, simulated: bool) -> None:
        self._spec, self._labels, self._seed, self._simulated = spec, labels, seed, simulated
        self._events: list[tuple[str, Mapping[str, object]]] = []
        self._touches: list[TactileEvent] = []
        self.begin_trial(labels[0], 0)

    def begin_trial(self, label: str, number: int) -> None:
        self._label, self._number = label, number
        self._condition = self._spec.conditions[label]
        self.begin_attempt()

    def begin_attempt(self) -> None:
        rng = random.Random(f"answers {self._seed} {self._number}")
        self._taps = plan_taps(self._spec.taps, self._condition, self._seed, self._number)
        self._asking = Asking(self._spec, self._condition, rng, self._simulated, self._condition.distance_m)
        self._phase = _Phase.BASELINE
        self._begin_ns: int | None = None
        self._shown = self._ordered = 0
        self._threat_ns: int | None = None
        self._worst_seen_ms = 0.0
        self._forces: list[float] = []

    @property
    def visual(self) -> Mapping[Feature[Any], object]:
        condition, taps = self._condition, self._next_tap()
        return {
            CORD_SHOWN: condition.cord,
            CORD_LENGTH: condition.length_factor,
            CORD_RADIUS: condition.radius_factor,
            DISTANCE: condition.distance_m,
            MIMICRY: condition.mimicry,
            DELAY: condition.visuo_motor_ms,
            VIEWPOINT: condition.viewpoint,
            OWN_BODY: condition.own_body,
            TAP: taps,
            THREAT: self._threat_ns,
            PROBE: self._asking.mark_m if self._phase is _Phase.QUESTIONS else None,
        }

    def take_touches(self) -> tuple[TactileEvent, ...]:
        ordered, self._touches = tuple(self._touches), []
        return ordered

    def take_events(self) -> Sequence[tuple[str, Mapping[str, object]]]:
        events, self._events = self._events, []
        return events

    @property
    def prompt(self) -> str:
        if self._phase is _Phase.QUESTIONS:
            return self._asking.text
        return phrase("Look at the figure before you") if self._phase is _Phase.BASELINE else ""

    @property
    def asks(self) -> bool:
        return self._phase is _Phase.QUESTIONS

    @property
    def measures(self) -> Mapping[str, float | None]:
        by_scale: dict[str, list[float]] = {}
        for answer in self._asking.answers:
            by_scale.setdefault("drift" if answer.item == "probe" else answer.scale, []).append(answer.value)
        means = {name: fmean(values) for name, values in by_scale.items()}
        return {
            "taps": float(self._shown),
            "tap_error_ms": self._worst_seen_ms if self._shown else None,
            "drift_m": means.get("drift"),
            **{scale: means.get(scale) for scale in _LEAST_SCALES},
        }

    def see(self, seen: Observation, settings: Mapping[str, object]) -> Observation:
        share = {_Phase.BASELINE: 0.0, _Phase.TAPS: self._done_share(seen.now_ns)}.get(self._phase, 1.0)
        return structs.replace(seen, progress=share)

    def pause(self, paused_ns: int) -> None:
        if self._begin_ns is not None:
            self._begin_ns += paused_ns
        if self._threat_ns is not None:
            self._threat_ns += paused_ns

    def travel(self, seen: Observation, seconds: float) -> None:
        if self._begin_ns is None:
            self._begin_ns = seen.now_ns + round(self._condition.baseline_s * SECOND_NS)
            self._note("phase", seen.now_ns, {"phase": _Phase.BASELINE.value})
        if self._phase is _Phase.BASELINE and seen.now_ns + _AHEAD_NS >= self._begin_ns:
            self._enter(_Phase.TAPS, seen.now_ns)
        if self._phase is _Phase.TAPS:
            self._order_taps(seen.now_ns)
            self._show_taps(seen)
            self._threaten(seen)
            if seen.now_ns >= self._begin_ns + round(self._condition.duration_s * SECOND_NS) and self._all_given:
                self._enter(_Phase.QUESTIONS, seen.now_ns)
        elif self._phase is _Phase.QUESTIONS:
            for answer in self._asking.step(seen.pressed, seconds):
                data = {"item": answer.item, "scale": answer.scale, "value": answer.value, "seconds": answer.seconds}
                self._note("answer", seen.now_ns, data)
            if self._asking.done:
                self._enter(_Phase.OVER, seen.now_ns)

    def outcome_words(self, row: Mapping[str, object], *, finished: bool) -> str:
        return phrase("All questions are answered" if finished else "the questions are not all answered")

    def holds(self, goal: Component, seen: Observation) -> bool:
        return self._phase is _Phase.OVER

    def cards(self, seen: Observation, finished: int) -> Mapping[str, Card]:
        return {"taps": count_card(phrase("Taps of {taps:d}", taps=len(self._taps)), self._shown)}

    @property
    def _all_given(self) -> bool:
        return self._shown == len(self._taps) and self._ordered == len(self._taps)

    def _done_share(self, now_ns: int) -> float:
        begun = self._begin_ns or now_ns
        return min(max((now_ns - begun) / max(1.0, self._condition.duration_s * SECOND_NS), 0.0), 1.0)

    def _next_tap(self) -> ShownTap | None:
        """Return the present or next tap: time of the touch [ns], place, share, angle, number; None without one."""
        if self._phase is not _Phase.TAPS or self._begin_ns is None or not self._taps:
            return None
        tap = self._taps[min(self._shown, len(self._taps) - 1)]
        return self._begin_ns + tap.seen_ns, tap.place, tap.share, tap.theta, tap.number

    def _order_taps(self, now_ns: int) -> None:
        """Order tactile events ahead of their time."""
        assert self._begin_ns is not None
        in_order = sorted(self._taps, key=lambda tap: (tap.felt_ns, tap.number))
        while self._ordered < len(in_order) and self._begin_ns + in_order[self._ordered].felt_ns <= now_ns + _AHEAD_NS:
            self._order(in_order[self._ordered], now_ns)
            self._ordered += 1

    def _show_taps(self, seen: Observation) -> None:
        """Log the taps shown in this frame: that whose display is nearest to a touch, at most half a frame off."""
        assert self._begin_ns is not None
        while self._shown < len(self._taps):
            tap = self._taps[self._shown]
            due = self._begin_ns + tap.seen_ns
            if _is_later(due, seen):
                return
            error_ms = (seen.shown_ns - due) * 1e-6
            self._worst_seen_ms = max(self._worst_seen_ms, abs(error_ms))
            self._shown += 1
            data = {"tap": tap.number, "place": tap.place, "scheduled_ns": due, "submitted_ns": seen.now_ns}
            self._note("tap_seen", seen.now_ns, {**data, "display_ns": seen.shown_ns})

    def _order(self, tap: Tap, now_ns: int) -> None:
        assert self._begin_ns is not None
        due, taps = self._begin_ns + tap.felt_ns, self._spec.taps
        number = tap_number(self._number, tap.number)
        self._touches.append(TactileEvent(tap.felt_at, due, taps.strength, taps.lasts_s, number))
        offset_ms = (tap.felt_ns - tap.seen_ns) * 1e-6
        data = {"tap": tap.number, "at": tap.felt_at, "scheduled_ns": due, "ordered_ns": now_ns, "offset_ms": offset_ms}
        self._note("tap_felt", now_ns, data)

    def _threaten(self, seen: Observation) -> None:
        threat, begun = self._condition.threat, self._begin_ns
        if threat is None or begun is None or self._threat_ns is not None:
            return
        due = begun + round(threat.at_s * SECOND_NS)
        if not _is_later(due, seen):
            self._threat_ns = due
            window = {"from_ns": due, "to_ns": due + round(threat.window_s * SECOND_NS)}
            times = {"scheduled_ns": due, "submitted_ns": seen.now_ns, "display_ns": seen.shown_ns}
            self._note("threat", seen.now_ns, {**times, **window})

    def _enter(self, phase: _Phase, now_ns: int) -> None:
        self._phase = phase
        self._note("phase", now_ns, {"phase": phase.value})

    def _note(self, kind: str, now_ns: int, data: Mapping[str, object]) -> None:
        self._events.append((kind, {"t_ns": now_ns, "trial": self._number, "condition": self._label, **data}))


def _is_later(due_ns: int, seen: Observation) -> bool:
    """Whether a later frame is displayed nearer to a time [ns] than this one."""
    return 2 * (due_ns - seen.shown_ns) > seen.period_ns


def _column(name: str, what: str, *, sums: bool = False) -> Measure:
    """Return a measure without weight in the score; its total is the mean over the trials, or the sum."""
    return Measure.totalled(name, name, what, 1.0, 0.0, sums=sums)


class AvatarCordSection(ReportSection):
    """Section of runs with trials of the experiment."""

    heading = phrase("Connection to an avatar")
    colours = phrase("The handle path, where the subject held the robot, is blue.")

    def takes(self, facts: Mapping[str, Any], attempts: Sequence[ReportedAttempt]) -> bool:
        return any("tap_error_ms" in attempt.row for attempt in attempts)

    def tiles(self, task: Mapping[str, Any]) -> Mapping[str, tuple[Any, str]]:
        return {
            phrase("mean answer on ownership"): (task.get("ownership"), ""),
            phrase("drift towards the avatar"): (task.get("drift_m"), "m"),
            phrase("taps off their time, mean of the trials' worst"): (task.get("tap_error_ms"), "ms"),
        }


class AvatarCordKind(TaskKind):
    """The built-in kind of the experiment with the cord."""

    name = "avatar_cord"
    section = AvatarCordSpec
    goals: ClassVar[tuple[type[Component], ...]] = (ExperimentGoal,)
    label = phrase("Taps")
    touches = False
    cards = ("taps",)
    scored = False
    journals = ("phase", "tap_felt", "tap_seen", "threat", "answer")
    report = AvatarCordSection()
    tables = (TAPS, ANSWERS)
    measures: ClassVar[tuple[Measure, ...]] = (
        _column("taps", "Taps that were seen.", sums=True),
        _column("tap_error_ms", "Largest distance of a tap's display from its time [ms]."),
        _column("drift_m", "Where one feels to be, from oneself towards the avatar [m]."),
        _column("ownership", "Mean answer to statements of ownership."),
        _column("agency", "Mean answer to statements of agency."),
        _column("touch", "Mean answer to statements of referred touch."),
        _column("location", "Mean answer to statements of location."),
        _column("control", "Mean answer to control statements."),
    )

    def check(self, spec: TaskBlock, pointer: str) -> Iterator[Fault]:
        yield from super().check(spec, pointer)
        section = spec.find(AvatarCordSpec)
        if section is None:
            return
        yield from self._check_labels(spec, section, pointer)
        if section.taps.most_s < section.taps.least_s:
            yield f"{pointer}/{self.name}/taps/most_s", "is shorter than least_s", "give the longer time there"
        if isinstance(section.questionnaire, QuestionnaireSpec):
            for place, what, fix in check_questionnaire(section.questionnaire):
                yield f"{pointer}/{self.name}/questionnaire{place}", what, fix
        for label, condition in section.conditions.items():
            if not condition.cord and condition.mode != "none" and "cord" in (condition.places or section.taps.places):
                where = f"{pointer}/{self.name}/conditions/{escape(label)}"
                yield where, "taps a cord that is hidden", 'give it "places", such as ["back"]'

    def _check_labels(self, spec: TaskBlock, section: AvatarCordSpec, pointer: str) -> Iterator[Fault]:
        blocks = spec.trials if not isinstance(spec.trials, str) else []
        for b, block in enumerate(blocks):
            for t, trial in enumerate(block.trials):
                if trial.label not in section.conditions:
                    what = f'there is no condition "{trial.label}"'
                    yield f"{pointer}/trials/{b}/trials/{t}/label", what, f"known: {', '.join(section.conditions)}"

    def check_scene(self, spec: TaskBlock, scene: Scene) -> list[Issue]:
        """Check the questionnaire file, and that a scene with a condition that shows the cord has one."""
        section = spec.find(AvatarCordSpec)
        if section is None:
            return []
        issues = self._check_file(section, scene)
        if any(c.cord for c in section.conditions.values()) and not scene.components(CordComponent):
            issues.append(scene.issue("/task/avatar_cord", "the scene has no cord", 'give an entity a "cord"'))
        return issues

    def _check_file(self, section: AvatarCordSpec, scene: Scene) -> list[Issue]:
        try:
            self.read_files(section, scene.path.parent, scene.root)
        except SceneError as error:
            return [
                scene.issue("/task/avatar_cord/questionnaire", issue.what, issue.fix)
                if issue.file == section.questionnaire
                else issue
                for issue in error.issues
            ]
        return []

    def read_files(self, section: Component, folder: Path, root: Path) -> Component:
        assert isinstance(section, AvatarCordSpec), "a task of this kind has its section"
        if not isinstance(section.questionnaire, str):
            return section
        return structs.replace(section, questionnaire=read_questionnaire(section.questionnaire, folder, root))

    def open(self, spec: TaskBlock, context: TaskContext, seed: int) -> KindPlay:
        section = spec.find(AvatarCordSpec)
        assert section is not None
        blocks = spec.trials if not isinstance(spec.trials, str) else []
        labels = [trial.label for block in blocks for trial in block.trials] or list(section.conditions)
        return AvatarCordPlay(section, labels, seed, simulated=context.simulated)


KIND = AvatarCordKind()
