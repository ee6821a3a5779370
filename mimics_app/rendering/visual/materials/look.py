"""One material ready to draw: shaders with their render state, numbers and pictures."""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from mimics_app.rendering.visual.materials.picture_arrays import PictureArray
from mimics_app.rendering.visual.materials.shader_library import ShaderProgram
from mimics_app.rendering.visual.pictures.live_picture import LivePicture
from mimics_app.world.materials.material import MAPS, Material, TextureData
from mimics_app.world.materials.technique import Blend, Cull, Depth, PassSpec

if TYPE_CHECKING:
    import moderngl

__all__ = ["Look", "LookPass", "make_pass", "pack_material"]

_BLOCK = np.dtype(
    [
        ("base_colour", "f4", (4,)),
        ("emission", "f4", (4,)),
        ("finish", "f4", (4,)),
        ("map_strength", "f4", (4,)),
        ("uv_rows", "f4", (2 * len(MAPS), 4)),
    ]
)
"""The layout of shaders/common/material_block.glsl, std140."""

_BLOCK_BINDING = 1


@dataclass(frozen=True, eq=False)
class LookPass:
    """A shader and the state it is used with: how it blends, what it leaves out, what it does with depth."""

    shader: ShaderProgram
    blend: Blend
    cull: Cull
    depth: Depth


@dataclass(eq=False)
class Look:
    """One material ready to draw.

    Attributes:
        material: What it shows.
        passes: Draw it to the picture, in order.
        shadow_shader: Draws its depth seen from a light.
        block: The material's numbers.
        textures: Its pictures with their bindings; an array of pictures where `paint` says which.
        state: Equal for looks that one call to the driver may draw together: only `paint` differs between them then.
        shadow_state: The same for the shadow pass.
        paint: Four numbers that come with each instance; what they mean is the shader's to say.
    """

    material: Material
    passes: tuple[LookPass, ...]
    shadow_shader: ShaderProgram
    block: moderngl.Buffer
    textures: tuple[tuple[int, moderngl.Texture | PictureArray | LivePicture], ...]
    state: Hashable
    shadow_state: Hashable
    paint: tuple[float, float, float, float] = (1.0, 1.0, 1.0, 1.0)

    @property
    def transparent(self) -> bool:
        """True when it is blended and has to be sorted."""
        return any(each.blend != "none" for each in self.passes)

    @property
    def solid(self) -> bool:
        """True when nothing can be seen through it: no blending, no holes."""
        written = any(each.depth == "write" for each in self.passes)
        return written and not self.transparent and self.material.alpha_mode == "opaque"

    def bind(self) -> None:
        """Make it what the shaders read."""
        self.block.bind_to_uniform_block(_BLOCK_BINDING)
        for binding, texture in self.textures:
            texture.use(binding)


def make_pass(spec: PassSpec, shader: ShaderProgram, material: Material) -> LookPass:
    """A pass with what it leaves to the material filled in."""
    blend, cull, depth = spec.blend, spec.cull, spec.depth
    if blend == "material":
        blend = "alpha" if material.alpha_mode == "blend" else "none"
    if cull == "material":
        cull = "none" if material.double_sided else "back"
    if depth == "material":
        depth = "write" if blend == "none" else "test"
    return LookPass(shader, blend, cull, depth)


def pack_material(material: Material, pictures: Mapping[str, TextureData]) -> np.ndarray[tuple[()], np.dtype[np.void]]:
    """The numbers of a material as the shaders read them.

    Args:
        material: Whose.
        pictures: Its pictures by map; a mirrored one lies beside its reflection and is read at half the rate.
    """
    block = np.zeros((), _BLOCK)
    block["base_colour"] = material.base_colour
    block["emission"] = (*material.emission, material.alpha_cutoff if material.alpha_mode == "mask" else -1.0)
    block["finish"] = (material.metallic, material.roughness, material.grid, float(material.double_sided))
    rates = np.array([_rates(pictures.get(which)) for which in MAPS])
    block["map_strength"] = (material.normal_scale, material.occlusion_strength, material.softness, 0.0)
    rows = np.array(material.uv_transforms, np.float64).reshape(len(MAPS), 2, 3)
    rows *= rates[:, :, None]
    block["uv_rows"][:, :3] = rows.reshape(-1, 3)
    return block


def _rates(picture: TextureData | None) -> tuple[float, float]:
    """Factors on the texture coordinates of a picture as it is uploaded."""
    along_u, along_v = ("repeat", "repeat") if picture is None else picture.wrap
    return 0.5 if along_u == "mirror" else 1.0, 0.5 if along_v == "mirror" else 1.0
