"""Steps whose questions are answered by moving the hand in a direction: hearing and reading."""

from __future__ import annotations

import math
import random
from abc import abstractmethod
from collections.abc import Sequence
from statistics import fmean

from mimics_app.contracts.arrays import Vec3
from mimics_app.contracts.messages.calibration_record import DIRECTIONS, CalibratedMeasure
from mimics_app.contracts.system.phrases import phrase
from mimics_app.tasks.kinds.calibration.spec import CalibrationSpec
from mimics_app.tasks.kinds.calibration.step import Cue, Letter, Seen, Step, Tone, spread_of

__all__ = ["HearingStep", "ReadingStep", "Staircase"]

# A staircase: each right answer makes the next question harder, any other one easier; the threshold is in between.
#
# One up, one down (Levitt, J Acoust Soc Am 49(2B), 1971): it converges to what is answered half of the time. The steps
# become smaller at each of the first reversals; the threshold is the mean of the later ones.


class Staircase:
    """One staircase.

    Args:
        first: Level of the first question.
        easiest, hardest: Limits of the level; the smaller number is the harder one.
        steps: Step between two levels, up to each of the first reversals; the last one stays.
        counting: Number of reversals of that last step that make the threshold.

    Attributes:
        level: Level of the next question.
        reversals: Levels at which the direction changed, of the smallest step.
        done: Whether the threshold is known.
    """

    def __init__(self, first: float, easiest: float, hardest: float, steps: Sequence[float], counting: int) -> None:
        self.level = first
        self.reversals: list[float] = []
        self._easiest, self._hardest = easiest, hardest
        self._steps, self._counting = list(steps), counting
        self._was_right: bool | None = None
        self.done = False

    def answer(self, right: bool) -> None:
        """Take an answer to a question of the present level."""
        turned = self._was_right is not None and right is not self._was_right
        self._was_right = right
        if turned and len(self._steps) > 1:
            self._steps.pop(0)
        elif turned or self._at_end(right):
            self.reversals.append(self.level)
        step = -self._steps[0] if right else self._steps[0]
        self.level = min(max(self.level + step, self._hardest), self._easiest)
        self.done = len(self.reversals) >= self._counting

    @property
    def threshold(self) -> float:
        """Level between what is answered and what is not, after the end."""
        return fmean(self.reversals)

    def _at_end(self, right: bool) -> bool:
        """Whether the level can go no farther."""
        return self.level <= self._hardest if right else self.level >= self._easiest


_NEAR, _BACK_S = 0.03, 8.0
"""Distance from the rest at which the next question begins [m], and the longest wait for it [s]."""
_PAUSE_S = (0.4, 1.2)
"""Pause before a question [s]: a regular one would be answered by its rhythm."""
_SIDES = ("left", "right")
_LOUD, _SOFTEST = 0.0, -80.0
_FIRST_LEVEL, _LEVEL_STEPS = -20.0, (10.0, 5.0, 2.0, 1.0)
"""Level of the first sound, and steps of the levels [dB]."""
_OPEN = ("right", "left", "up", "down")
_LARGEST, _SMALLEST, _FIRST_HEIGHT = 200.0, 4.0, 48.0
"""Heights of letters [px of a picture 720 px high]."""
_HEIGHT_STEPS = (0.35, 0.18, 0.08, 0.04)
"""Steps of the logarithm of the height."""
_COUNTING = 4
"""Number of reversals that make a threshold."""
_MOST = 60
"""Largest number of questions of a step."""


