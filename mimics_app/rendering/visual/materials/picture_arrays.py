"""Texture arrays of images of one size: surfaces that differ only in their texture share a draw call."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mimics_app.contracts.arrays import F8, U1
from mimics_app.rendering.visual.materials.shader_library import ShaderLibrary
from mimics_app.rendering.visual.materials.texture_levels import TextureLevels
from mimics_app.world.content.materials.material import TextureData

if TYPE_CHECKING:
    import moderngl

__all__ = ["PictureArray", "PictureArrays", "encode_srgb", "halved", "set_sampling", "shrunk", "unfolded"]

_Kind = tuple[tuple[int, ...], tuple[str, str], str, bool]


class PictureArray:
    """Texture array of images of equal size and sampling, one layer each; uploaded on first use after a change."""

    def __init__(self, ctx: moderngl.Context, max_size: int, levels: TextureLevels) -> None:
        self._ctx = ctx
        self._max_size = max_size
        self._levels = levels
        self._layers: list[tuple[str, TextureData]] = []
        self._texture: moderngl.TextureArray | None = None

    def place(self, name: str, picture: TextureData) -> int:
        """Return the layer of an image; an image of a known name replaces the one in its layer."""
        for layer, (known, data) in enumerate(self._layers):
            if known == name:
                if data is not picture:
                    self._layers[layer] = (name, picture)
                    self.release()
                return layer
        self._layers.append((name, picture))
        self.release()
        return len(self._layers) - 1

    def use(self, binding: int) -> None:
        """Bind it to a sampler."""
        if self._texture is None:
            self._texture = self._upload()
        self._texture.use(binding)

    def release(self) -> None:
        """Free the texture; the next use uploads it again."""
        if self._texture is not None:
            self._texture.release()
            self._texture = None

    def _upload(self) -> moderngl.TextureArray:
        pixels = np.stack([shrunk(_display_values(picture), self._max_size) for _, picture in self._layers])
        layers, height, width = pixels.shape[:3]
        texture = self._ctx.texture_array((width, height, layers), 4, pixels.tobytes())
        set_sampling(texture, self._layers[0][1], self._levels)
        return texture


class PictureArrays:
    """Texture arrays by size and sampling; texels are display values that the sampler does not decode.

    Args:
        ctx: Context that owns them.
        shaders: Shader library, for the levels.
        max_size: Maximum texture size of the driver [texels]; larger images are halved until they fit.
    """

    def __init__(self, ctx: moderngl.Context, shaders: ShaderLibrary, max_size: int) -> None:
        self._ctx = ctx
        self._max_size = max_size
        self._levels = TextureLevels(ctx, shaders)
        self._arrays: dict[_Kind, PictureArray] = {}

    def place(self, name: str, picture: TextureData) -> tuple[PictureArray, int]:
        """Return the array and the layer of an image."""
        kind = (picture.pixels.shape, picture.wrap, picture.filter, picture.srgb)
        array = self._arrays.setdefault(kind, PictureArray(self._ctx, self._max_size, self._levels))
        return array, array.place(name, picture)

    def release(self) -> None:
        """Free all textures."""
        for array in self._arrays.values():
            array.release()
        self._arrays.clear()
        self._levels.release()


def encode_srgb(linear: F8) -> F8:
    """Return the display values of linear light, both in [0, 1] (IEC 61966-2-1)."""
    clamped = np.clip(linear, 0.0, 1.0)
    return np.asarray(np.where(clamped < 0.0031308, 12.92 * clamped, 1.055 * clamped ** (1.0 / 2.4) - 0.055))


def unfolded(picture: TextureData) -> U1:
    """Return an image as it is uploaded, [height, width, 4].

    moderngl has no mirrored repeat: such an image is stored beside its reflection and read at half the rate.
    """
    pixels = np.ascontiguousarray(picture.pixels, np.uint8)
    for side, axis in zip(picture.wrap, (1, 0), strict=True):
        if side == "mirror":
            pixels = np.concatenate([pixels, np.flip(pixels, axis)], axis)
    return pixels


def set_sampling(
    texture: moderngl.Texture | moderngl.TextureArray,
    picture: TextureData,
    levels: TextureLevels,
    *,
    srgb: bool = False,
) -> None:
    """Set wrap and filter of a texture as its image requests, with levels where it needs them.

    Args:
        texture: The texture, filled.
        picture: The image.
        levels: Makes the levels.
        srgb: True where the sampler decodes the texels.
    """
    import moderngl

    if picture.filter == "trilinear":
        levels.make(texture, srgb=srgb)
    texture.repeat_x, texture.repeat_y = (side != "clamp" for side in picture.wrap)
    if picture.filter == "trilinear":
        texture.filter = (moderngl.LINEAR_MIPMAP_LINEAR, moderngl.LINEAR)
    else:
        texture.filter = (moderngl.NEAREST,) * 2 if picture.filter == "nearest" else (moderngl.LINEAR,) * 2


def shrunk(pixels: U1, max_size: int) -> U1:
    """Halve an image until its longer side is at most `max_size`, uint8 [height, width, 4]."""
    while max(pixels.shape[:2]) > max_size:
        pixels = halved(pixels)
    return pixels


def halved(pixels: U1) -> U1:
    """Return an image of half the size, uint8 [ceil(h/2), ceil(w/2), 4]: means of 2 x 2 texels."""
    height, width = pixels.shape[:2]
    even = np.pad(pixels, ((0, height % 2), (0, width % 2), (0, 0)), mode="edge")
    blocks = even.reshape(even.shape[0] // 2, 2, even.shape[1] // 2, 2, 4)
    return np.asarray(np.round(blocks.mean(axis=(1, 3), dtype=np.float32)), np.uint8)


def _display_values(picture: TextureData) -> U1:
    pixels = unfolded(picture)
    if picture.srgb:
        return pixels
    encoded = np.round(255.0 * encode_srgb(pixels[..., :3] / 255.0)).astype(np.uint8)
    return np.concatenate([encoded, pixels[..., 3:]], axis=-1)
