"""Textures that the renderer draws itself, bound where a look would bind one that was uploaded."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from mimics_app.rendering.visual.draw_buffer import DrawBuffer
from mimics_app.rendering.visual.pictures.mirror_views import Reflection
from mimics_app.rendering.visual.surfaces.surface import Size

if TYPE_CHECKING:
    import moderngl

__all__ = ["LivePicture", "MirrorPicture"]

_BLOCK_BINDING = 5
"""Of MirrorBlock in shaders/mirror/mirror.frag."""

_OTHER_BINDING = 25
"""Of the right eye's picture there."""

_STEP = 64
"""Buffers of mirrors grow in such steps [px], because the part of the picture a mirror covers changes all the time."""


class LivePicture:
    """What a camera sees: drawn into one buffer while the one drawn before is shown, so that it may show itself.

    Attributes:
        decoded: True for a surface's picture, of which samplers give light, and which may be far away; False for
            display values.
    """

    def __init__(self, ctx: moderngl.Context, *, decoded: bool = True) -> None:
        self._ctx = ctx
        self.decoded = decoded
        self._shown: DrawBuffer | None = None
        self._spare: DrawBuffer | None = None
        self._empty: moderngl.Texture | None = None

    @property
    def drawn(self) -> bool:
        """True once there is something to show."""
        return self._shown is not None

    @property
    def texture(self) -> moderngl.Texture:
        """What is shown; one dark texel before the first picture."""
        if self._shown is not None:
            return self._shown.texture
        if self._empty is None:
            self._empty = self._ctx.texture((1, 1), 4, bytes((20, 20, 20, 255)))
        return self._empty

    def use(self, binding: int) -> None:
        """Make it what a sampler reads."""
        self.texture.use(binding)

    def begin(self, size: Size, samples: int) -> DrawBuffer:
        """The buffer to draw the next picture into."""
        if self._spare is None or (self._spare.size, self._spare.samples) != (size, samples):
            if self._spare is not None:
                self._spare.release()
            self._spare = DrawBuffer(self._ctx, size, samples, srgb=self.decoded)
        return self._spare

    def finish(self) -> None:
        """Show what was drawn."""
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
"""Number of a view, what was drawn for a mirror in it (None: nothing), and the view's corner in the target [px]."""


class MirrorPicture(LivePicture):
    """What a mirror shows, for each view one; in a view that none was drawn for its shader shows the sky.

    Display values are kept as they are: what is read texel by texel is shown as it was drawn.
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
        """The buffer to draw what the mirror shows in a view into.

        Args:
            view: Number of the view in the frame.
            size: Of the part that is drawn [px]; the buffer may be larger.
            samples: Per pixel.
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
        """Be from here on what is seen in a view, or in two that are drawn together; () in none."""
        block = np.zeros((2, 2, 4), np.float32)
        shown: list[DrawBuffer | None] = [None, None]
        for eye, (view, reflection, corner) in enumerate(seen):
            if reflection is not None:
                shown[eye] = self._of_view.get(view)
                block[:, eye] = _texels_of_pixels(reflection, corner)
        self._shown, self._other = shown
        self._write(block)

    def release(self) -> None:
        """Free textures and block; a surface that still wears it shows the sky."""
        self._shown = self._other = None
        for buffer in self._of_view.values():
            buffer.release()
        self._of_view.clear()
        if self._block is not None:
            self._block.release()
            self._block = None
        super().release()

    def _write(self, block: NDArray[np.float32]) -> moderngl.Buffer:
        if self._block is None:
            self._block = self._ctx.buffer(reserve=block.nbytes)
        self._block.orphan()
        self._block.write(block.tobytes())
        return self._block


def _texels_of_pixels(reflection: Reflection, corner: tuple[int, int]) -> NDArray[np.float32]:
    """Factors and offsets from pixels of the target to texels of what was drawn, and its size; [2, 4]."""
    x, y, width, height = reflection.pixels
    wide, high = reflection.view.rectangle[2:]
    across, along = wide / width, high / height
    # Turned over: the right edge of the mirror is the left one of what was drawn.
    placement = (-across, along, (corner[0] + x + width) * across, -(corner[1] + y) * along)
    return np.array([placement, (wide, high, 0.0, 0.0)], np.float32)
