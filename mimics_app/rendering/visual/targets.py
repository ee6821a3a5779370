"""Where a frame is drawn before it reaches the surface: the picture, and the atlas of shadow maps."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.rendering.visual.passes.enlarge import EnlargePass
from mimics_app.rendering.visual.surface import Size, Surface
from mimics_app.rendering.visual.view import Rect

if TYPE_CHECKING:
    import moderngl

__all__ = ["PictureTarget", "ShadowTarget"]


class PictureTarget:
    """Where the world is drawn: the surface's framebuffer itself, its multisampled twin, or a smaller one.

    Attributes:
        samples: Samples per pixel in use; what was asked for, or the most the driver has.
        scale: Width and height of the picture drawn over those of the surface, in (0, 1].
    """

    def __init__(self, surface: Surface, samples: int, scale: float, enlarge: EnlargePass) -> None:
        self._surface = surface
        self._enlarge = enlarge
        self.samples = min(samples, surface.ctx.max_samples)
        self.scale = scale
        self._made_for: tuple[Size, float] | None = None
        self._multisampled: moderngl.Framebuffer | None = None
        self._small: moderngl.Framebuffer | None = None
        # The same buffers without depth: copying resolves every attachment both sides have, and depth is not wanted.
        self._colours: tuple[moderngl.Framebuffer, moderngl.Framebuffer] | None = None

    @property
    def size(self) -> Size:
        """Of the picture drawn [px]."""
        width, height = self._surface.size
        return max(1, round(width * self.scale)), max(1, round(height * self.scale))

    def rectangle(self, of_surface: Rect) -> Rect:
        """Where a rectangle of the surface lies in the picture drawn [px]; neighbours stay neighbours."""
        x, y, width, height = of_surface
        (wide, high), (full_wide, full_high) = self.size, self._surface.size
        left, right = round(x * wide / full_wide), round((x + width) * wide / full_wide)
        bottom, top = round(y * high / full_high), round((y + height) * high / full_high)
        return left, bottom, max(1, right - left), max(1, top - bottom)

    def begin(self) -> moderngl.Framebuffer:
        """The framebuffer to draw into, for the surface's present size and the present scale."""
        if self._made_for != (self._surface.size, self.scale):
            self._surface.framebuffer.use()
            self.release()
            self._make()
            self._made_for = (self._surface.size, self.scale)
        return self._multisampled or self._small or self._surface.framebuffer

    def end(self) -> None:
        """Bring the picture to the surface's framebuffer: each pixel the mean of its samples, enlarged if need be."""
        if self._colours is not None:
            self._surface.ctx.copy_framebuffer(*self._colours)
        self._surface.framebuffer.use()
        if self._small is not None:
            self._surface.framebuffer.viewport = (0, 0, *self._surface.size)
            self._enlarge.draw(self._small.color_attachments[0])  # type: ignore[arg-type]  # made with a texture

    def release(self) -> None:
        """Free the buffers."""
        for framebuffer in self._colours or ():
            framebuffer.release()
        for own in (self._multisampled, self._small):
            if own is None:
                continue
            attachments = [*own.color_attachments, own.depth_attachment]
            own.release()
            for attachment in attachments:
                if attachment is not None:
                    attachment.release()
        self._multisampled = self._small = self._colours = self._made_for = None

    def _make(self) -> None:
        ctx, size = self._surface.ctx, self.size
        if self.scale < 1.0:
            picture = ctx.texture(size, 4)
            picture.repeat_x = picture.repeat_y = False
            self._small = ctx.framebuffer([picture], None if self.samples else ctx.depth_renderbuffer(size))
        if self.samples:
            colour = ctx.renderbuffer(size, 4, samples=self.samples)
            self._multisampled = ctx.framebuffer([colour], ctx.depth_renderbuffer(size, samples=self.samples))
            shown = (self._small or self._surface.framebuffer).color_attachments[0]
            self._colours = (ctx.framebuffer([shown]), ctx.framebuffer([colour]))


class ShadowTarget:
    """A square depth texture that compares when it is read.

    Attributes:
        size: Texels along a side.
    """

    _BINDING = 1

    def __init__(self, ctx: moderngl.Context, size: int) -> None:
        import moderngl

        self.size = size
        self._texture = ctx.depth_texture((max(size, 1),) * 2)
        self._texture.compare_func = "<="
        self._texture.filter = (moderngl.LINEAR, moderngl.LINEAR)
        self._texture.repeat_x = self._texture.repeat_y = False
        self._framebuffer = ctx.framebuffer(depth_attachment=self._texture)

    def begin(self) -> None:
        """Draw into it from here on."""
        self._framebuffer.use()

    def enter(self, tile: tuple[int, int], grid: int) -> None:
        """Empty one of grid x grid tiles, and draw into it from here on."""
        width = self.size // grid
        rectangle = (tile[0] * width, tile[1] * width, width, width)
        self._framebuffer.viewport = rectangle
        self._framebuffer.clear(depth=1.0, viewport=rectangle)

    def bind(self) -> None:
        """Make it the map the shaders read."""
        self._texture.use(self._BINDING)

    def release(self) -> None:
        """Free the texture."""
        self._framebuffer.release()
        self._texture.release()
