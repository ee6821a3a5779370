"""The developer's overlay, drawn over the world and over the heads-up display."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from mimics_app.contracts.clock import Clock
from mimics_app.rendering.visual.drawing.draw_list import DrawList
from mimics_app.rendering.visual.drawing.frame_buffers import FrameBuffers
from mimics_app.rendering.visual.figures.hud import Colour, Hud
from mimics_app.rendering.visual.materials.shader_library import ShaderLibrary
from mimics_app.rendering.visual.overlay.atlas_pass import AtlasPass
from mimics_app.rendering.visual.overlay.figures import add_bounds, add_lights, add_node_bounds
from mimics_app.rendering.visual.overlay.frame_graph import draw_frame_graph
from mimics_app.rendering.visual.overlay.layers import LAYERS, Arrow, Layer
from mimics_app.rendering.visual.overlay.line_pass import LinePass
from mimics_app.rendering.visual.overlay.line_set import LineSet
from mimics_app.rendering.visual.overlay.stage_times import StageTimes
from mimics_app.rendering.visual.stages.shadow_stage import ShadowStage
from mimics_app.rendering.visual.stages.world_stage import FrameScene, ViewDraws, WorldStage
from mimics_app.rendering.visual.surfaces.rasteriser import rasteriser_of

if TYPE_CHECKING:
    import moderngl
from mimics_app.rendering.visual.figures.palette import INK

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
        self._line_pass = LinePass(ctx, shaders)
        self._wires = _WirePass(ctx, shaders, frame)
        self._atlas = AtlasPass(ctx, shaders)
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
