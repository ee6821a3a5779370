"""Wall files: the screens of a power wall or CAVE by their corners in the room."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from msgspec import Meta

from mimics_app.contracts.errors import Issue, SceneError
from mimics_app.rendering.visual.displays.display_size import too_many_pixels
from mimics_app.rendering.visual.displays.off_axis import Rectangle
from mimics_app.world.components.bounds import Point
from mimics_app.world.components.registry import Component
from mimics_app.world.files.reading.struct_file import read_struct_file

__all__ = ["WallSpec", "WallsSpec", "load_walls", "rectangle_of"]

_Pixels = Annotated[int, Meta(ge=1, le=8192)]
_Name = Annotated[str, Meta(pattern=r"^[A-Za-z0-9][A-Za-z0-9_-]{0,31}$", description="Letters, digits, - and _")]

_SQUARE = 1e-3
"""Largest cosine of the angle between a wall's edges."""
_MIN_EDGE = 0.01
"""Minimum length of an edge [m]."""


class WallSpec(Component, frozen=True):
    """One flat screen, as seen by a person in the room."""

    name: Annotated[_Name, Meta(description="Name of its files and window")]
    lower_left: Annotated[Point, Meta(description="Lower left corner in the room [m], +y up")]
    lower_right: Annotated[Point, Meta(description="Lower right corner [m]")]
    upper_left: Annotated[Point, Meta(description="Upper left corner [m]; the angle at the lower left is a right one")]
    pixels: Annotated[
        tuple[_Pixels, _Pixels] | None, Meta(description="Width, height [px]; absent: the requested height")
    ] = None
    window: Annotated[
        tuple[int, int] | None,
        Meta(description="Position of its window on the desktop [px]; absent: it fills a monitor other than the first"),
    ] = None


class WallsSpec(Component, frozen=True):
    """A power wall or a CAVE."""

    format: Annotated[Literal["mimics.walls/1"], Meta(description="Format of this file")]
    walls: Annotated[list[WallSpec], Meta(min_length=1, max_length=24, description="The screens, in any order")]
    head: Annotated[Point, Meta(description="Midpoint between the eyes of a person at rest [m]")] = (0.0, 1.7, 0.0)
    stereo: Annotated[bool, Meta(description="True: one picture per eye")] = False
    ipd: Annotated[float, Meta(ge=0.0, le=0.1, description="Interpupillary distance [m]")] = 0.063
    test_pattern: Annotated[
        bool, Meta(description="True: draws lines along the edges and a cross at each corner over the picture")
    ] = False


def rectangle_of(wall: WallSpec) -> Rectangle:
    """Return the wall in the room [m]."""
    corners = (np.array(corner, np.float64) for corner in (wall.lower_left, wall.lower_right, wall.upper_left))
    return Rectangle(*corners)


def load_walls(path: Path) -> WallsSpec:
    """Read a wall file.

    Raises:
        SceneError: all faults: schema, duplicate names, edges that are too short or not at right angles.
    """
    walls = read_struct_file(path, WallsSpec)
    issues = [issue for number in range(len(walls.walls)) for issue in _check(walls, number, str(path))]
    drawn = sum((2 if walls.stereo else 1) * math.prod(wall.pixels) for wall in walls.walls if wall.pixels)
    issues += [Issue(str(path), "/walls", what, "give fewer walls or pixels") for what in too_many_pixels(drawn)]
    if issues:
        raise SceneError(issues)
    return walls


def _check(walls: WallsSpec, number: int, file: str) -> list[Issue]:
    wall, pointer = walls.walls[number], f"/walls/{number}"
    issues = []
    if wall.name in [other.name for other in walls.walls[:number]]:
        issues.append(Issue(file, f"{pointer}/name", f'another wall is called "{wall.name}"', "give each its own name"))
    place = rectangle_of(wall)
    if min(place.width, place.height) < _MIN_EDGE:
        return [*issues, Issue(file, pointer, f"an edge is shorter than {_MIN_EDGE} m", "give three different corners")]
    right, up = (place.lower_right - place.lower_left) / place.width, (place.upper_left - place.lower_left)
    if abs(float(right @ up)) / place.height > _SQUARE:
        issues.append(Issue(file, pointer, "its edges are not at right angles", "correct upper_left"))
    return issues
