"""Pictures on the GPU by name, uploaded again when a name gets another picture."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.rendering.visual.materials.picture_arrays import set_sampling, shrunk, unfolded
from mimics_app.rendering.visual.surfaces.raw_gl import SRGB8_ALPHA8
from mimics_app.world.materials.material import TextureData

if TYPE_CHECKING:
    import moderngl

__all__ = ["TextureStore"]


class TextureStore:
    """Textures, each with the picture it was made of.

    Args:
        ctx: Where they live.
        longest: Longest side the driver takes [texels]; larger pictures are halved until they fit.
    """

    def __init__(self, ctx: moderngl.Context, longest: int) -> None:
        self._ctx = ctx
        self._longest = longest
        self._known: dict[tuple[str, bool], tuple[TextureData, moderngl.Texture]] = {}

    def get(self, name: str, picture: TextureData, *, figures: bool = False) -> moderngl.Texture:
        """The texture of a picture.

        Args:
            name: Of the picture.
            picture: What it shows now.
            figures: True where texels are figures, not colours, whatever the picture says.
        """
        known = self._known.get((name, figures))
        if known and known[0] is picture:
            return known[1]
        if known:
            known[1].release()
        texture = self._make(picture, srgb=picture.srgb and not figures)
        self._known[name, figures] = (picture, texture)
        return texture

    def fits(self, picture: TextureData) -> bool:
        """True when a picture is uploaded as it is."""
        return max(picture.pixels.shape[:2]) <= self._longest

    def release(self) -> None:
        """Free all textures."""
        for _, texture in self._known.values():
            texture.release()
        self._known.clear()

    def _make(self, picture: TextureData, *, srgb: bool) -> moderngl.Texture:
        pixels = shrunk(unfolded(picture), self._longest)
        height, width = pixels.shape[:2]
        inner = SRGB8_ALPHA8 if srgb else None
        texture = self._ctx.texture((width, height), 4, pixels.tobytes(), internal_format=inner)
        set_sampling(texture, picture)
        return texture
