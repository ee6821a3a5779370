"""Materials and textures on the GPU, and which shader draws each."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from mimics_app.rendering.visual.picture_arrays import PictureArray, PictureArrays, encode_srgb, set_sampling, unfolded
from mimics_app.rendering.visual.settings import Shading
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
        texture: Its picture, or None; an array of pictures where `paint` says which.
        state: Equal for looks that one call to the driver may draw together: only `paint` tells them apart then.
        shadow_state: The same for the shadow pass.
        paint: Four numbers that come with each instance; what they mean is the shader's to say.
    """

    material: Material
    shader: ShaderProgram
    shadow_shader: ShaderProgram
    block: moderngl.Buffer
    texture: moderngl.Texture | PictureArray | None
    state: Hashable
    shadow_state: Hashable
    paint: tuple[float, float, float, float] = (1.0, 1.0, 1.0, 1.0)

    @property
    def transparent(self) -> bool:
        """True when it is blended and has to be sorted."""
        return self.material.technique == "glass" or self.material.alpha_mode == "blend"

    @property
    def solid(self) -> bool:
        """True when nothing can be seen through it: no blending, no holes."""
        return self.material.technique != "glass" and self.material.alpha_mode == "opaque"

    def bind(self) -> None:
        """Make it what the shaders read."""
        self.block.bind_to_uniform_block(_BLOCK_BINDING)
        if self.texture is not None:
            self.texture.use(_TEXTURE_BINDING)


class MaterialStore:
    """Looks by material, made on demand and anew when the world's material or texture object is another."""

    def __init__(self, ctx: moderngl.Context, shaders: ShaderLibrary) -> None:
        self._ctx = ctx
        self._shaders = shaders
        self._looks: dict[tuple[str, bool], Look] = {}
        self._known: dict[str, tuple[Material, TextureData | None]] = {}
        self._textures: dict[str, tuple[TextureData, moderngl.Texture]] = {}
        self._arrays = PictureArrays(ctx)
        self._variant: tuple[bool, Shading] = (False, "full")

    def update(self, world: World, *, placed_lights: bool, shading: Shading = "full") -> bool:
        """Bring the looks up to the world's materials.

        Args:
            world: Whose materials.
            placed_lights: True when a point or spot light shines; without one the shaders leave them out.
            shading: Which techniques may be used.

        Returns:
            True when one came, went or changed.
        """
        known = {name: (material, _picture(material, world)) for name, material in world.materials.items()}
        if known == self._known and (placed_lights, shading) == self._variant:
            return False  # what is the very same object is equal at once
        if (placed_lights, shading) != self._variant:
            self._variant = (placed_lights, shading)
            stale = {name for name, _ in self._looks} | {""}
        else:
            stale = {name for name, was in self._known.items() if not _same(was, known.get(name))}
        changed = bool(stale) or known.keys() != self._known.keys()
        for key in [key for key in self._looks if key[0] in stale]:
            self._looks.pop(key).block.release()
        self._known = known
        return changed

    def look(self, name: str, *, coloured: bool = False) -> Look:
        """The look of a material; plain grey for a name the world does not have.

        Args:
            name: Of the material.
            coloured: True for a mesh whose vertices have colours.
        """
        if name not in self._known:
            name = ""
        if (name, coloured) not in self._looks:
            self._looks[name, coloured] = self._make(name, *self._known.get(name, (_FALLBACK, None)), coloured)
        return self._looks[name, coloured]

    def release(self) -> None:
        """Free all buffers and textures."""
        for look in self._looks.values():
            look.block.release()
        for _, texture in self._textures.values():
            texture.release()
        self._arrays.release()
        self._looks.clear()
        self._textures.clear()

    def _make(self, name: str, material: Material, picture: TextureData | None, coloured: bool) -> Look:
        block = self._ctx.buffer(_pack(material, picture).tobytes())
        shadow_shader = self._shadow_shader(material, picture is not None)
        # Depth of what has no holes looks the same whatever its material.
        solid = material.alpha_mode == "opaque" and material.technique != "glass"
        shadow_state = "solid" if solid else (name, coloured)
        if _can_be_plain(material) and self._variant[1] == "plain":
            return self._make_plain(material, picture, coloured, block, shadow_shader)
        texture = self._upload(material.base_texture or "", picture) if picture is not None else None
        shader = self._shader(material, texture is not None, coloured)
        return Look(material, shader, shadow_shader, block, texture, (name, coloured), shadow_state)

    def _make_plain(
        self,
        material: Material,
        picture: TextureData | None,
        coloured: bool,
        block: moderngl.Buffer,
        shadow_shader: ShaderProgram,
    ) -> Look:
        """A look whose state it shares with all others of its kind."""
        layer, array = 0, None
        defines = ["COLOURED"] if coloured else []
        if picture is not None:
            array, layer = self._arrays.place(material.base_texture or "", picture)
            sides = zip(picture.wrap, ("MIRROR_U", "MIRROR_V"), strict=True)
            defines += ["TEXTURED", *(define for wrap, define in sides if wrap == "mirror")]
        shader = self._shaders.program("plain/plain.vert", "plain/plain.frag", tuple(defines))
        state = (shader.defines, id(array), material.double_sided)
        red, green, blue = encode_srgb(np.array(material.base_colour[:3])).tolist()
        number = layer + 1.0 if material.technique == "lit" else -(layer + 1.0)
        return Look(material, shader, shadow_shader, block, array, state, "solid", (red, green, blue, number))

    def _shader(self, material: Material, textured: bool, coloured: bool) -> ShaderProgram:
        defines = ["COLOURED"] if coloured else []
        if textured:
            defines.append("TEXTURED")
        if material.alpha_mode == "mask" and material.technique != "glass":
            defines.append("MASKED")
        if material.technique == "lit" and self._variant[0]:
            defines.append("PLACED_LIGHTS")
        if material.technique == "lit" and material.roughness >= _MATT and material.metallic == 0.0:
            defines.append("MATT")
        if material.grid > 0.0 and material.technique != "unlit":
            defines.append("GRID")
        return self._shaders.program(
            "common/mesh.vert", f"{material.technique}/{material.technique}.frag", tuple(defines)
        )

    def _shadow_shader(self, material: Material, textured: bool) -> ShaderProgram:
        defines = []
        if textured and material.alpha_mode == "mask":
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


