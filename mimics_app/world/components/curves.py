"""The curve of a tunnel or of a path for effects: control points of a spline, or a recorded path to fit."""

from __future__ import annotations

from typing import Annotated

from msgspec import Meta

from mimics_app.contracts.errors import Issue
from mimics_app.contracts.loop.haptic_objects import MAX_PIECES
from mimics_app.world.components.bounds import Point
from mimics_app.world.components.checked_scene import CheckedScene
from mimics_app.world.components.registry import Component

__all__ = ["Curve", "check_curve"]

_DEGREE = 3


class Curve(Component, frozen=True):
    """A cubic B-spline; the check reports a tighter limit of its points."""

    control_points: Annotated[
        Annotated[tuple[Point, ...], Meta(max_length=1000)] | None,
        Meta(description="Control points of the cubic B-spline, world [m]; at least 4"),
    ] = None
    path_file: Annotated[
        str | None,
        Meta(description="Recorded path to fit instead: .csv (x,y,z columns) or .json ([[x,y,z],..]), world [m]"),
    ] = None
    basis_functions: Annotated[
        Annotated[int, Meta(ge=4, le=99)] | None, Meta(description="Basis functions fitted to `path_file`")
    ] = None


def check_curve(curve: Curve, pointer: str, scene: CheckedScene) -> list[Issue]:
    """Faults of what a component says of its curve; the haptic stage checks that it can be built."""
    points = curve.control_points
    if (points is None) == (curve.path_file is None):
        return [scene.issue(pointer, "needs either control_points or a path_file", "give exactly one of the two")]
    issues = []
    if curve.path_file is not None:
        issues += scene.check_file(f"{pointer}/path_file", curve.path_file)
    elif curve.basis_functions is not None:
        where = f"{pointer}/basis_functions"
        issues.append(scene.issue(where, "applies to a path_file, and there is none", "leave it out"))
    if points is not None and not _DEGREE + 1 <= len(points) <= MAX_PIECES + _DEGREE:
        what = f"{len(points)} control points; a cubic takes {_DEGREE + 1} to {MAX_PIECES + _DEGREE}"
        issues.append(scene.issue(f"{pointer}/control_points", what))
    return issues
