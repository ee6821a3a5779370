"""One material ready to draw: shaders with their render state, uniforms and textures."""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from mimics_app.rendering.visual.materials.picture_arrays import PictureArray
from mimics_app.rendering.visual.materials.shader_library import ShaderProgram
from mimics_app.rendering.visual.pictures.live_picture import LivePicture
from mimics_app.world.content.materials.material import MAPS, Material, TextureData
from mimics_app.world.content.materials.technique import Blend, Cull, Depth, PassSpec

if TYPE_CHECKING:
    import moderngl

__all__ = ["MaterialInstance", "MaterialPass", "make_pass", "pack_material"]

_BLOCK = np.dtype(
    [
        ("base_colour", "f4", (4,)),
        ("emission", "f4", (4,)),
        ("metallic_roughness", "f4", (4,)),
        ("map_strength", "f4", (4,)),
        ("uv_rows", "f4", (2 * len(MAPS), 4)),
    ]
)
"""The layout of shaders/common/material_block.glsl, std140."""

_BLOCK_BINDING = 1


@dataclass(frozen=True, eq=False)
class MaterialPass:
    """A shader and its render state: blending, face culling, depth test and write."""

    shader: ShaderProgram
    blend: Blend
    cull: Cull
    depth: Depth


@dataclass(eq=False)
class MaterialInstance:
    """One material ready to draw.

    Attributes:
        material: The material.
        passes: Passes that draw it to the picture, in order.
        shadow_shader: Shader of the depth pass.
        block: Uniform block of the material.
        textures: Bindings and textures; `instance_params` selects the layer of a texture array.
        state: Equal for instances that one draw call may draw together; only `instance_params` may differ between them.
        shadow_state: The same for the shadow pass.
        instance_params: Instance parameters, whose meaning depends on the shader.
    """

    material: Material
    passes: tuple[MaterialPass, ...]
    shadow_shader: ShaderProgram
    block: moderngl.Buffer
    textures: tuple[tuple[int, moderngl.Texture | PictureArray | LivePicture], ...]
    state: Hashable
    shadow_state: Hashable
    instance_params: tuple[float, float, float, float] = (1.0, 1.0, 1.0, 1.0)

    @property
    def transparent(self) -> bool:
        """Whether it is blended and has to be sorted."""
        return any(each.blend != "none" for each in self.passes)

    @property
    def one_sided(self) -> bool:
        """Whether its back faces are never drawn."""
        return all(each.cull == "back" for each in self.passes)

    @property
    def solid(self) -> bool:
        """Whether it is opaque: no blending, no holes."""
        written = any(each.depth == "write" for each in self.passes)
        return written and not self.transparent and self.material.alpha_mode == "opaque"

    def bind(self) -> None:
        """Bind uniform block and textures."""
        self.block.bind_to_uniform_block(_BLOCK_BINDING)
        for binding, texture in self.textures:
            texture.use(binding)


def make_pass(spec: PassSpec, shader: ShaderProgram, material: Material) -> MaterialPass:
    """Return a pass whose state "material" is resolved by the material."""
    blend, cull, depth = spec.blend, spec.cull, spec.depth
    if blend == "material":
        blend = "alpha" if material.alpha_mode == "blend" else "none"
    if cull == "material":
        cull = "none" if material.double_sided else "back"
    if depth == "material":
        depth = "write" if blend == "none" else "test"
    return MaterialPass(shader, blend, cull, depth)


def pack_material(material: Material, pictures: Mapping[str, TextureData]) -> np.ndarray[tuple[()], np.dtype[np.void]]:
    """Return the uniform block of a material.

    Args:
        material: The material.
        pictures: Its textures by map; a mirrored one is stored beside its reflection and read at half the rate.
    """
    block = np.zeros((), _BLOCK)
    block["base_colour"] = material.base_colour
    block["emission"] = (*material.emission, material.alpha_cutoff if material.alpha_mode == "mask" else -1.0)
    block["metallic_roughness"] = (material.metallic, material.roughness, material.grid, float(material.double_sided))
    rates = np.array([_rates(pictures.get(which)) for which in MAPS])
    block["map_strength"] = (material.normal_scale, material.occlusion_strength, material.softness, 0.0)
    rows = np.array(material.uv_transforms, np.float64).reshape(len(MAPS), 2, 3)
    rows *= rates[:, :, None]
    block["uv_rows"][:, :3] = rows.reshape(-1, 3)
    return block


def _rates(picture: TextureData | None) -> tuple[float, float]:
    """Return the factors on the texture coordinates of an uploaded texture."""
    along_u, along_v = ("repeat", "repeat") if picture is None else picture.wrap
    return 0.5 if along_u == "mirror" else 1.0, 0.5 if along_v == "mirror" else 1.0
