"""Component type of an entity that keeps its place beside another one, as a camera that follows a person."""

from __future__ import annotations

from typing import Annotated

from msgspec import Meta

from mimics_app.contracts.errors import Issue
from mimics_app.world.components.bounds import Name, Point
from mimics_app.world.components.checked_scene import CheckedScene
from mimics_app.world.components.registry import Component, component, register_check

__all__ = ["Follow"]


@component("follow", limit=1000)
class Follow(Component, frozen=True):
    """The entity keeps its place beside another one and looks at it: over a shoulder, from a side, from above."""

    entity: Annotated[Name, Meta(description="Entity that is followed")]
    offset: Annotated[Point, Meta(description="Place relative to the followed entity [m]")]
    aim: Annotated[Point, Meta(description="Point looked at, relative to the followed entity [m]")] = (0.0, 0.0, 0.0)
    at: Annotated[
        Name | None, Meta(description="Entity looked at, as a rod at its other end; absent: the point `aim`")
    ] = None
    turns: Annotated[
        bool,
        Meta(description="True: offset and aim turn with the entity's heading; false: they keep the world's axes"),
    ] = True
    within: Annotated[
        tuple[Point, Point] | None,
        Meta(description="Opposite corners of a box, world [m], that the place keeps within: before walls"),
    ] = None
    lag: Annotated[
        float, Meta(ge=0, le=10, description="Time constant with which place and aim follow [s]; 0: rigidly")
    ] = 0.0


def _check_follow(follow: Follow, pointer: str, scene: CheckedScene) -> list[Issue]:
    """Return the faults of an entity that is unknown or follows itself, and of a place with no line of sight."""
    issues = scene.check_entity(f"{pointer}/entity", follow.entity)
    if scene.owner(pointer).parent is not None:
        what = "an entity that follows another one has no parent"
        issues.append(scene.issue(pointer, what, 'remove the "parent" of this entity, or "follow"'))
    if follow.entity in {name for name, _, _ in scene.components(Follow)}:
        what = f'"{follow.entity}" follows an entity itself'
        issues.append(scene.issue(f"{pointer}/entity", what, 'name an entity without "follow"'))
    if follow.at is not None:
        issues += scene.check_entity(f"{pointer}/at", follow.at)
    elif follow.offset == follow.aim:
        issues.append(scene.issue(f"{pointer}/aim", "is where the follower stands", "give another offset or aim"))
    return issues


register_check("follow", _check_follow)
