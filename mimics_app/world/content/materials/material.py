"""Materials and textures."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

__all__ = ["IDENTITY", "MAPS", "MISSING_PICTURE", "Affine", "AlphaMode", "Filter", "Material", "TextureData", "Wrap"]

AlphaMode = Literal["opaque", "mask", "blend"]
Wrap = Literal["repeat", "mirror", "clamp"]
Filter = Literal["nearest", "linear", "trilinear"]
Affine = tuple[float, float, float, float, float, float]
"""Rows of the 2 x 3 matrix from the mesh's texture coordinates to a map's (KHR_texture_transform)."""

IDENTITY: Affine = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0)

MAPS = ("base", "normal", "surface", "occlusion", "emission")
"""Texture maps of a material, in the order of their bindings and of `Material.uv_transforms`."""


@dataclass(frozen=True)
class Material:
    """Metallic-roughness material (glTF 2.0 3.9); colours are linear RGB.

    Attributes:
        name: Key in `World.materials`.
        technique: Method of drawing: "pbr" (lights and sky, all maps), "lit" (the same, base map only), "lit_matt",
            "unlit" (base colour only), "glass" (translucent, rim brighter), or one of the scene's `techniques`.
        base_colour: Linear RGBA, 0-1; alpha is opacity where `alpha_mode` is "blend".
        metallic: 0 (dielectric) to 1 (metal).
        roughness: 0 (mirror) to 1 (matt).
        emission: Emitted radiance, linear RGB, >= 0.
        base_texture: Key in `World.textures` of the map multiplied with the base colour, or None.
        normal_texture: Key of the map of normals in tangent space, x right, y against v, z outwards.
        surface_texture: Key of the map of roughness (green) and metallic (blue), multiplied with the values above.
        occlusion_texture: Key of the map of the share of the sky's light that arrives (red).
        emission_texture: Key of the map multiplied with `emission`.
        normal_scale: Factor on x and y of the normal map.
        occlusion_strength: Strength of the occlusion map, 0-1.
        uv_transforms: Transform of the mesh's texture coordinates for each of the `MAPS`.
        second_uv: Those of the `MAPS` that lie on the mesh's second texture coordinates.
        alpha_mode: "opaque", "mask" (cut out below `alpha_cutoff`) or "blend".
        alpha_cutoff: Opacity below which "mask" draws nothing, 0-1.
        double_sided: True when back faces are drawn too.
        grid: Spacing of lines drawn over it [m], 0 for none: on the world's xz squares where lit, across the second
            texture coordinate, in its own unit, where glass: rings along a tube.
        softness: Wrap of diffuse light into the shade, 0 (stone) to 1 (skin), widest for red.
    """

    name: str
    technique: str = "lit"
    base_colour: tuple[float, float, float, float] = (0.8, 0.8, 0.8, 1.0)
    metallic: float = 0.0
    roughness: float = 0.6
    emission: tuple[float, float, float] = (0.0, 0.0, 0.0)
    base_texture: str | None = None
    normal_texture: str | None = None
    surface_texture: str | None = None
    occlusion_texture: str | None = None
    emission_texture: str | None = None
    normal_scale: float = 1.0
    occlusion_strength: float = 1.0
    uv_transforms: tuple[Affine, ...] = (IDENTITY,) * len(MAPS)
    second_uv: tuple[str, ...] = ()
    alpha_mode: AlphaMode = "opaque"
    alpha_cutoff: float = 0.5
    double_sided: bool = False
    grid: float = 0.0
    softness: float = 0.0

    @property
    def textures(self) -> dict[str, str]:
        """Keys in `World.textures` of the maps it has, by name in `MAPS`."""
        keys = {name: getattr(self, f"{name}_texture") for name in MAPS}
        return {name: key for name, key in keys.items() if key is not None}


@dataclass(frozen=True, eq=False)
class TextureData:
    """A texture in memory.

    Attributes:
        pixels: RGBA, row 0 at the top, uint8 [height, width, 4].
        srgb: True when the colours are sRGB encoded and the sampler is to decode them.
        wrap: Addressing outside 0-1 along u and v.
        filter: Texture filter; "trilinear" uses mipmaps.
    """

    pixels: NDArray[np.uint8]
    srgb: bool = True
    wrap: tuple[Wrap, Wrap] = ("repeat", "repeat")
    filter: Filter = "trilinear"


def _checker() -> NDArray[np.uint8]:
    dark = (np.indices((8, 8)).sum(axis=0) % 2).astype(bool)
    return np.where(dark[..., None], (24, 24, 24, 255), (255, 0, 200, 255)).astype(np.uint8)


MISSING_PICTURE = TextureData(_checker(), filter="nearest")
"""Placeholder of a missing texture."""
