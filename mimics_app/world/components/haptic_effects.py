"""Effects: forces without a surface (D2.1 4.2.10 and the library's additions). SI units.

Where the force of an effect depends on a place, that is the place of its entity; `within` bounds where it acts.
"""

from __future__ import annotations

from typing import Annotated

from msgspec import Meta

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

_MOST = 1e6

NotNegative = Annotated[float, Meta(ge=0, le=_MOST)]
Positive = Annotated[float, Meta(gt=0, le=_MOST)]
Number = Annotated[float, Meta(ge=-_MOST, le=_MOST)]
Point = tuple[Number, Number, Number]
Extent = tuple[Positive, Positive, Positive]


class _Within(Component, frozen=True):
    """An effect that may be bounded."""

    within: Annotated[NotNegative, Meta(description="Acts only this near to its place [m]; 0: everywhere")] = 0.0


class Spring(_Within, frozen=True, kw_only=True, tag="spring", tag_field="kind"):
    """Pulls to a point."""

    stiffness: Annotated[Positive, Meta(description="[N/m]")]
    damping: Annotated[NotNegative, Meta(description="Of all motion while it pulls [N s/m]")] = 0.0
    dead_band: Annotated[NotNegative, Meta(description="Nearer than this it leaves the hand alone [m]")] = 0.0
    largest_force: Annotated[NotNegative, Meta(description="Of spring and damper together [N]; 0: no bound")] = 0.0


class PathSpring(_Within, frozen=True, kw_only=True, tag="path_spring", tag_field="kind"):
    """Pulls to the closest point of a path; motion along the path is free."""

    path: Annotated[str, Meta(description="Id of an entity with a `haptic_path` or a `tunnel`")]
    stiffness: Annotated[Positive, Meta(description="[N/m]")]
    damping: Annotated[NotNegative, Meta(description="Across the path, while it pulls [N s/m]")] = 0.0
    dead_band: Annotated[NotNegative, Meta(description="Nearer than this it leaves the hand alone [m]")] = 0.0
    largest_force: Annotated[NotNegative, Meta(description="Of spring and damper together [N]; 0: no bound")] = 0.0


class Viscosity(_Within, frozen=True, kw_only=True, tag="viscosity", tag_field="kind"):
    """Brakes, as a thick liquid would."""

    damping: Annotated[Positive, Meta(description="[N s/m]")]
    largest_force: Annotated[NotNegative, Meta(description="[N]; 0: no bound")] = 0.0


class ConstantForce(_Within, frozen=True, kw_only=True, tag="constant_force", tag_field="kind"):
    """The same force wherever it acts: a weight, a wind."""

    force: Annotated[Point, Meta(description="World [N]; not zero")]


class Magnet(Component, frozen=True, tag="magnet", tag_field="kind"):
    """Attracts the more the nearer, from nothing at `radius`; a spring holds close to its place."""

    radius: Annotated[Positive, Meta(description="Where the attraction begins [m]")]
    force: Annotated[Positive, Meta(description="It would reach at its place, without the spring [N]")]
    stiffness: Annotated[Positive, Meta(description="Of the spring at its place [N/m]")]
    damping: Annotated[NotNegative, Meta(description="At its place, falling to 0 at `radius` [N s/m]")] = 0.0


class Vibration(_Within, frozen=True, kw_only=True, tag="vibration", tag_field="kind"):
    """Shakes along a line; with an `object`, only while that is touched."""

    direction: Annotated[Point, Meta(description="World; of any length but 0")]
    amplitude: Annotated[Positive, Meta(description="[N]")]
    frequency: Annotated[float, Meta(gt=0, le=400, description="[Hz]; at 1 kHz no more than 400 is rendered")]


class StickSlip(_Within, frozen=True, kw_only=True, tag="stick_slip", tag_field="kind"):
    """Sticks where the hand is, and lets go with a jerk; with an `object`, only while that is touched."""

    stiffness: Annotated[Positive, Meta(description="Of what sticks [N/m]")]
    slip: Annotated[Positive, Meta(description="Distance at which it lets go [m]")]


class Workspace(Component, frozen=True, tag="workspace", tag_field="kind"):
    """Pushes back into a ball or an upright box."""

    radius: Annotated[Positive | None, Meta(description="Of the ball [m]; or give `size`")] = None
    size: Annotated[Extent | None, Meta(description="Edges of the box along world x, y, z [m]; or give `radius`")] = (
        None
    )
    stiffness: Annotated[Positive, Meta(description="[N/m]")] = 1000.0
    damping: Annotated[NotNegative, Meta(description="On the way out [N s/m]")] = 10.0
    largest_force: Annotated[NotNegative, Meta(description="[N]; 0: no bound")] = 0.0


class Guidance(_Within, frozen=True, kw_only=True, tag="guidance", tag_field="kind"):
    """Leads along a path to its end; steady speed force / damping."""

    path: Annotated[str, Meta(description="Id of an entity with a `haptic_path` or a `tunnel`")]
    force: Annotated[Positive, Meta(description="Along the path, fading over its last centimetre [N]")]
    damping: Annotated[NotNegative, Meta(description="Along the path [N s/m]")] = 0.0


Effect = Spring | PathSpring | Viscosity | ConstantForce | Magnet | Vibration | StickSlip | Workspace | Guidance
