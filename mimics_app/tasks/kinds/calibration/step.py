"""One step of a calibration: what the person sees and is asked to do in a frame, and what was measured at its end."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass

from mimics_app.contracts.arrays import Vec3
from mimics_app.contracts.messages.calibration_record import CalibratedMeasure

__all__ = ["Cue", "Letter", "Seen", "Step", "Tone", "spread_of"]


@dataclass(frozen=True, slots=True)
class Seen:
    """What a step observes in a frame.

    Attributes:
        now_s: Time of the frame, pauses left out [s].
        shown_s: When the frame is displayed, likewise [s].
        hand: From where the hand rests to where it is [m].
        grasp: Grasp force [N].
        belt: Way of the belt so far [m]; 0 without one.
    """

    now_s: float
    shown_s: float
    hand: Vec3
    grasp: float
    belt: float = 0.0


@dataclass(frozen=True, slots=True)
class Tone:
    """A sound to be heard.

    Attributes:
        side: "left" or "right".
        level: Its level [dB, 0 as authored].
        number: Number of the sound, which begins with a new one.
    """

    side: str
    level: float
    number: int


@dataclass(frozen=True, slots=True)
class Letter:
    """A letter to be read.

    Attributes:
        direction: Where it is open.
        height: [px of a picture 720 px high].
    """

    direction: str
    height: float


@dataclass(frozen=True, slots=True)
class Cue:
    """What the person sees and is asked to do.

    Attributes:
        prompt: In words.
        light: From where the hand rests to the light [m]; None: no light.
        direction: Direction in which the light leads, "" for back to the rest.
        comfortable: Whether the hand goes no farther than is comfortable.
        squeeze: Whether the hand is to be closed with all strength.
        tone: Sound that was played last and not answered yet, or None.
        letter: Letter to be read, or None.
    """

    prompt: str
    light: Vec3 | None = None
    direction: str = ""
    comfortable: bool = False
    squeeze: bool = False
    tone: Tone | None = None
    letter: Letter | None = None


class Step(ABC):
    """A step, frame by frame.

    Attributes:
        skipped: Why it cannot be measured, "" where it can.
        done: Whether it is over.
        measures: What was measured, at its end.
    """

    def __init__(self, skipped: str = "") -> None:
        self.skipped = skipped
        self.done = bool(skipped)
        self.measures: list[CalibratedMeasure] = []

    @property
    @abstractmethod
    def cue(self) -> Cue:
        """What the person sees and is asked to do now."""

    @property
    @abstractmethod
    def share(self) -> float:
        """Share of the step that is over, 0-1."""

    @abstractmethod
    def take(self, seen: Seen, seconds: float) -> None:
        """Take a frame with its duration [s], while the step is not over."""


def spread_of(values: Sequence[float]) -> float:
    """Return the largest less the smallest of values."""
    return max(values) - min(values)
