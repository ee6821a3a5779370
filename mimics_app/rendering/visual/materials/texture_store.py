"""Textures by name, uploaded again when a name gets another image."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.rendering.visual.materials.picture_arrays import set_sampling, shrunk, unfolded
from mimics_app.rendering.visual.materials.shader_library import ShaderLibrary
from mimics_app.rendering.visual.materials.texture_levels import TextureLevels
from mimics_app.rendering.visual.surfaces.raw_gl import SRGB8_ALPHA8
from mimics_app.world.content.materials.material import TextureData

if TYPE_CHECKING:
    import moderngl

__all__ = ["TextureStore"]


class TextureStore:
    """Textures, each with the image it was made of.

    Args:
        ctx: Context that owns them.
        shaders: Shader library, for the levels.
        max_size: Maximum texture size of the driver [texels]; larger images are halved until they fit.
    """

    def __init__(self, ctx: moderngl.Context, shaders: ShaderLibrary, max_size: int) -> None:
        self._ctx = ctx
        self._levels = TextureLevels(ctx, shaders)
        self._max_size = max_size
        self._known: dict[tuple[str, bool], tuple[TextureData, moderngl.Texture]] = {}

    def get(self, name: str, picture: TextureData, *, linear: bool = False) -> moderngl.Texture:
        """Return the texture of an image.

        Args:
            name: Name of the texture.
            picture: Its present image.
            linear: True where texels are numbers, not colours, even if the image is marked as sRGB.
        """
        known = self._known.get((name, linear))
        if known and known[0] is picture:
            return known[1]
        if known:
            known[1].release()
        texture = self._make(picture, srgb=picture.srgb and not linear)
        self._known[name, linear] = (picture, texture)
        return texture

    def fits(self, picture: TextureData) -> bool:
        """Whether an image is uploaded without being shrunk."""
        return max(picture.pixels.shape[:2]) <= self._max_size

    def release(self) -> None:
        """Free all textures."""
        for _, texture in self._known.values():
            texture.release()
        self._known.clear()
        self._levels.release()

    def _make(self, picture: TextureData, *, srgb: bool) -> moderngl.Texture:
        pixels = shrunk(unfolded(picture), self._max_size)
        height, width = pixels.shape[:2]
        inner = SRGB8_ALPHA8 if srgb else None
        texture = self._ctx.texture((width, height), 4, pixels.tobytes(), internal_format=inner)
        set_sampling(texture, picture, self._levels, srgb=srgb)
        return texture
