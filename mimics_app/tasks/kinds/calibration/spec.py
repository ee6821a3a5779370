"""The `calibration` part of a scene's task: where the hand rests, how far the light goes, the number of repeats."""

from __future__ import annotations

from typing import Annotated, Literal

from msgspec import Meta

from mimics_app.world.components.bounds import Length, PositiveSeconds, Speed
from mimics_app.world.components.registry import Component

__all__ = ["STEPS", "CalibrationSpec", "MeasuredGoal", "StepName"]

StepName = Literal["range", "grip", "walking", "hearing", "reading"]
STEPS: tuple[StepName, ...] = ("range", "grip", "walking", "hearing", "reading")
"""Steps of a calibration, which the trials of the task name."""

_Reaches = tuple[Length, Length, Length, Length, Length, Length]


class CalibrationSpec(Component, frozen=True):
    """Measures a person before the tasks: range of motion, grip, walking speed, hearing, reading."""

    rest: Annotated[str, Meta(description="Entity where the hand rests")]
    light: Annotated[str, Meta(description="Entity that the hand follows")]
    letter: Annotated[str, Meta(description="Entity of the letter E, 1 m high and open to the right, facing the eye")]
    ears: Annotated[str, Meta(description="Entity of the person's head, with the camera")]
    reaches: Annotated[
        _Reaches,
        Meta(description="How far the light goes: right, left, up, down, forward, back; the device must get there [m]"),
    ]
    repeats: Annotated[int, Meta(ge=1, le=20, description="How often each measure is repeated")] = 3
    pace: Annotated[Speed, Meta(description="Speed of the light [m/s]")] = 0.15
    still_s: Annotated[
        PositiveSeconds, Meta(description="A hand that gets no farther for this time is at its limit [s]")
    ] = 2.5
    squeeze_s: Annotated[PositiveSeconds, Meta(description="For how long a squeeze is held [s]")] = 3.5
    walk_s: Annotated[PositiveSeconds, Meta(description="Length of a walk; its first third does not count [s]")] = 15.0
    answer_s: Annotated[PositiveSeconds, Meta(description="Longest time for an answer [s]")] = 4.0
    answer: Annotated[Length, Meta(description="Movement of the hand that is an answer [m]")] = 0.04


class MeasuredGoal(Component, frozen=True, tag="measured", tag_field="kind"):
    """The step of the calibration is over."""
