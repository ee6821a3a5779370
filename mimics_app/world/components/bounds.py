"""What a number of a scene can be at all: types with a unit, a least and a greatest value, for every component.

Every number that a file gives has both bounds, so that no product of a few of them leaves double precision, and a slip
of the keyboard is refused with its pointer instead of being simulated. What a device, a person or another figure allows
of it is asked by the checks of its component. SI units, radians.
"""

from __future__ import annotations

from typing import Annotated

from msgspec import Meta

__all__ = [
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
    "PositiveForce",
    "PositiveSeconds",
    "Quaternion",
    "Seconds",
    "SignedFactor",
    "Speed",
    "Stiffness",
    "Vector",
]

Coordinate = Annotated[float, Meta(ge=-1e3, le=1e3)]
"""Where something is that can be touched [m]: within a kilometre a double resolves a tenth of a picometre."""

Point = tuple[Coordinate, Coordinate, Coordinate]

FarCoordinate = Annotated[float, Meta(ge=-1e6, le=1e6)]
"""Where something is that is only seen [m]."""

FarPoint = tuple[FarCoordinate, FarCoordinate, FarCoordinate]

Length = Annotated[float, Meta(gt=0, le=1e6)]
"""[m]: more has no finite square on a graphics card once it is placed."""

Extent = Annotated[float, Meta(ge=0, le=1e6)]
"""A length that may be nothing [m]."""

_Part = Annotated[float, Meta(ge=-2, le=2)]
Quaternion = tuple[_Part, _Part, _Part, _Part]
"""x, y, z, w; that its length is 1 is checked with its place."""

Angle = Annotated[float, Meta(ge=-1e3, le=1e3)]
"""[rad]"""

SignedFactor = Annotated[float, Meta(ge=-1e6, le=1e6)]
Vector = tuple[SignedFactor, SignedFactor, SignedFactor]
"""Of any unit whose figures stay below a million."""

Factor = Annotated[float, Meta(ge=0, le=1e6)]
"""A factor, or a figure of a unit in which people stay below a million."""

Light = Annotated[float, Meta(ge=0, le=1e6)]
"""A part of a colour, or the strength of a light, linear."""

Figure = Annotated[float, Meta(ge=-1e12, le=1e12)]
"""A number whose unit the file itself chooses."""

Seconds = Annotated[float, Meta(ge=0, le=86_400)]
PositiveSeconds = Annotated[float, Meta(gt=0, le=86_400)]
"""At most a day [s]."""

Frequency = Annotated[float, Meta(gt=0, le=1e5)]
"""[Hz]"""

Speed = Annotated[float, Meta(gt=0, le=100)]
"""[m/s, rad/s]"""

Acceleration = Annotated[float, Meta(gt=0, le=1e4)]
"""[m/s^2]"""

Mass = Annotated[float, Meta(ge=1e-3, le=1e3)]
"""Of what a hand moves with a robot [kg]."""

Force = Annotated[float, Meta(ge=0, le=1e3)]
PositiveForce = Annotated[float, Meta(gt=0, le=1e3)]
"""On or of a person [N]: four times the strongest robot of this kind."""

Stiffness = Annotated[float, Meta(ge=0, le=1e6)]
"""[N/m]: a thousand times what such a robot can render."""

Damping = Annotated[float, Meta(ge=0, le=1e5)]
"""[N s/m]"""

Name = Annotated[str, Meta(max_length=200)]
"""An id or another name of the file."""
