"""Materials and textures on the GPU, and which shader draws each."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from mimics_app.rendering.visual.shader_library import ShaderLibrary, ShaderProgram
from mimics_app.world.material import Material, TextureData
from mimics_app.world.world import World

if TYPE_CHECKING:
    import moderngl

__all__ = ["Look", "MaterialStore"]

_BLOCK = np.dtype(
    [("base_colour", "f4", (4,)), ("emission", "f4", (4,)), ("finish", "f4", (4,)), ("uv_scale", "f4", (4,))]
)
"""The layout of shaders/common/material.glsl, std140."""

_BLOCK_BINDING, _TEXTURE_BINDING = 1, 0
_SRGB8_ALPHA8 = 0x8C43
_MATT = 0.95
"""Roughness from which a dielectric's mirroring is left out: it is spread out to about 2 % of what shines on it."""
_FALLBACK = Material("")


@dataclass(eq=False)
class Look:
    """One material ready to draw.

    Attributes:
        material: What it shows.
        shader: Draws it to the picture.
        shadow_shader: Draws its depth seen from the sun.
        block: The material's numbers.
        texture: Its picture, or None.
    """

    material: Material
    shader: ShaderProgram
    shadow_shader: ShaderProgram
    block: moderngl.Buffer
    texture: moderngl.Texture | None

    @property
    def transparent(self) -> bool:
        """True when it is blended and has to be sorted."""
        return self.material.technique == "glass" or self.material.alpha_mode == "blend"

    def bind(self) -> None:
        """Make it what the shaders read."""
        self.block.bind_to_uniform_block(_BLOCK_BINDING)
        if self.texture is not None:
            self.texture.use(_TEXTURE_BINDING)


class MaterialStore:
    """Looks by material name, made anew when the world's material or texture object is another."""

    def __init__(self, ctx: moderngl.Context, shaders: ShaderLibrary) -> None:
        self._ctx = ctx
        self._shaders = shaders
        self._looks: dict[str, Look] = {}
        self._textures: dict[str, tuple[TextureData, moderngl.Texture]] = {}
        self._placed_lights = False

    def update(self, world: World, *, placed_lights: bool) -> bool:
        """Bring the looks up to the world's materials.

        Args:
            world: Whose materials.
            placed_lights: True when a point or spot light shines; without one the shaders leave them out.

        Returns:
            True when one came, went or changed.
        """
        all_stale = placed_lights != self._placed_lights
        self._placed_lights = placed_lights
        stale = [name for name in self._looks if all_stale or (name and name not in world.materials)]
        for name in stale:
            self._looks.pop(name).block.release()
        changed = bool(stale)
        for name, material in world.materials.items():
            known = self._looks.get(name)
            if known is None or known.material is not material or not self._is_current(material, world):
                self._replace(name, material, world)
                changed = True
        return changed

    def look(self, name: str) -> Look:
        """The look of a material; plain grey for a name the world does not have."""
        if name not in self._looks and "" not in self._looks:
            self._looks[""] = self._make(_FALLBACK, None)
        return self._looks.get(name) or self._looks[""]

    def release(self) -> None:
        """Free all buffers and textures."""
        for look in self._looks.values():
            look.block.release()
        for _, texture in self._textures.values():
            texture.release()
        self._looks.clear()
        self._textures.clear()

    def _is_current(self, material: Material, world: World) -> bool:
        name = material.base_texture
        return name is None or name not in world.textures or self._textures[name][0] is world.textures[name]

    def _replace(self, name: str, material: Material, world: World) -> None:
        known = self._looks.get(name)
        if known:
            known.block.release()
        picture = world.textures.get(material.base_texture) if material.base_texture else None
        self._looks[name] = self._make(material, picture)

    def _make(self, material: Material, picture: TextureData | None) -> Look:
        texture = self._upload(material.base_texture or "", picture) if picture is not None else None
        block = self._ctx.buffer(_pack(material, picture).tobytes())
        return Look(material, self._shader(material, texture), self._shadow_shader(material, texture), block, texture)

    def _shader(self, material: Material, texture: moderngl.Texture | None) -> ShaderProgram:
        defines = []
        if texture is not None:
            defines.append("TEXTURED")
        if material.alpha_mode == "mask" and material.technique != "glass":
            defines.append("MASKED")
        if material.technique == "lit" and self._placed_lights:
            defines.append("PLACED_LIGHTS")
        if material.technique == "lit" and material.roughness >= _MATT and material.metallic == 0.0:
            defines.append("MATT")
        if material.grid > 0.0 and material.technique != "unlit":
            defines.append("GRID")
        return self._shaders.program(
            "common/mesh.vert", f"{material.technique}/{material.technique}.frag", tuple(defines)
        )

    def _shadow_shader(self, material: Material, texture: moderngl.Texture | None) -> ShaderProgram:
        defines = []
        if texture is not None and material.alpha_mode == "mask":
            defines.append("TEXTURED")
        if material.technique == "glass" or material.alpha_mode == "blend":
            defines.append("TRANSLUCENT")
        return self._shaders.program("shadow/shadow.vert", "shadow/shadow.frag", tuple(defines))

    def _upload(self, name: str, picture: TextureData) -> moderngl.Texture:
        known = self._textures.get(name)
        if known and known[0] is picture:
            return known[1]
        if known:
            known[1].release()
        texture = _make_texture(self._ctx, picture)
        self._textures[name] = (picture, texture)
        return texture


def _pack(material: Material, picture: TextureData | None) -> np.ndarray[tuple[()], np.dtype[np.void]]:
    block = np.zeros((), _BLOCK)
    block["base_colour"] = material.base_colour
    block["emission"] = (*material.emission, material.alpha_cutoff if material.alpha_mode == "mask" else -1.0)
    block["finish"] = (material.metallic, material.roughness, material.grid, float(material.double_sided))
    wrap = picture.wrap if picture is not None else ("repeat", "repeat")
    block["uv_scale"] = (*(0.5 if side == "mirror" else 1.0 for side in wrap), 0.0, 0.0)
    return block


def _make_texture(ctx: moderngl.Context, picture: TextureData) -> moderngl.Texture:
    import moderngl

    pixels = np.ascontiguousarray(picture.pixels, np.uint8)
    # moderngl repeats or clamps; a mirrored picture is laid beside its reflection and read at half the rate.
    for side, axis in zip(picture.wrap, (1, 0), strict=True):
        if side == "mirror":
            pixels = np.concatenate([pixels, np.flip(pixels, axis)], axis)
    height, width = pixels.shape[:2]
    texture = ctx.texture((width, height), 4, pixels.tobytes(), internal_format=_SRGB8_ALPHA8 if picture.srgb else None)
    texture.repeat_x, texture.repeat_y = (side != "clamp" for side in picture.wrap)
    if picture.filter == "trilinear":
        texture.build_mipmaps()
        texture.filter = (moderngl.LINEAR_MIPMAP_LINEAR, moderngl.LINEAR)
    else:
        texture.filter = (moderngl.NEAREST,) * 2 if picture.filter == "nearest" else (moderngl.LINEAR,) * 2
    return texture
