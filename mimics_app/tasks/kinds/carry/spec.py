"""The `carry` part of a scene's task: what is to be carried where, from where it falls, how hard to grip it."""

from __future__ import annotations

from typing import Annotated

from msgspec import Meta

from mimics_app.world.components.bounds import Force, Length, Point, PositiveForce
from mimics_app.world.components.registry import Component

__all__ = ["BoxSpec", "CarrySpec", "GripSpec"]


class BoxSpec(Component, frozen=True):
    """A box along the world's axes."""

    low: Annotated[Point, Meta(description="Least corner [m]")]
    high: Annotated[Point, Meta(description="Greatest corner [m]")]


class GripSpec(Component, frozen=True):
    """Right grasp forces for the carried object; the deviation from them is the grasp error."""

    least: Annotated[Force, Meta(description="Below it is about to slip [N]")] = 0.0
    most: Annotated[PositiveForce, Meta(description="Above it is pressed needlessly [N]")] = 1e3


class CarrySpec(Component, frozen=True):
    """Pick something up and set it down at a marked place."""

    body: Annotated[str, Meta(description="Id of the entity that is carried; fingers must be able to hold it")]
    to: Annotated[str, Meta(description="Id of the entity that marks where: its place is on the surface to set it on")]
    within: Annotated[Length, Meta(description="Largest level distance from the mark that counts as placed [m]")] = 0.03
    height: Annotated[
        Length, Meta(description="Its middle must be above the mark by no more than this, and not below it [m]")
    ] = 0.06
    falls_from: Annotated[
        BoxSpec | None,
        Meta(
            description="It begins each trial at a random place between these corners; absent: where the scene has it"
        ),
    ] = None
    lost_outside: Annotated[
        BoxSpec | None, Meta(description="Out of here for two seconds and not held: it falls again; absent: nowhere")
    ] = None
    lost_inside: Annotated[
        BoxSpec | None,
        Meta(description="A place that no hand can reach: in here for two seconds and not held, it falls again"),
    ] = None
    grip: Annotated[GripSpec, Meta(description="Right grasp forces")] = GripSpec()
