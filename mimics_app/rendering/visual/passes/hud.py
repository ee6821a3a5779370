"""The heads-up display, drawn over a view on a plane in front of the eyes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import F8, U1
from mimics_app.rendering.visual.figures.hud import CANVAS_HEIGHT, HUD_ROW, KIND, Hud, canvas_height
from mimics_app.rendering.visual.materials.shader_library import ShaderLibrary, ShaderProgram
from mimics_app.rendering.visual.materials.vertex_arrays import VertexArrays
from mimics_app.rendering.visual.view import Rect, View

if TYPE_CHECKING:
    import moderngl

__all__ = ["HudPass", "HudPlane", "clip_from_hud", "places_of", "plane_of_views"]


_GLYPH_BINDING, _IMAGE_BINDING = 2, 3
_MIN_STEREO_DEPTH = 1.28
"""Distance at which eyes 63 mm apart converge by one degree more than at 2 m, the focus of screens and headsets [m]."""
_HEADSET_HEIGHT = 1.68
"""Height of the picture from which it is taken for a headset's, 80 degrees [tangents]."""
_EYE_RANGE = (0.6, 0.45)
"""Range of eye movements without the head, right and up, about 30 and 24 degrees [tangents]."""
_ENLARGED = 1.6
"""Factor on the size of the display in a headset, whose pixels are coarse: the smallest word spans 1.4 degrees."""
_BEYOND = 1.05
"""Factor by which the display stays inside the near and the far plane."""


_GLYPH, _IMAGE = 1, 2
_VARIANTS: tuple[tuple[str, ...], ...] = ((), ("GLYPHS",), ("IMAGES",))
"""Shader variants by the kind of a row; all kinds from `_IMAGE` on are images."""
_CORNERS, _COMMAND = 4, 5
"""Vertices of a row, and words from one draw command to the next: moderngl leaves the fifth for indexed ones."""


@dataclass(frozen=True, eq=False)
class HudPlane:
    """Plane of the display in the world.

    Attributes:
        origin_world: Its lower left corner [m], float64 [3].
        right_world: Its lower edge [m], float64 [3].
        up_world: Its left edge [m], float64 [3].
        canvas_height: Height of its canvas [hud px].
    """

    origin_world: F8
    right_world: F8
    up_world: F8
    canvas_height: float = CANVAS_HEIGHT

    @cached_property
    def canvas_width(self) -> float:
        """Width of the canvas, by the plane's aspect ratio [hud px]."""
        return float(self.canvas_height * np.linalg.norm(self.right_world) / np.linalg.norm(self.up_world))


def plane_of_views(views: Sequence[View], depth: float, enlarged: float = 1.0) -> HudPlane:
    """Return the plane that fills the mean frustum of one screen's views at a depth.

    With one view it fills the picture exactly, off-axis or not; with two it is centred between the eyes, which see it
    at the same place in space. In a wide headset it fills only the range of eye movements.

    Args:
        views: The views of one screen.
        depth: Distance from the eyes [m], limited by near and far plane, and for two eyes by comfortable convergence.
        enlarged: Factor on the size of all that is on the display.
    """
    return _plane_of(tuple(views), depth, enlarged)


def places_of(rows: NDArray[np.void], plane: HudPlane) -> F8:
    """Return where HUD_ROW [n] are on the only view of a plane, as shares of it: left, right, bottom, top, [n, 4]."""
    left, bottom, width, height = np.asarray(rows["box"], np.float64).T
    edges = (left / plane.canvas_width, (left + width) / plane.canvas_width)
    return np.column_stack([*edges, bottom / plane.canvas_height, (bottom + height) / plane.canvas_height])


