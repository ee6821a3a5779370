"""The `start` part of a task: drive of the robot to the start of a trial, and the wait for the go."""

from __future__ import annotations

from typing import Annotated

from msgspec import Meta

from mimics_app.world.components.bounds import PositiveSeconds, Seconds
from mimics_app.world.components.registry import Component

__all__ = ["StartSpec"]

_Tolerance = Annotated[float, Meta(gt=0.0, le=100.0)]


class StartSpec(Component, frozen=True):
    """Approach of the robot to the start of a trial."""

    tolerance: Annotated[
        Annotated[tuple[_Tolerance, ...], Meta(min_length=1, max_length=8)],
        Meta(description="Largest joint error at the start pose [m or rad]; the last one also for all further joints."),
    ] = (0.005, 0.02, 0.005)
    hold_s: Annotated[Seconds, Meta(description="Time for which the errors must stay below [s].")] = 0.2
    ready_s: Annotated[
        Seconds, Meta(description="Shortest time between arrival and go [s], in which the robot holds the start.")
    ] = 1.0
    announce_s: Annotated[
        Seconds,
        Meta(description="Time for which the drive to the start is announced before it begins, after no rest [s]."),
    ] = 1.0
    countdown_s: Annotated[
        Seconds,
        Meta(
            description="Countdown before the first trial of a session in a window, after the page of keys [s]; "
            "0: none."
        ),
    ] = 3.0
    limit_s: Annotated[
        PositiveSeconds,
        Meta(description="Longest approach, and longest wait for the go [s]; then the attempt is aborted."),
    ] = 20.0
    attempts: Annotated[
        Annotated[int, Meta(ge=1, le=1000)],
        Meta(description="Largest number of attempts at one trial; then the next trial follows."),
    ] = 5
