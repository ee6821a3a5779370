"""The developer's overlay, drawn over the world and over the heads-up display."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from mimics_app.contracts.clock import Clock
from mimics_app.rendering.visual.drawing.draw_list import DrawList
from mimics_app.rendering.visual.drawing.frame_buffers import FrameBuffers
from mimics_app.rendering.visual.figures.hud import Colour, Hud
from mimics_app.rendering.visual.materials.shader_library import ShaderLibrary
from mimics_app.rendering.visual.overlay.figures import add_bounds, add_lights, add_node_bounds
from mimics_app.rendering.visual.overlay.frame_graph import draw_frame_graph
from mimics_app.rendering.visual.overlay.layers import LAYERS, Arrow, Layer
from mimics_app.rendering.visual.overlay.line_set import LineSet
from mimics_app.rendering.visual.overlay.stage_times import StageTimes
from mimics_app.rendering.visual.stages.shadow_stage import ShadowStage
from mimics_app.rendering.visual.stages.world_stage import FrameScene, ViewDraws, WorldStage
from mimics_app.rendering.visual.surfaces.rasteriser import rasteriser_of

if TYPE_CHECKING:
    import moderngl
from typing import TYPE_CHECKING

import numpy as np

from mimics_app.rendering.visual.figures.palette import INK
from mimics_app.rendering.visual.materials.shader_library import ShaderProgram
from mimics_app.rendering.visual.materials.vertex_arrays import VertexArrays, bare_arrays
from mimics_app.rendering.visual.overlay.line_set import LINE_ROW
from mimics_app.rendering.visual.shadows.shadow_maps import ShadowPlan
from mimics_app.rendering.visual.view import Rect, View

__all__ = ["Overlay"]

_WORDS: dict[Layer, str] = {
    "graph": "frame graph",
    "wires": "wireframe",
    "bounds": "bounds (orange: hidden by others)",
    "lights": "lights",
    "forces": "forces and contacts",
    "atlas": "shadow atlas",
}
_NO_MAPS = "shadow atlas: no map of shadows is drawn"
_PANEL: Colour = (0.05, 0.06, 0.08, 0.66)


_BINDING = 4
_SHARE = 0.36
"""Height of the inset over that of the picture."""
_MAX_TILES = 16


_FAINT = 0.22


class _AtlasPass:
    """Shows the depths as a shaded relief, in the lower right corner."""

    def __init__(self, ctx: moderngl.Context, shaders: ShaderLibrary) -> None:
        self._ctx = ctx
        self._shader = shaders.program("overlay/depth.vert", "overlay/depth.frag")
        self._arrays = bare_arrays(ctx)

    def draw(self, framebuffer: moderngl.Framebuffer, shadows: ShadowStage) -> int:
        """Draw the inset over a framebuffer; return the draw calls, 0 without shadow maps."""
        import moderngl

        if not shadows.plan.maps:
            return 0
        width, height = framebuffer.size
        side = 2.0 * _SHARE
        across = side * height / width
        self._shader.set_numbers("rectangle", (1.0 - across - 0.03, -0.95, across, side))
        self._shader.set_number("tiles", float(shadows.plan.grid))
        self._shader.set_numbers("relief", _relief(shadows.plan))
        self._ctx.viewport = (0, 0, width, height)
        self._ctx.enable_only(moderngl.BLEND)
        self._ctx.blend_func = moderngl.SRC_ALPHA, moderngl.ONE_MINUS_SRC_ALPHA
        shadows.bind(_BINDING)
        self._arrays.of(self._shader).render(moderngl.TRIANGLE_STRIP, vertices=4)
        return 1

    def release(self) -> None:
        """Free the vertex array."""
        self._arrays.release()


def _relief(plan: ShadowPlan) -> list[float]:
    """Return depth range over texel width of each tile; approximate for spot lights, whose depth is not linear."""
    ratios = [1.0] * _MAX_TILES
    for shadow in plan.maps:
        column, row = shadow.tile
        along = float(np.linalg.norm(shadow.clip_from_world[2, :3]))
        ratios[row * plan.grid + column] = 2.0 / (along * shadow.texel)
    return ratios


class _LinePass:
    """Draws lines of constant width on the screen."""

    def __init__(self, ctx: moderngl.Context, shaders: ShaderLibrary) -> None:
        self._ctx = ctx
        self._shader = shaders.program("overlay/lines.vert", "overlay/lines.frag")
        self._buffer: moderngl.Buffer | None = None
        self._arrays = VertexArrays(self._vertex_array)

    def draw(self, target: moderngl.Framebuffer, lines: LineSet, view: View, rectangle: Rect) -> int:
        """Draw lines into a view of the framebuffer in use; return the draw calls."""
        import moderngl

        rows = lines.rows(view.eye_world)
        if not len(rows):
            return 0
        self._upload(rows.tobytes())
        ctx, shader, array = self._ctx, self._shader, self._arrays.of(self._shader)
        target.viewport = rectangle
        shader.set_matrix("clip_from_eye", view.clip_from_eye)
        shader.set_numbers("size_px", rectangle[2:])
        target.depth_mask = False
        ctx.blend_func = moderngl.SRC_ALPHA, moderngl.ONE_MINUS_SRC_ALPHA
        for flags, strength in ((moderngl.BLEND, _FAINT), (moderngl.BLEND | moderngl.DEPTH_TEST, 1.0)):
            ctx.enable_only(flags)
            ctx.depth_func = "<="
            shader.set_number("strength", strength)
            array.render(moderngl.TRIANGLE_STRIP, vertices=4, instances=len(rows))
        ctx.depth_func = "<"
        target.depth_mask = True
        return 2

    def release(self) -> None:
        """Free buffer and vertex array."""
        self._arrays.release()
        if self._buffer is not None:
            self._buffer.release()
            self._buffer = None

    def _upload(self, data: bytes) -> None:
        if self._buffer is None or self._buffer.size < len(data):
            self.release()
            self._buffer = self._ctx.buffer(reserve=max(2 * len(data), 256 * LINE_ROW.itemsize))
        self._buffer.orphan()
        self._buffer.write(data)

    def _vertex_array(self, shader: ShaderProgram) -> moderngl.VertexArray:
        content = [(self._buffer, "3f 3f 4f 2f /i", "begin", "end", "tint", "widths")]
        return self._ctx.vertex_array(shader.program, content)


class Overlay:
    """The overlay.

    Attributes:
        layers: Layers that are on.
        arrows: Forces and contacts of this frame; set by the caller.
        chosen: Entity index of a selected node whose box is drawn; None: none.
        handles: Arrows drawn with it.
        times: Stage times, recorded while the graph is shown.
        note: Text below the graph.
        hud: Canvas of its panels.
    """

    def __init__(self, ctx: moderngl.Context, shaders: ShaderLibrary, frame: FrameBuffers, clock: Clock) -> None:
        self.layers: set[Layer] = set()
        self.arrows: list[Arrow] = []
        self.chosen: int | None = None
        self.handles: list[Arrow] = []
        self.times = StageTimes(ctx, clock, defers=rasteriser_of(ctx).defers)
        self.hud = Hud()
        self.note = ""
        self._lines = LineSet()
        self._line_pass = _LinePass(ctx, shaders)
        self._wires = _WirePass(ctx, shaders, frame)
        self._atlas = _AtlasPass(ctx, shaders)
        self._maps_shown = False

    @property
    def shows(self) -> bool:
        """Whether any of it is visible."""
        return bool(self.layers) or self.chosen is not None

    @property
    def needs_fates(self) -> bool:
        """Whether the draw list has to record the fate of each item."""
        return "bounds" in self.layers

    def toggle(self, layer: Layer) -> None:
        """Switch a layer on or off."""
        self.layers ^= {layer}

    def take_over(self, other: Overlay) -> None:
        """Take over the state of another overlay."""
        self.layers, self.arrows = other.layers, other.arrows
        self.chosen, self.handles = other.chosen, other.handles

    def draw_in_world(
        self,
        target: moderngl.Framebuffer,
        scene: FrameScene,
        listed: DrawList,
        views: Sequence[ViewDraws],
        world: WorldStage,
    ) -> int:
        """Draw all lines, then the wireframe, in every view of the world's target; return the draw calls."""
        draws = 0
        for drawn in views:
            self._collect(scene, listed, drawn)
            draws += self._line_pass.draw(target, self._lines, drawn.view, drawn.rectangle)
        for drawn in views if "wires" in self.layers else ():
            world.enter(scene, drawn)
            draws += self._wires.draw(target, drawn)
        return draws

    def lay_out(self, width: float, height: float) -> None:
        """Lay out the panels on a canvas of a width and height [hud px]."""
        hud = self.hud
        hud.width, hud.height = width, height
        hud.clear()
        if "graph" in self.layers:
            draw_frame_graph(hud, self.times.frames, self.note)
        on = [_WORDS[layer] for layer in LAYERS if layer in self.layers]
        if "atlas" in self.layers and not self._maps_shown:
            on[-1] = _NO_MAPS
        if on:
            text = ", ".join(on)
            wide = hud.measure(text, 14.0) + 24.0
            hud.box(18.0, hud.height - 128.0, wide, 26.0, _PANEL, radius=9.0)
            hud.text(30.0, hud.height - 120.0, text, 14.0, INK)

    def draw_atlas(self, framebuffer: moderngl.Framebuffer, shadows: ShadowStage) -> int:
        """Draw the shadow atlas in a corner of the surface, before `lay_out`; return the draw calls."""
        draws = self._atlas.draw(framebuffer, shadows) if "atlas" in self.layers else 0
        self._maps_shown = draws > 0
        return draws

    def release(self) -> None:
        """Free everything; the vertex arrays of the wireframe belong to the arena."""
        self._line_pass.release()
        self._atlas.release()

    def _collect(self, scene: FrameScene, listed: DrawList, drawn: ViewDraws) -> None:
        lines = self._lines
        lines.clear()
        if "bounds" in self.layers:
            add_bounds(lines, listed, scene.world.transforms.world, drawn.view)
        if "lights" in self.layers:
            add_lights(lines, scene.world, drawn.view)
        if "forces" in self.layers:
            for arrow in self.arrows:
                lines.arrow(arrow.origin, arrow.vector, arrow.tint)
        if self.chosen is not None:
            add_node_bounds(lines, scene.world, listed, self.chosen)
            for arrow in self.handles:
                lines.arrow(arrow.origin, arrow.vector, arrow.tint)


class _WirePass:
    """Draws the runs of a frame again as wireframe, with a depth bias towards the camera."""

    def __init__(self, ctx: moderngl.Context, shaders: ShaderLibrary, frame: FrameBuffers) -> None:
        self._ctx, self._frame = ctx, frame
        self._shader = shaders.program("common/mesh.vert", "overlay/wire.frag")

    def draw(self, target: moderngl.Framebuffer, drawn: ViewDraws) -> int:
        """Draw a view whose block is bound; return the draw calls."""
        import moderngl

        ctx, runs = self._ctx, (*drawn.opaque, *drawn.blended)
        target.viewport = drawn.rectangle
        target.depth_mask = False
        ctx.enable_only(moderngl.DEPTH_TEST | moderngl.BLEND)
        ctx.blend_func = moderngl.SRC_ALPHA, moderngl.ONE_MINUS_SRC_ALPHA
        ctx.depth_func, ctx.wireframe, ctx.polygon_offset = "<=", True, (-1.0, -1.0)
        for run in runs:
            self._frame.draw(run, self._shader)
        ctx.depth_func, ctx.wireframe, ctx.polygon_offset = "<", False, (0.0, 0.0)
        target.depth_mask = True
        return len(runs)