@lru_cache(maxsize=4)
def _plane_of(views: tuple[View, ...], depth: float, enlarged: float) -> HudPlane:
    depth = max(depth, _MIN_STEREO_DEPTH) if len(views) > 1 else depth
    nearest, farthest = max(view.near for view in views), min(view.far for view in views)
    depth = min(max(depth, _BEYOND * nearest), farthest / _BEYOND)
    if len(views) == 1:
        seen, centre, axes = np.array(views[0].tangents), views[0].eye_world, views[0].world_from_eye[:3, :3]
    else:
        seen = np.mean([view.tangents for view in views], axis=0)
        centre = np.mean([view.eye_world for view in views], axis=0)
        axes = _axes_between(views[0].world_from_eye[:3, :3], views[-1].world_from_eye[:3, :3])
    around = len(views) > 1 and bool(seen[3] - seen[2] >= _HEADSET_HEIGHT)
    left, right, bottom, top = depth * (_readable(seen) if around else seen)
    origin = centre + axes @ np.array([left, bottom, -depth])
    aspect = (right - left) / (top - bottom)
    canvas = CANVAS_HEIGHT / (_ENLARGED * enlarged) if around else canvas_height(aspect, enlarged)
    return HudPlane(origin, axes[:, 0] * (right - left), axes[:, 1] * (top - bottom), canvas)


def _axes_between(first: F8, last: F8) -> F8:
    """Return axes midway between those of two eyes, since a headset's panels may be canted; float64 [3, 3]."""
    if np.array_equal(first, last):
        return first
    back = first[:, 2] + last[:, 2]
    back = back / np.linalg.norm(back)
    up = np.cross(back, first[:, 0] + last[:, 0])
    up = up / np.linalg.norm(up)
    return np.column_stack([np.cross(up, back), up, back])


def _readable(tangents: F8) -> F8:
    """Clamp tangents to the range of eye movements."""
    across, up = _EYE_RANGE
    return np.clip(tangents, [-across, -across, -up, -up], [across, across, up, up])


