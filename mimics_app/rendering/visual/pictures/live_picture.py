"""Live pictures: textures that the renderer draws itself, bound in place of uploaded ones."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from mimics_app.contracts.arrays import F4
from mimics_app.rendering.visual.draw_buffer import DrawBuffer
from mimics_app.rendering.visual.pictures.mirror_views import Reflection
from mimics_app.rendering.visual.surfaces.surface import Size

if TYPE_CHECKING:
    import moderngl

__all__ = ["LivePicture", "MirrorPicture"]

_BLOCK_BINDING = 5
"""Binding of MirrorBlock in shaders/mirror/mirror.frag."""

_OTHER_BINDING = 25
"""Binding of the right eye's texture there."""

_STEP = 64
"""Step of the size of mirror buffers [px], since the part of the picture that a mirror covers changes all the time."""


class LivePicture:
    """A camera's picture, double-buffered, so that it may show itself.

    Attributes:
        decoded: True for the texture of a surface: sRGB-decoded and with mipmaps; False for display values.
    """

    def __init__(self, ctx: moderngl.Context, *, decoded: bool = True) -> None:
        self._ctx = ctx
        self.decoded = decoded
        self._shown: DrawBuffer | None = None
        self._spare: DrawBuffer | None = None
        self._empty: moderngl.Texture | None = None

    @property
    def drawn(self) -> bool:
        """True once a picture was drawn."""
        return self._shown is not None

    @property
    def texture(self) -> moderngl.Texture:
        """The latest picture; one dark texel before the first."""
        if self._shown is not None:
            return self._shown.texture
        if self._empty is None:
            self._empty = self._ctx.texture((1, 1), 4, bytes((20, 20, 20, 255)))
        return self._empty

    def use(self, binding: int) -> None:
        """Bind it to a sampler."""
        self.texture.use(binding)

    def begin(self, size: Size, samples: int) -> DrawBuffer:
        """Return the buffer to draw the next picture into."""
        if self._spare is None or (self._spare.size, self._spare.samples) != (size, samples):
            if self._spare is not None:
                self._spare.release()
            self._spare = DrawBuffer(self._ctx, size, samples, srgb=self.decoded)
        return self._spare

    def finish(self) -> None:
        """Resolve and show the buffer drawn last."""
        if self._spare is not None:
            self._spare.finish()
            if self.decoded:
                self._spare.texture.build_mipmaps()
        self._shown, self._spare = self._spare, self._shown

    def release(self) -> None:
        """Free the textures."""
        for part in (self._shown, self._spare, self._empty):
            if part is not None:
                part.release()
        self._shown = self._spare = self._empty = None


SeenIn = tuple[int, Reflection | None, tuple[int, int]]
"""Number of a view, the reflection drawn for a mirror in it (None: none), and the view's corner in the target [px]."""


class MirrorPicture(LivePicture):
    """A mirror's pictures, one per view; its shader shows the sky in a view without one.

    They hold display values, since a mirror shows them texel by texel.
    """

    def __init__(self, ctx: moderngl.Context) -> None:
        super().__init__(ctx, decoded=False)
        self._block: moderngl.Buffer | None = None
        self._of_view: dict[int, DrawBuffer] = {}
        self._other: DrawBuffer | None = None

    def use(self, binding: int) -> None:
        super().use(binding)
        block = self._block or self._write(np.zeros((2, 2, 4), np.float32))
        block.bind_to_uniform_block(_BLOCK_BINDING)
        if self._other is not None:
            self._other.texture.use(_OTHER_BINDING)

    def begin_view(self, view: int, size: Size, samples: int) -> DrawBuffer:
        """Return the buffer to draw the mirror's picture for a view into.

        Args:
            view: Number of the view in the frame.
            size: Size of the picture [px]; the buffer may be larger.
            samples: Samples per pixel.
        """
        old = self._of_view.get(view)
        if (
            old is not None
            and old.samples == samples
            and all(has >= side for has, side in zip(old.size, size, strict=True))
        ):
            return old
        if old is not None:
            old.release()
        width, height = (-(-side // _STEP) * _STEP for side in size)
        self._of_view[view] = DrawBuffer(self._ctx, (width, height), samples)
        return self._of_view[view]

    def show(self, seen: Sequence[SeenIn]) -> None:
        """Select the pictures for a view, or for two that are drawn in one pass; () for none."""
        block = np.zeros((2, 2, 4), np.float32)
        shown: list[DrawBuffer | None] = [None, None]
        for eye, (view, reflection, corner) in enumerate(seen):
            if reflection is not None:
                shown[eye] = self._of_view.get(view)
                block[:, eye] = _texels_of_pixels(reflection, corner)
        self._shown, self._other = shown
        self._write(block)

    def release(self) -> None:
        """Free textures and block; a surface that still uses them shows the sky."""
        self._shown = self._other = None
        for buffer in self._of_view.values():
            buffer.release()
        self._of_view.clear()
        if self._block is not None:
            self._block.release()
            self._block = None
        super().release()

    def _write(self, block: F4) -> moderngl.Buffer:
        if self._block is None:
            self._block = self._ctx.buffer(reserve=block.nbytes)
        self._block.orphan()
        self._block.write(block.tobytes())
        return self._block


def _texels_of_pixels(reflection: Reflection, corner: tuple[int, int]) -> F4:
    """Return factors and offsets from pixels of the target to texels of the reflection, and its size; [2, 4]."""
    x, y, width, height = reflection.pixels
    wide, high = reflection.view.rectangle[2:]
    across, along = wide / width, high / height
    # Flipped: the right edge of the mirror is the left one of the reflection.
    placement = (-across, along, (corner[0] + x + width) * across, -(corner[1] + y) * along)
    return np.array([placement, (wide, high, 0.0, 0.0)], np.float32)