class _AskingStep(Step):
    """Questions one after the other, each answered by a movement from the rest, or by none in time."""

    def __init__(self, spec: CalibrationSpec, seed: str, skipped: str) -> None:
        super().__init__(skipped)
        self._spec, self._rng = spec, random.Random(seed)
        self._asked = 0
        self._open = self._answered = False
        self._since = self._pause = 0.0
        self._wait()

    def take(self, seen: Seen, seconds: float) -> None:
        self._since += seconds
        if not self._open:
            at_rest = _length(seen.hand) < _NEAR or self._since >= _BACK_S
            if at_rest and self._since >= self._pause:
                self._open, self._since, self._asked = True, 0.0, self._asked + 1
                self.ask()
            return
        given = self._given(seen.hand)
        if given or self._since >= self._spec.answer_s:
            self._answered = self._answered or bool(given)
            self.evaluate(given)
            self._open = False
            self._wait()
            if self.over or self._asked >= _MOST:
                self.done = True
                if self._answered:
                    self.measures = self.results()
                else:
                    self.skipped = phrase("no answer was given")

    @property
    def share(self) -> float:
        return self._asked / _MOST

    @property
    @abstractmethod
    def over(self) -> bool:
        """Whether all is known."""

    @abstractmethod
    def ask(self) -> None:
        """Begin a question."""

    @abstractmethod
    def evaluate(self, given: str) -> None:
        """Take the answer: a direction, "" for none."""

    @abstractmethod
    def results(self) -> list[CalibratedMeasure]:
        """Return what was measured."""

    def _wait(self) -> None:
        self._since, self._pause = 0.0, self._rng.uniform(*_PAUSE_S)

    def _given(self, hand: Vec3) -> str:
        """Return the direction in which the hand moved, "" for none."""
        far, direction = max((sum(a * b for a, b in zip(DIRECTIONS[name], hand, strict=True)), name) for name in _OPEN)
        return direction if far >= self._spec.answer else ""


class HearingStep(_AskingStep):
    """Sounds on the left or the right, softer and softer: the hand moves to that side."""

    def __init__(self, spec: CalibrationSpec, seed: int, number: int, skipped: str) -> None:
        self._stairs = {side: Staircase(_FIRST_LEVEL, _LOUD, _SOFTEST, _LEVEL_STEPS, _COUNTING) for side in _SIDES}
        self._tone: Tone | None = None
        super().__init__(spec, f"hearing {seed} {number}", skipped)

    @property
    def cue(self) -> Cue:
        tone = self._tone if self._open else None
        return Cue(phrase("Where is the sound? Move the hand to that side, and back. No sound: stay"), tone=tone)

    @property
    def over(self) -> bool:
        return all(stair.done for stair in self._stairs.values())

    def ask(self) -> None:
        side = self._rng.choice([side for side in _SIDES if not self._stairs[side].done])
        self._tone = Tone(side, self._stairs[side].level, self._asked)

    def evaluate(self, given: str) -> None:
        assert self._tone is not None, "a question was asked"
        self._stairs[self._tone.side].answer(given == self._tone.side)

    def results(self) -> list[CalibratedMeasure]:
        return [
            CalibratedMeasure(
                f"hearing_{side}", stair.threshold, "dB", len(stair.reversals), spread_of(stair.reversals)
            )
            for side, stair in self._stairs.items()
            if stair.reversals
        ]


class ReadingStep(_AskingStep):
    """Letters E of smaller and smaller size: the hand moves to where it is open (the tumbling E of Snellen charts)."""

    def __init__(self, spec: CalibrationSpec, seed: int, number: int, skipped: str = "") -> None:
        first, largest, smallest = (math.log(height) for height in (_FIRST_HEIGHT, _LARGEST, _SMALLEST))
        self._stair = Staircase(first, largest, smallest, _HEIGHT_STEPS, _COUNTING)
        self._letter: Letter | None = None
        super().__init__(spec, f"reading {seed} {number}", skipped)

    @property
    def cue(self) -> Cue:
        letter = self._letter if self._open else None
        return Cue(phrase("Where is the E open? Move the hand there, and back. Not to be seen: stay"), letter=letter)

    @property
    def over(self) -> bool:
        return self._stair.done

    def ask(self) -> None:
        self._letter = Letter(self._rng.choice(_OPEN), math.exp(self._stair.level))

    def evaluate(self, given: str) -> None:
        assert self._letter is not None, "a question was asked"
        self._stair.answer(given == self._letter.direction)

    def results(self) -> list[CalibratedMeasure]:
        heights = [math.exp(level) for level in self._stair.reversals]
        if not heights:
            return []
        value = math.exp(self._stair.threshold)
        return [CalibratedMeasure("letter", value, "px", len(heights), spread_of(heights))]


def _length(values: Vec3) -> float:
    return sum(value * value for value in values) ** 0.5
