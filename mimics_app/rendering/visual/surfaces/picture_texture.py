"""Textures for pictures in display values."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.rendering.visual.surfaces.raw_gl import RawGL

if TYPE_CHECKING:
    import moderngl

__all__ = ["make_picture_texture"]


def make_picture_texture(ctx: moderngl.Context, size: tuple[int, int]) -> moderngl.Texture:
    """Return a texture of 8 bits per channel without repetition, to draw into and to read from; not cleared.

    Bytes are stored as blue, green, red, alpha: a software driver (llvmpipe) draws into this order faster, and only
    between two such textures it scales by integer arithmetic (`shaders/post/resample.frag`).

    Args:
        ctx: Context that owns it.
        size: Width and height [px].
    """
    texture = ctx.texture(size, 4)
    RawGL(ctx).store_as_bgra(texture)
    texture.repeat_x = texture.repeat_y = False
    return texture
