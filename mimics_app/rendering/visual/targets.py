"""Where a frame is drawn before it reaches the surface: the multisampled picture and the sun's depth map."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.rendering.visual.surface import Size, Surface

if TYPE_CHECKING:
    import moderngl

__all__ = ["PictureTarget", "ShadowTarget"]


class PictureTarget:
    """The multisampled twin of a surface's framebuffer; the framebuffer itself where one sample is enough.

    Attributes:
        samples: Samples per pixel in use; what was asked for, or the most the driver has.
    """

    def __init__(self, surface: Surface, samples: int) -> None:
        self._surface = surface
        self.samples = min(samples, surface.ctx.max_samples)
        self._size: Size | None = None
        self._multisampled: moderngl.Framebuffer | None = None
        # The same buffers without depth: copying resolves every attachment both sides have, and depth is not wanted.
        self._colours: tuple[moderngl.Framebuffer, moderngl.Framebuffer] | None = None

    def begin(self) -> moderngl.Framebuffer:
        """The framebuffer to draw into, of the surface's present size."""
        if self.samples == 0:
            return self._surface.framebuffer
        if self._multisampled is None or self._size != self._surface.size:
            self.release()
            self._size = self._surface.size
            ctx = self._surface.ctx
            colour = ctx.renderbuffer(self._size, 4, samples=self.samples)
            depth = ctx.depth_renderbuffer(self._size, samples=self.samples)
            self._multisampled = ctx.framebuffer([colour], depth)
            shown = self._surface.framebuffer.color_attachments[0]
            self._colours = (ctx.framebuffer([shown]), ctx.framebuffer([colour]))
        return self._multisampled

    def end(self) -> None:
        """Bring the picture to the surface's framebuffer, each pixel the mean of its samples."""
        if self._colours is not None:
            self._surface.ctx.copy_framebuffer(*self._colours)
        self._surface.framebuffer.use()

    def release(self) -> None:
        """Free the multisampled buffers."""
        if self._multisampled is None or self._colours is None:
            return
        for framebuffer in self._colours:
            framebuffer.release()
        attachments = [*self._multisampled.color_attachments, self._multisampled.depth_attachment]
        self._multisampled.release()
        for attachment in attachments:
            if attachment is not None:
                attachment.release()
        self._multisampled = self._colours = None


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
        """Draw into it from here on, onto an empty map."""
        self._framebuffer.use()
        self._framebuffer.clear(depth=1.0)

    def bind(self) -> None:
        """Make it the map the shaders read."""
        self._texture.use(self._BINDING)

    def release(self) -> None:
        """Free the texture."""
        self._framebuffer.release()
        self._texture.release()