class HudPass:
    """Draws a `Hud`: one call for each run of boxes, glyphs or images."""

    def __init__(self, ctx: moderngl.Context, shaders: ShaderLibrary) -> None:
        self._ctx = ctx
        self._shaders = [shaders.program("hud/hud.vert", "hud/hud.frag", defines) for defines in _VARIANTS]
        self._rows: moderngl.Buffer | None = None
        self._commands: moderngl.Buffer | None = None
        self._arrays = VertexArrays(self._vertex_array)
        self._uploaded: tuple[int, int] | None = None
        self._row_kinds = b""
        self._kinds: list[int] = []
        self._glyphs: moderngl.Texture | None = None
        self._images: moderngl.TextureArray | None = None
        self._image_source: U1 | None = None

    def draw(self, hud: Hud, view: View, plane: HudPlane, within: Sequence[Rect | None] = (None,)) -> int:
        """Draw the display over one view; sets the viewport to the view's rectangle.

        Args:
            hud: The display.
            view: The view.
            plane: Plane of the display.
            within: Disjoint rectangles of the framebuffer in use to draw within [px]; None: all of it.

        Returns:
            Draw calls made.
        """
        import moderngl

        if hud.empty:
            return 0
        self._upload(hud)
        assert self._commands is not None
        projection = clip_from_hud(view, plane)
        for kind in set(self._kinds):
            self._shaders[kind].set_matrix("clip_from_hud", projection)
            if kind == _GLYPH:
                self._shaders[kind].set_number("glyph_spread", hud.atlas.spread)
        ctx = self._ctx
        ctx.viewport = view.rectangle
        ctx.enable_only(moderngl.BLEND)
        ctx.blend_func = moderngl.SRC_ALPHA, moderngl.ONE_MINUS_SRC_ALPHA
        self._bind(hud)
        for rectangle in within:
            ctx.fbo.scissor = rectangle  # type: ignore[assignment]  # None disables it
            for number, kind in enumerate(self._kinds):
                array = self._arrays.of(self._shaders[kind])
                array.render_indirect(self._commands, moderngl.TRIANGLE_STRIP, 1, first=number)
        ctx.fbo.scissor = None  # type: ignore[assignment]
        return len(within) * len(self._kinds)

    def draw_over(self, huds: Sequence[Hud], views: Sequence[View], depth: float, enlarged: float) -> int:
        """Draw displays over all views that are on a screen, at a depth [m] and enlarged; return the draw calls."""
        draws, huds = 0, [hud for hud in huds if not hud.empty]
        for screen in dict.fromkeys(view.screen for view in views if huds and view.screen >= 0):
            eyes = [view for view in views if view.screen == screen]
            plane = plane_of_views(eyes, depth, enlarged)
            draws += sum(self.draw(hud, view, plane) for view in eyes for hud in huds)
        return draws

    def release(self) -> None:
        """Free buffers and textures."""
        self._arrays.release()
        for part in (self._rows, self._commands, self._glyphs, self._images):
            if part is not None:
                part.release()
        self._rows = self._commands = self._glyphs = self._images = None
        self._row_kinds = b""

    def _upload(self, hud: Hud) -> None:
        key = (id(hud), hud.revision)
        if key == self._uploaded and self._rows is not None:
            return
        rows = hud.numbers()
        self._uploaded = key
        if self._rows is None or self._rows.size < rows.nbytes:
            self._arrays.release()
            if self._rows is not None:
                self._rows.release()
            self._rows = self._ctx.buffer(reserve=max(2 * rows.nbytes, 64 * HUD_ROW.itemsize))
        self._rows.orphan()
        self._rows.write(rows)
        kinds = rows[:, KIND]
        if (figures := kinds.tobytes()) != self._row_kinds:
            self._row_kinds = figures
            self._command(np.minimum(kinds, _IMAGE).astype(int))

    def _command(self, kinds: NDArray[np.int_]) -> None:
        """Make the draw commands of rows, given their kinds."""
        starts = np.concatenate([[0], np.flatnonzero(np.diff(kinds)) + 1])
        self._kinds = kinds[starts].tolist()
        commands = np.zeros((len(starts), _COMMAND), np.uint32)
        commands[:, 0], commands[:, 3] = _CORNERS, starts
        commands[:, 1] = np.diff(np.append(starts, len(kinds)))
        if self._commands is not None:
            self._commands.release()
        self._commands = self._ctx.buffer(commands.tobytes())

    def _vertex_array(self, shader: ShaderProgram) -> moderngl.VertexArray:
        return self._ctx.vertex_array(shader.program, [(self._rows, *_fields(shader))])

    def _bind(self, hud: Hud) -> None:
        if self._glyphs is None:
            pixels = hud.atlas.pixels
            self._glyphs = self._ctx.texture(pixels.shape[::-1], 1, pixels.tobytes())
        if self._images is None or hud.images is not self._image_source:
            self._upload_images(hud.images)
        self._glyphs.use(_GLYPH_BINDING)
        if self._images is not None:
            self._images.use(_IMAGE_BINDING)

    def _upload_images(self, images: U1 | None) -> None:
        self._image_source = images
        if self._images is not None:
            self._images.release()
        data = np.zeros((1, 1, 1, 4), np.uint8) if images is None else np.ascontiguousarray(images)
        layers, height, width = data.shape[:3]
        self._images = self._ctx.texture_array((width, height, layers), 4, data.tobytes())
        self._images.repeat_x = self._images.repeat_y = False


def _fields(shader: ShaderProgram) -> tuple[str, ...]:
    """Return layout and names of a row's fields; the bytes of those that a variant does not read are skipped."""
    read = [name for name in HUD_ROW.names or () if name in shader.program]
    layout = ("4f" if name in read else f"{HUD_ROW[name].itemsize}x" for name in HUD_ROW.names or ())
    return f"{' '.join(layout)} /i", *read


@lru_cache(maxsize=4)
def clip_from_hud(view: View, plane: HudPlane) -> F8:
    """Return the projection of canvas coordinates [hud px] from its lower left corner (float64 [4, 4])."""
    eye_from_hud = np.zeros((4, 4))
    eye_from_hud[:3, 0] = plane.right_world / plane.canvas_width
    eye_from_hud[:3, 1] = plane.up_world / plane.canvas_height
    eye_from_hud[:3, 3] = plane.origin_world - view.eye_world
    eye_from_hud[3, 3] = 1.0
    return np.asarray(view.clip_from_eye @ eye_from_hud)
