"""How a surface answers light, and the pictures laid on it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

__all__ = ["AlphaMode", "Filter", "Material", "Technique", "TextureData", "Wrap"]

Technique = Literal["lit", "unlit", "glass"]
AlphaMode = Literal["opaque", "mask", "blend"]
Wrap = Literal["repeat", "mirror", "clamp"]
Filter = Literal["nearest", "linear", "trilinear"]


@dataclass(frozen=True)
class Material:
    """Metallic-roughness material (glTF 2.0 3.9); colours are linear RGB.

    Attributes:
        name: Key in `World.materials`.
        technique: "lit" by lights and sky, "unlit" (base colour only), or "glass" (translucent, rim brighter).
        base_colour: Linear RGBA, 0-1; alpha is opacity where `alpha_mode` is "blend".
        metallic: 0 (dielectric) to 1 (metal).
        roughness: 0 (mirror) to 1 (matt).
        emission: Linear RGB light given off, >= 0.
        base_texture: Key in `World.textures` of a picture multiplied with the base colour, or None.
        alpha_mode: "opaque", "mask" (cut out below `alpha_cutoff`) or "blend".
        alpha_cutoff: Opacity below which "mask" draws nothing, 0-1.
        double_sided: True when back faces are drawn too.
        grid: Spacing of lines drawn over it [m], 0 for none: on the world's xz squares where lit, across the second
            texture coordinate, in its own unit, where glass: rings along a tube.
    """

    name: str
    technique: Technique = "lit"
    base_colour: tuple[float, float, float, float] = (0.8, 0.8, 0.8, 1.0)
    metallic: float = 0.0
    roughness: float = 0.6
    emission: tuple[float, float, float] = (0.0, 0.0, 0.0)
    base_texture: str | None = None
    alpha_mode: AlphaMode = "opaque"
    alpha_cutoff: float = 0.5
    double_sided: bool = False
    grid: float = 0.0


@dataclass(frozen=True, eq=False)
class TextureData:
    """A picture in memory.

    Attributes:
        pixels: RGBA, row 0 at the top, uint8 [height, width, 4].
        srgb: True when the colours are sRGB encoded and the sampler is to decode them.
        wrap: What lies outside 0-1 along u and v.
        filter: How texels are mixed; "trilinear" uses mip maps.
    """

    pixels: NDArray[np.uint8]
    srgb: bool = True
    wrap: tuple[Wrap, Wrap] = ("repeat", "repeat")
    filter: Filter = "trilinear"
