"""Effects: forces without a surface (D2.1 4.2.10 and the library's additions). SI units.

An effect that depends on a position refers to that of its entity; `within` bounds the region where it acts.
"""

from __future__ import annotations

from typing import Annotated

from msgspec import Meta

from mimics_app.world.components.bounds import Factor, Positive, Vector
from mimics_app.world.components.registry import Component

__all__ = [
    "ConstantForce",
    "Effect",
    "Guidance",
    "Magnet",
    "PathSpring",
    "Spring",
    "StickSlip",
    "Vibration",
    "Viscosity",
    "Workspace",
]

Extent = tuple[Positive, Positive, Positive]


class _Within(Component, frozen=True):
    """An effect with a bounded region."""

    within: Annotated[Factor, Meta(description="Radius about its place within which it acts [m]; 0: everywhere")] = 0.0


class _Pull(_Within, frozen=True, kw_only=True):
    """A spring and damper to a point or a path."""

    stiffness: Annotated[Positive, Meta(description="Stiffness [N/m]")]
    dead_band: Annotated[Factor, Meta(description="Distance below which it exerts no force [m]")] = 0.0
    largest_force: Annotated[Factor, Meta(description="Force limit of spring and damper together [N]; 0: none")] = 0.0


class Spring(_Pull, frozen=True, kw_only=True, tag="spring", tag_field="kind"):
    """Spring to a point."""

    damping: Annotated[Factor, Meta(description="Damping of all motion while it pulls [N s/m]")] = 0.0


class PathSpring(_Pull, frozen=True, kw_only=True, tag="path_spring", tag_field="kind"):
    """Spring to the closest point of a path; motion along the path is free."""

    path: Annotated[str, Meta(description="Id of an entity with a `haptic_path` or a `tunnel`")]
    damping: Annotated[Factor, Meta(description="Damping across the path while it pulls [N s/m]")] = 0.0


class Viscosity(_Within, frozen=True, kw_only=True, tag="viscosity", tag_field="kind"):
    """Viscous damping."""

    damping: Annotated[Positive, Meta(description="Damping [N s/m]")]
    largest_force: Annotated[Factor, Meta(description="Force limit [N]; 0: none")] = 0.0


class ConstantForce(_Within, frozen=True, kw_only=True, tag="constant_force", tag_field="kind"):
    """Constant force: a weight, a wind."""

    force: Annotated[Vector, Meta(description="Force, world [N]; not zero")]


class Magnet(Component, frozen=True, tag="magnet", tag_field="kind"):
    """Attraction that grows from 0 at `radius` towards its place, with a spring close to it."""

    radius: Annotated[Positive, Meta(description="Distance at which the attraction begins [m]")]
    force: Annotated[Positive, Meta(description="Attraction at its place, without the spring [N]")]
    stiffness: Annotated[Positive, Meta(description="Stiffness of the spring at its place [N/m]")]
    damping: Annotated[Factor, Meta(description="Damping at its place, falling to 0 at `radius` [N s/m]")] = 0.0


class Vibration(_Within, frozen=True, kw_only=True, tag="vibration", tag_field="kind"):
    """Sinusoidal force along a line; with an `object`, only while it is touched."""

    direction: Annotated[Vector, Meta(description="Direction, world, of any length but 0")]
    amplitude: Annotated[Positive, Meta(description="Amplitude [N]")]
    frequency: Annotated[float, Meta(gt=0, le=400, description="Frequency [Hz]; at 1 kHz at most 400 is rendered")]


class StickSlip(_Within, frozen=True, kw_only=True, tag="stick_slip", tag_field="kind"):
    """Spring to the point of sticking, released at a distance; with an `object`, only while it is touched."""

    stiffness: Annotated[Positive, Meta(description="Stiffness while it sticks [N/m]")]
    slip: Annotated[Positive, Meta(description="Distance at which it slips [m]")]


class Workspace(Component, frozen=True, tag="workspace", tag_field="kind"):
    """Spring and damper back into a ball or an axis-aligned box."""

    radius: Annotated[Positive | None, Meta(description="Radius of the ball [m]; or give `size`")] = None
    size: Annotated[Extent | None, Meta(description="Edges of the box along world x, y, z [m]; or give `radius`")] = (
        None
    )
    stiffness: Annotated[Positive, Meta(description="Stiffness [N/m]")] = 1000.0
    damping: Annotated[Factor, Meta(description="Damping of outward motion [N s/m]")] = 10.0
    largest_force: Annotated[Factor, Meta(description="Force limit [N]; 0: none")] = 0.0


class Guidance(_Within, frozen=True, kw_only=True, tag="guidance", tag_field="kind"):
    """Force along a path to its end; steady speed force / damping."""

    path: Annotated[str, Meta(description="Id of an entity with a `haptic_path` or a `tunnel`")]
    force: Annotated[Positive, Meta(description="Force along the path, fading over its last centimetre [N]")]
    damping: Annotated[Factor, Meta(description="Damping along the path [N s/m]")] = 0.0


Effect = Spring | PathSpring | Viscosity | ConstantForce | Magnet | Vibration | StickSlip | Workspace | Guidance
