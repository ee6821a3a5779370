"""The sky, the haze, and the light that comes from everywhere."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

__all__ = ["Backdrop", "BackdropKind", "Fog", "FogKind", "Sky"]

Colour = tuple[float, float, float]
FogKind = Literal["squared", "exponential", "linear"]
BackdropKind = Literal["box", "dome", "plane"]


@dataclass(frozen=True)
class Fog:
    """How much of what is far away is lost in haze.

    Attributes:
        kind: Share that is seen at a distance s beyond `start`: exp(-(density s)^2), exp(-density s), or
            1 - density s.
        density: [1/m].
        start: Distance up to which nothing is lost [m].
        colour: Linear RGB of the haze; None: the horizon's.
    """

    kind: FogKind = "squared"
    density: float = 0.0
    start: float = 0.0
    colour: Colour | None = None


@dataclass(frozen=True)
class Backdrop:
    """Pictures laid over the sky, infinitely far away; where they are clear the sky's colours are seen.

    Attributes:
        kind: "box": six pictures as seen from inside, towards +x -x +y -y +z -z; +y and -y join the one towards -z
            with their lower and upper edge; "dome": one picture of longitude along u (-z in its middle) and
            latitude along v; "plane": one picture laid out at a height, which fades into the horizon.
        textures: Keys in `World.textures`, six or one.
        height: Of the plane above the eye [m].
        tile: Width of the picture on the plane [m].
    """

    kind: BackdropKind
    textures: tuple[str, ...]
    height: float = 40.0
    tile: float = 100.0


@dataclass(frozen=True)
class Sky:
    """Colours are linear RGB.

    Attributes:
        zenith: Straight up.
        horizon: At the horizon.
        ground: Below it.
        ambient: Factor on the light from all around on surfaces.
        fog: The haze; None: as the picture's settings say.
        backdrop: Pictures over the sky, or None.
        scatter: Share of the sun's light that comes from all around, off haze and lit surroundings.
    """

    zenith: Colour = (0.18, 0.30, 0.52)
    horizon: Colour = (0.62, 0.70, 0.78)
    ground: Colour = (0.20, 0.19, 0.18)
    ambient: float = 0.5
    fog: Fog | None = None
    backdrop: Backdrop | None = None
    scatter: float = 0.1
