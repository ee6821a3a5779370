"""Bounded number types of components, each with a unit, a minimum and a maximum.

Both bounds hold for every number of a scene file, so that no product of a few leaves double precision and a typing
error is refused with its pointer instead of being simulated. Limits set by a device, a person or another number belong
to the checks of each component. SI units, radians.
"""

from __future__ import annotations

from typing import Annotated

from msgspec import Meta

__all__ = [
    "NO_ROTATION",
    "Acceleration",
    "Angle",
    "Coordinate",
    "Damping",
    "Extent",
    "Factor",
    "FarCoordinate",
    "FarPoint",
    "Figure",
    "Force",
    "Frequency",
    "Length",
    "Light",
    "Mass",
    "Name",
    "Point",
    "Positive",
    "PositiveForce",
    "PositiveSeconds",
    "Quaternion",
    "Seconds",
    "Share",
    "SignedFactor",
    "Speed",
    "Stiffness",
    "Vector",
]

Coordinate = Annotated[float, Meta(ge=-1e3, le=1e3)]
"""Coordinate of objects that can be touched [m]: within a kilometre a double resolves a tenth of a picometre."""

Point = tuple[Coordinate, Coordinate, Coordinate]

FarCoordinate = Annotated[float, Meta(ge=-1e6, le=1e6)]
"""Coordinate of objects that are only visible [m]."""

FarPoint = tuple[FarCoordinate, FarCoordinate, FarCoordinate]

Length = Annotated[float, Meta(gt=0, le=1e6)]
"""Length [m]; squares of larger placed lengths overflow on a graphics card."""

Extent = Annotated[float, Meta(ge=0, le=1e6)]
"""Length that may be 0 [m]."""

_Part = Annotated[float, Meta(ge=-2, le=2)]
Quaternion = tuple[_Part, _Part, _Part, _Part]
"""x, y, z, w; the check of each component requires length 1."""
NO_ROTATION: Quaternion = (0.0, 0.0, 0.0, 1.0)

Angle = Annotated[float, Meta(ge=-1e3, le=1e3)]
"""Angle [rad]."""

SignedFactor = Annotated[float, Meta(ge=-1e6, le=1e6)]
Vector = tuple[SignedFactor, SignedFactor, SignedFactor]
"""Vector of any unit whose values stay below a million."""

Factor = Annotated[float, Meta(ge=0, le=1e6)]
"""Factor, or number of any unit, from 0 to a million."""

Positive = Annotated[float, Meta(gt=0, le=1e6)]
"""Number of any unit above 0, to a million."""

Share = Annotated[float, Meta(ge=0, le=1)]
"""Part of a whole."""

Light = Annotated[float, Meta(ge=0, le=1e6)]
"""Component of a colour, or intensity of a light, linear."""

Figure = Annotated[float, Meta(ge=-1e12, le=1e12)]
"""Number whose unit the file chooses."""

Seconds = Annotated[float, Meta(ge=0, le=86_400)]
PositiveSeconds = Annotated[float, Meta(gt=0, le=86_400)]
"""Duration of at most a day [s]."""

Frequency = Annotated[float, Meta(gt=0, le=1e5)]
"""Frequency [Hz]."""

Speed = Annotated[float, Meta(gt=0, le=100)]
"""Speed [m/s, rad/s]."""

Acceleration = Annotated[float, Meta(gt=0, le=1e4)]
"""Acceleration [m/s^2]."""

Mass = Annotated[float, Meta(ge=1e-3, le=1e3)]
"""Mass that a person moves with a robot [kg]."""

Force = Annotated[float, Meta(ge=0, le=1e3)]
PositiveForce = Annotated[float, Meta(gt=0, le=1e3)]
"""Force on or of a person [N]: four times that of the strongest robot of this kind."""

Stiffness = Annotated[float, Meta(ge=0, le=1e6)]
"""Stiffness [N/m]: a thousand times what such a robot can render."""

Damping = Annotated[float, Meta(ge=0, le=1e5)]
"""Damping [N s/m]."""

Name = Annotated[str, Meta(max_length=200)]
ContactName = Annotated[str, Meta(min_length=1, max_length=32)]
"""Name of a point of contact of a device, as its descriptor gives it: "hand", "left foot"."""
"""Id or other name in the file."""
