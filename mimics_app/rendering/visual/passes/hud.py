"""The heads-up display laid over a view, on a plane before the eyes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import F8
from mimics_app.rendering.visual.figures.hud import CANVAS_HEIGHT, HUD_ROW, Hud
from mimics_app.rendering.visual.materials.shader_library import ShaderLibrary
from mimics_app.rendering.visual.view import View

if TYPE_CHECKING:
    import moderngl

__all__ = ["HudPass", "HudPlane", "clip_from_hud", "plane_of_views"]


_GLYPH_BINDING, _IMAGE_BINDING = 2, 3
_NEAREST_FOR_TWO = 1.28
"""Distance [m] at which eyes 63 mm apart turn in one degree more than at 2 m, where screens and headsets focus."""
_AROUND = 1.68
"""Height of a picture, in tangents, beyond 80 degrees: a headset."""
_LOOKED_AT = (0.6, 0.45)
"""Tangents right and up that eyes turn to without the head: some 30 and 24 degrees."""
_ENLARGED = 1.6
"""Figures in a headset over those of a screen: its pixels are coarse, so that the smallest word takes 1.4 degrees."""
_BEYOND = 1.05
"""How far inside the near and the far plane a display stays."""


@dataclass(frozen=True, eq=False)
class HudPlane:
    """Where the display hangs in the world.

    Attributes:
        origin_world: Its lower left corner [m], float64 [3].
        right_world: From there along its lower edge [m], float64 [3].
        up_world: Along its left edge [m], float64 [3].
        canvas_height: Of the canvas on it [hud px].
    """

    origin_world: F8
    right_world: F8
    up_world: F8
    canvas_height: float = CANVAS_HEIGHT

    @property
    def canvas_width(self) -> float:
        """Width of the canvas [hud px] of the plane's shape."""
        return float(self.canvas_height * np.linalg.norm(self.right_world) / np.linalg.norm(self.up_world))


def plane_of_views(views: Sequence[View], depth: float) -> HudPlane:
    """The plane that fills the mean frustum of one screen's eyes at a depth.

    With a single view it fills the picture exactly, off-axis or not; with two eyes it hangs between them, so that
    both see it at the same place in space.

    Args:
        views: The eyes of one screen.
        depth: Distance from the eyes [m]; as near to that as is neither too near nor too far to be seen. Two eyes get
            it no nearer than they comfortably turn in, and of a wide headset only what they see without the head.
    """
    depth = max(depth, _NEAREST_FOR_TWO) if len(views) > 1 else depth
    nearest, farthest = max(view.near for view in views), min(view.far for view in views)
    depth = min(max(depth, _BEYOND * nearest), farthest / _BEYOND)
    seen = np.mean([view.tangents for view in views], axis=0)
    around = len(views) > 1 and bool(seen[3] - seen[2] >= _AROUND)
    left, right, bottom, top = depth * (_readable(seen) if around else seen)
    centre = np.mean([view.eye_world for view in views], axis=0)
    axes = _axes_between(views[0].world_from_eye[:3, :3], views[-1].world_from_eye[:3, :3])
    origin = centre + axes @ np.array([left, bottom, -depth])
    canvas = CANVAS_HEIGHT / _ENLARGED if around else CANVAS_HEIGHT
    return HudPlane(origin, axes[:, 0] * (right - left), axes[:, 1] * (top - bottom), canvas)


def _axes_between(first: F8, last: F8) -> F8:
    """Axes midway between those of two eyes: panels of a headset may each look outwards; float64 [3, 3]."""
    if np.array_equal(first, last):
        return first
    back = first[:, 2] + last[:, 2]
    back = back / np.linalg.norm(back)
    up = np.cross(back, first[:, 0] + last[:, 0])
    up = up / np.linalg.norm(up)
    return np.column_stack([np.cross(up, back), up, back])


def _readable(tangents: F8) -> F8:
    """The part of what surrounds the eyes that figures are laid over: its middle."""
    across, up = _LOOKED_AT
    return np.clip(tangents, [-across, -across, -up, -up], [across, across, up, up])


