"""Component types of walks: a path on the ground, and people who walk along it."""

from __future__ import annotations

from itertools import pairwise
from typing import Annotated

from msgspec import Meta

from mimics_app.contracts.errors import Issue
from mimics_app.world.components.bounds import Extent, Point
from mimics_app.world.components.checked_scene import CheckedScene
from mimics_app.world.components.registry import Component, component, register_check

__all__ = ["PathWalker", "WalkingPath"]

Ground = Annotated[str, Meta(pattern="^[a-z0-9_]{0,40}$")]
"""Material of the ground, as `sound.material`."""

_SHORTEST = 0.05
"""Smallest length of a leg of a path [m]."""


@component("walking_path")
class WalkingPath(Component, frozen=True):
    """A path on the ground from corner to corner."""

    points: Annotated[
        tuple[Point, ...], Meta(min_length=2, max_length=200, description="Corners in order, in the world [m]")
    ]
    grounds: Annotated[
        tuple[Ground, ...],
        Meta(
            max_length=200,
            description="Material of the ground of each leg: asphalt, grass, ..; the last one for all further legs",
        ),
    ] = ()
    closed: Annotated[bool, Meta(description="The last corner is joined to the first, and walks go round")] = False


@component("path_walker")
class PathWalker(Component, frozen=True):
    """Somebody who walks along a `walking_path`, with a model whose steps sound as the ground; or a car."""

    path: Annotated[str, Meta(description="Id of the entity with the `walking_path`")]
    start: Annotated[Extent, Meta(description="Distance along the path at the begin of a trial [m]")] = 0.0
    aside: Annotated[float, Meta(ge=-20, le=20, description="Distance to the right of the path [m]")] = 0.0
    speed: Annotated[
        float,
        Meta(ge=0, le=15.0, description="Speed [m/s], of a car up to 15; not used by the person and with `beside`"),
    ] = 1.2
    beside: Annotated[
        str | None,
        Meta(description="Id of a walker who is accompanied: same pace, `start` ahead of them, on the same path"),
    ] = None


def _check_path(path: WalkingPath, pointer: str, scene: CheckedScene) -> list[Issue]:
    corners = [*path.points, path.points[0]] if path.closed else [*path.points]
    issues = [
        scene.issue(f"{pointer}/points/{i % len(path.points)}", "it is where the corner before it is", "leave it out")
        for i, (a, b) in enumerate(pairwise(corners), start=1)
        if sum((p - q) ** 2 for p, q in zip(a, b, strict=True)) < _SHORTEST**2
    ]
    legs = len(corners) - 1
    if len(path.grounds) > legs:
        what = f"{len(path.grounds)} grounds for {legs} legs"
        issues.append(scene.issue(f"{pointer}/grounds", what, "name one for each leg, or fewer"))
    return issues


def _check_walker(walker: PathWalker, pointer: str, scene: CheckedScene) -> list[Issue]:
    issues = scene.check_entity_with(WalkingPath, f"{pointer}/path", walker.path)
    return issues + scene.check_entity_with(PathWalker, f"{pointer}/beside", walker.beside)


register_check("walking_path", _check_path)
register_check("path_walker", _check_walker)
