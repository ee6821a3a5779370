"""Localisation probe and questionnaire in the picture, answered by a person or by a model."""

from __future__ import annotations

import math
import random
from dataclasses import dataclass, field

from mimics_app.contracts.system.phrases import phrase
from mimics_app.tasks.kinds.avatar_cord.spec import (
    AvatarCordSpec,
    ConditionSpec,
    ItemSpec,
    ProbeSpec,
    QuestionnaireSpec,
    SubjectModel,
)

__all__ = ["Answer", "Asking", "ownership_of"]

_LEFT, _RIGHT, _TAKE = ({"left", "pad_dpad_left"}, {"right", "pad_dpad_right"}, {"enter", "pad_a", "mouse_left"})
_PLACES = 15
"""Dots of the way from the subject to the avatar, beside the question."""
_WEIGHTS = {"ownership": 1.0, "touch": 0.9, "location": 0.8, "agency": 0.7, "control": -0.8, "other": 0.0}
"""Weight of the ownership in the answers of a simulated subject, by the scale of a statement; control statements
are those without expected agreement."""


@dataclass(frozen=True, slots=True)
class Answer:
    """An answer: "probe" or the id of an item, its scale and value, and the response time [s]."""

    item: str
    scale: str
    value: float
    seconds: float


def ownership_of(model: SubjectModel, condition: ConditionSpec) -> float:
    """Return the ownership that the model feels under a condition, 0 to 1.

    It falls to 1/e at an offset of `window_ms` between seen and felt taps (visuo-tactile integration: Shimada 2009
    finds the drop at some 300 ms), likewise with the delay of movements, and with the avatar's distance.
    """
    apart_ms = {
        "synchronous": 0.0,
        "delayed": condition.visuo_tactile_ms,
        "jittered": 0.58 * condition.visuo_tactile_ms,  # root mean square of an even spread
        "shuffled": 2.0 * model.window_ms,
        "other_place": 1.5 * model.window_ms,
        "none": 2.0 * model.window_ms,
    }[condition.mode]
    touch = math.exp(-((apart_ms / model.window_ms) ** 2))
    motor = math.exp(-((condition.visuo_motor_ms / model.motor_window_ms) ** 2)) if condition.mimicry != "none" else 0.3
    cord = model.cord_gain / max(1.0, condition.length_factor) if condition.cord else 0.0
    near = 1.2 / max(1.2, condition.distance_m)
    return min(1.0, (0.65 * touch + 0.2 * motor + cord) * near)


@dataclass
class Asking:
    """The questions of one trial.

    Args:
        spec: The experiment.
        condition: Condition of the trial.
        rng: Random numbers of the trial, for orders, initial values and simulated answers.
        simulated: Whether the model answers.
        distance: Distance of the avatar [m].

    Attributes:
        answers: Answers so far.
    """

    spec: AvatarCordSpec
    condition: ConditionSpec
    rng: random.Random
    simulated: bool
    distance: float
    answers: list[Answer] = field(default_factory=list)

    def __post_init__(self) -> None:
        asked = self.spec.asked
        items = list(asked.items) if asked else []
        if asked and asked.order == "shuffled":
            self.rng.shuffle(items)
        self._left: list[ProbeSpec | ItemSpec] = [*([self.spec.probe] if self.spec.probe else []), *items]
        # One level for the trial, so that a subject's answers to it belong together.
        model = self.spec.simulated
        self._ownership = ownership_of(model, self.condition) + self.rng.gauss(0.0, 0.3 * model.spread)
        self._since = 0.0
        self._value = self._first_value()

    @property
    def done(self) -> bool:
        """Whether everything was answered."""
        return not self._left

    @property
    def mark_m(self) -> float | None:
        """Position of the probe's mark, from the subject towards the avatar [m]; None without a probe."""
        return self._value if self._left and isinstance(self._left[0], ProbeSpec) else None

    @property
    def text(self) -> str:
        """Text shown to the person."""
        if self.done:
            return ""
        asked = self._left[0]
        if isinstance(asked, ProbeSpec):
            return "\n".join(
                (
                    phrase("Where do you feel you are?"),
                    phrase("Move the green post there with left and right, then press Enter"),
                    phrase("you  {places}  the figure", places=self._places()),
                )
            )
        questionnaire = self._questionnaire
        span = range(questionnaire.least, questionnaire.most + 1)
        scale = "  ".join(f"[{value:+d}]" if value == self._value else f"{value:+d}" for value in span)
        answer = phrase("disagree  {scale}  agree    (left, right, Enter)", scale=scale.replace("+0", "0"))
        return "\n".join((asked.text, answer))

    def _places(self) -> str:
        """Return the way from the subject to the avatar as a row of dots, one of them filled.

        The post itself is not visible where the subject stands, and inside the avatar.
        """
        at = round(self._value / self.distance * (_PLACES - 1))
        return " ".join("●" if place == at else "·" for place in range(_PLACES))

    def step(self, pressed: tuple[str, ...], seconds: float) -> list[Answer]:
        """Take the keys of a frame and return the answers given in it."""
        if self.done:
            return []
        self._since += seconds
        if self.simulated:
            return [self._answer(self._simulated_value())] if self._since >= self.spec.simulated.reaction_s else []
        given = []
        for name in pressed:
            if name in _TAKE and not self.done:
                given.append(self._answer(self._value))
            elif name in _LEFT | _RIGHT and not self.done:
                self._move(1.0 if name in _RIGHT else -1.0)
        return given

    @property
    def _questionnaire(self) -> QuestionnaireSpec:
        asked = self.spec.asked
        assert asked is not None, "an item is of a questionnaire"
        return asked

    def _move(self, steps: float) -> None:
        asked = self._left[0]
        if isinstance(asked, ProbeSpec):
            self._value = min(max(self._value + steps * asked.step_m, 0.0), self.distance)
        else:
            self._value = min(max(self._value + steps, self._questionnaire.least), self._questionnaire.most)

    def _answer(self, value: float) -> Answer:
        asked = self._left.pop(0)
        probe = isinstance(asked, ProbeSpec)
        answer = Answer("probe", "location", value, self._since) if probe else _of(asked, value, self._since)
        self.answers.append(answer)
        self._since, self._value = 0.0, self._first_value()
        return answer

    def _first_value(self) -> float:
        if self._left and isinstance(self._left[0], ProbeSpec):
            starts = self._left[0].starts
            return {"self": 0.0, "avatar": self.distance}.get(starts, self.rng.uniform(0.0, self.distance))
        asked = self.spec.asked
        return float((asked.least + asked.most) // 2) if asked else 0.0

    def _simulated_value(self) -> float:
        """Return the model's answer, with noise for every statement."""
        asked, model = self._left[0], self.spec.simulated
        if isinstance(asked, ProbeSpec):
            drift = 0.35 * self._ownership * self.distance + self.rng.gauss(0.0, 0.05)
            return min(max(drift, 0.0), self.distance)
        weight, span = _WEIGHTS[asked.scale], self._questionnaire
        level = 0.5 + (self._ownership - 0.5) * weight if weight >= 0.0 else 0.25
        middle, half = 0.5 * (span.least + span.most), 0.5 * (span.most - span.least)
        value = middle + half * (2.0 * level - 1.0 + self.rng.gauss(0.0, model.spread))
        return float(min(max(round(value), span.least), span.most))


def _of(asked: ProbeSpec | ItemSpec, value: float, seconds: float) -> Answer:
    assert isinstance(asked, ItemSpec), "a probe is answered apart"
    return Answer(asked.id, asked.scale, value, seconds)
