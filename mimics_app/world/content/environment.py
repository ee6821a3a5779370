"""Sky, fog and ambient light."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

__all__ = ["Backdrop", "BackdropKind", "Fog", "FogKind", "Sky"]

Colour = tuple[float, float, float]
FogKind = Literal["squared", "exponential", "linear"]
BackdropKind = Literal["box", "dome", "plane"]


@dataclass(frozen=True)
class Fog:
    """Fog: attenuation with distance.

    Attributes:
        kind: Transmittance at a distance s beyond `start`: exp(-(density s)^2), exp(-density s), or
            1 - density s.
        density: Density [1/m].
        start: Distance at which the fog begins [m].
        colour: Linear RGB of the fog; None: that of the horizon.
    """

    kind: FogKind = "squared"
    density: float = 0.0
    start: float = 0.0
    colour: Colour | None = None


@dataclass(frozen=True)
class Backdrop:
    """Textures over the sky, infinitely far away; the sky's colours show where they are transparent.

    Attributes:
        kind: "box": six textures as seen from inside, towards +x -x +y -y +z -z; the lower edge of +y and the upper
            edge of -y join the one towards -z; "dome": one texture, longitude along u (-z at its centre) and
            latitude along v; "plane": one texture on a horizontal plane, which fades into the horizon.
        textures: Keys in `World.textures`, six or one.
        height: Height of the plane above the camera [m].
        tile: Width of one texture tile on the plane [m].
    """

    kind: BackdropKind
    textures: tuple[str, ...]
    height: float = 40.0
    tile: float = 100.0


@dataclass(frozen=True)
class Sky:
    """Sky colours, ambient light and fog; colours are linear RGB.

    Attributes:
        zenith: Colour straight up.
        horizon: Colour at the horizon.
        ground: Colour below the horizon.
        ambient: Factor on the ambient light of surfaces.
        fog: Fog; None: that of the picture's settings.
        backdrop: Textures over the sky, or None.
        scatter: Share of the sun's light that arrives from all directions, scattered by haze and surroundings.
    """

    zenith: Colour = (0.18, 0.30, 0.52)
    horizon: Colour = (0.62, 0.70, 0.78)
    ground: Colour = (0.20, 0.19, 0.18)
    ambient: float = 0.5
    fog: Fog | None = None
    backdrop: Backdrop | None = None
    scatter: float = 0.1