def _picture(material: Material, world: World) -> TextureData | None:
    return world.textures.get(material.base_texture) if material.base_texture else None


def _same(was: tuple[Material, TextureData | None], now: tuple[Material, TextureData | None] | None) -> bool:
    return now is not None and was[0] is now[0] and was[1] is now[1]


def _can_be_plain(material: Material) -> bool:
    """True for an opaque surface that the plain technique shows whole: no holes, lines or light of its own."""
    opaque = material.alpha_mode == "opaque" and material.technique in ("lit", "unlit")
    return opaque and material.grid == 0.0 and not any(material.emission)


def _pack(material: Material, picture: TextureData | None) -> np.ndarray[tuple[()], np.dtype[np.void]]:
    block = np.zeros((), _BLOCK)
    block["base_colour"] = material.base_colour
    block["emission"] = (*material.emission, material.alpha_cutoff if material.alpha_mode == "mask" else -1.0)
    block["finish"] = (material.metallic, material.roughness, material.grid, float(material.double_sided))
    wrap = picture.wrap if picture is not None else ("repeat", "repeat")
    block["uv_scale"] = (*(0.5 if side == "mirror" else 1.0 for side in wrap), 0.0, 0.0)
    return block


def _make_texture(ctx: moderngl.Context, picture: TextureData) -> moderngl.Texture:
    pixels = unfolded(picture)
    height, width = pixels.shape[:2]
    texture = ctx.texture((width, height), 4, pixels.tobytes(), internal_format=_SRGB8_ALPHA8 if picture.srgb else None)
    set_sampling(texture, picture)
    return texture