class HudPass:
    """Draws a `Hud` in one call."""

    def __init__(self, ctx: moderngl.Context, shaders: ShaderLibrary) -> None:
        self._ctx = ctx
        self._shader = shaders.program("hud/hud.vert", "hud/hud.frag")
        self._rows: moderngl.Buffer | None = None
        self._array: moderngl.VertexArray | None = None
        self._made_for = -1
        self._uploaded: tuple[int, int] | None = None
        self._count = 0
        self._glyphs: moderngl.Texture | None = None
        self._images: moderngl.TextureArray | None = None
        self._image_source: NDArray[np.uint8] | None = None

    def draw(self, hud: Hud, view: View, plane: HudPlane) -> int:
        """Lay the display over one view; the framebuffer's viewport is set to the view's rectangle.

        Returns:
            Draw calls made.
        """
        import moderngl

        if hud.empty:
            return 0
        self._upload(hud)
        self._shader.set_matrix("clip_from_hud", clip_from_hud(view, plane))
        self._shader.set_number("glyph_spread", hud.atlas.spread)
        ctx = self._ctx
        ctx.viewport = view.rectangle
        ctx.enable_only(moderngl.BLEND)
        ctx.blend_func = moderngl.SRC_ALPHA, moderngl.ONE_MINUS_SRC_ALPHA
        self._bind(hud)
        self._vertex_array().render(moderngl.TRIANGLE_STRIP, vertices=4, instances=self._count)
        return 1

    def release(self) -> None:
        """Free buffers and textures."""
        for part in (self._array, self._rows, self._glyphs, self._images):
            if part is not None:
                part.release()
        self._array = self._rows = self._glyphs = self._images = None

    def _upload(self, hud: Hud) -> None:
        key = (id(hud), hud.revision)
        if key == self._uploaded and self._rows is not None:
            return
        rows = hud.rows()
        if self._rows is None or self._rows.size < rows.nbytes:
            if self._array is not None:
                self._array.release()
                self._array = None
            if self._rows is not None:
                self._rows.release()
            self._rows = self._ctx.buffer(reserve=max(2 * rows.nbytes, 64 * HUD_ROW.itemsize))
        self._rows.orphan()
        self._rows.write(rows.tobytes())
        self._uploaded, self._count = key, len(rows)

    def _vertex_array(self) -> moderngl.VertexArray:
        if self._array is None or self._made_for != self._shader.revision:
            content = [(self._rows, "4f 4f 4f 4f /i", "box", "picture", "tint", "style")]
            self._array = self._ctx.vertex_array(self._shader.program, content)
            self._made_for = self._shader.revision
        return self._array

    def _bind(self, hud: Hud) -> None:
        if self._glyphs is None:
            pixels = hud.atlas.pixels
            self._glyphs = self._ctx.texture(pixels.shape[::-1], 1, pixels.tobytes())
        if self._images is None or hud.images is not self._image_source:
            self._upload_images(hud.images)
        self._glyphs.use(_GLYPH_BINDING)
        if self._images is not None:
            self._images.use(_IMAGE_BINDING)

    def _upload_images(self, images: NDArray[np.uint8] | None) -> None:
        self._image_source = images
        if self._images is not None:
            self._images.release()
        data = np.zeros((1, 1, 1, 4), np.uint8) if images is None else np.ascontiguousarray(images)
        layers, height, width = data.shape[:3]
        self._images = self._ctx.texture_array((width, height, layers), 4, data.tobytes())
        self._images.repeat_x = self._images.repeat_y = False


def clip_from_hud(view: View, plane: HudPlane) -> F8:
    """Projection of the canvas, x and y in hud px from its lower left corner (float64 [4, 4])."""
    eye_from_hud = np.zeros((4, 4))
    eye_from_hud[:3, 0] = plane.right_world / plane.canvas_width
    eye_from_hud[:3, 1] = plane.up_world / plane.canvas_height
    eye_from_hud[:3, 3] = plane.origin_world - view.eye_world
    eye_from_hud[3, 3] = 1.0
    return np.asarray(view.clip_from_eye @ eye_from_hud)
