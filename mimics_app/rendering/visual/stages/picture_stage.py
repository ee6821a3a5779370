"""Stage of live pictures: visible mirrors, screens and insets, and the drawing of what they show."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from mimics_app.contracts.errors import Issue
from mimics_app.rendering.visual.displays.desktop import desktop_views
from mimics_app.rendering.visual.materials.shader_library import ShaderLibrary
from mimics_app.rendering.visual.materials.vertex_arrays import bare_arrays
from mimics_app.rendering.visual.passes.hud import HudPlane, clip_from_hud, plane_of_views
from mimics_app.rendering.visual.pictures.live_picture import LivePicture, MirrorPicture
from mimics_app.rendering.visual.pictures.mirror_views import Reflection, plane_of_sheet, reflect_view
from mimics_app.rendering.visual.stages.world_stage import FrameScene, ViewDraws, WorldStage
from mimics_app.rendering.visual.surfaces.surface import Size
from mimics_app.rendering.visual.view import Rect, View
from mimics_app.world.components.pictures import Inset, Mirror
from mimics_app.world.content.live_pictures import body_of, live_key
from mimics_app.world.content.world import World

if TYPE_CHECKING:
    import moderngl

__all__ = ["Batch", "PictureJob", "PictureStage"]


_BINDING = 22


def inset_pixels(inset: Inset, view: View) -> Rect:
    """Return the rectangle of an inset relative to its view's corner [px]."""
    left, bottom, width, height = inset.rectangle
    wide, high = view.rectangle[2:]
    return round(left * wide), round(bottom * high), max(1, round(width * wide)), max(1, round(height * high))


class InsetPass:
    """Draws insets; the shader is compiled on first use."""

    def __init__(self, ctx: moderngl.Context, shaders: ShaderLibrary) -> None:
        self._ctx = ctx
        self._shaders = shaders
        self._arrays = bare_arrays(ctx)

    def draw(self, inset: Inset, picture: LivePicture, pixels: Rect, view: View, plane: HudPlane) -> int:
        """Draw an inset over a view; return the draw calls.

        Args:
            inset: The inset.
            picture: Its picture.
            pixels: Its rectangle in the first view of the screen, see `inset_pixels`.
            view: A view of that screen.
            plane: Plane of the screen's heads-up display.
        """
        import moderngl

        shader = self._shaders.program("inset/inset.vert", "inset/inset.frag")
        line = plane.canvas_height / view.rectangle[3]
        shader.set_numbers("box", [side * line for side in pixels])
        shader.set_number("border", inset.border)
        shader.set_number("mirrored", float(inset.mirrored))
        shader.set_matrix("clip_from_hud", clip_from_hud(view, plane))
        self._ctx.viewport = view.rectangle
        self._ctx.enable_only(moderngl.NOTHING)
        picture.use(_BINDING)
        self._arrays.of(shader).render(moderngl.TRIANGLE_STRIP, vertices=4)
        return 1

    def release(self) -> None:
        """Free the vertex array."""
        self._arrays.release()


Batch = Callable[[View, Hashable], ViewDraws]
"""Queues what is visible in a view whose rectangle starts at 0, 0."""


@dataclass(frozen=True, eq=False)
class PictureJob:
    """A picture to draw: its target, the number of the view it belongs to (mirrors), and its draws, or one a part."""

    picture: LivePicture
    number: int
    drawn: list[ViewDraws]


class PictureStage:
    """Draws the pictures of visible mirrors, screens and insets.

    Within a picture, mirrors show the sky, which ends recursion, and a screen in its own picture shows the last one. No
    filter is applied. Shadow maps are those of the frame.

    Attributes:
        pictures: Pictures by the key of the texture they replace.
        issues: Mirrors that are not flat, each reported once; the caller removes what it reports.
        jobs: Pictures to draw in this frame.
        held: Keys of the mirrors whose buffers have the picture of the last frame.
    """

    def __init__(self, ctx: moderngl.Context, shaders: ShaderLibrary) -> None:
        self._ctx = ctx
        self._insets = InsetPass(ctx, shaders)
        self.pictures: dict[str, LivePicture] = {}
        self.issues: list[Issue] = []
        self.jobs: list[PictureJob] = []
        self.held: set[str] = set()
        self._frames = 0
        self._reported: set[str] = set()

    def update(self, world: World) -> None:
        """Begin a frame: create a picture for each mirror, screen and inset of the world, and free all others."""
        self._frames += 1
        wanted: dict[str, Callable[[moderngl.Context], LivePicture]] = {}
        wanted |= dict.fromkeys(map(live_key, world.mirrors), MirrorPicture)
        wanted |= dict.fromkeys(map(live_key, world.screens), LivePicture)
        wanted |= dict.fromkeys(map(_inset_key, world.insets), partial(LivePicture, decoded=False))
        for key in [key for key in self.pictures if key not in wanted]:
            self.pictures.pop(key).release()
            self.held.discard(key)
        for key, make in wanted.items():
            if key not in self.pictures:
                self.pictures[key] = make(self._ctx)

    def queue(self, world: World, drawn: Sequence[ViewDraws], batch: Batch, resolution: float) -> list[ViewDraws]:
        """Choose the pictures of a frame and queue what is visible in them.

        Args:
            world: The world, updated.
            drawn: The views of the frame.
            batch: Queues what is visible in a view.
            resolution: Factor on the resolution of mirrors.

        Returns:
            The views, each with its mirrors.
        """
        self.jobs = []
        if not (world.mirrors or world.screens or world.insets):
            return list(drawn)
        reflected = [self._queue_mirrors(world, number, each, batch, resolution) for number, each in enumerate(drawn)]
        self.queue_cameras(world, drawn[0].view, set().union(*(each.materials for each in drawn)), batch)
        return reflected

    @property
    def triangles(self) -> int:
        """Triangles of all pictures of the frame."""
        return sum(each.triangles for job in self.jobs for each in job.drawn)

    def draw(self, stage: WorldStage, scene: FrameScene, samples: int) -> int:
        """Draw the frame's pictures; return the draw calls."""
        if not self.jobs:
            return 0
        # A screen emits linear light, which is tone mapped in the view that sees the screen.
        scene = replace(scene, settings=replace(scene.settings, ambient_occlusion=0.0))
        emitted = replace(scene, settings=replace(scene.settings, tone_map="none", exposure=1.0))
        draws = 0
        for picture in self.pictures.values():
            if isinstance(picture, MirrorPicture):
                picture.show(())
        for job in self.jobs:
            size = job.drawn[0].rectangle[2:]
            parts = [each.part for each in job.drawn if each.part is not None]
            if isinstance(job.picture, MirrorPicture):
                buffer = job.picture.begin_view(job.number, size, samples)
            else:
                buffer = job.picture.begin(size, samples)
            draw = stage.draw_parts if parts else stage.draw
            draws += draw(buffer.framebuffer, samples, emitted if job.picture.decoded else scene, job.drawn)
            if isinstance(job.picture, MirrorPicture):
                buffer.finish([piece for part in parts for piece in part.pieces] if parts else None)
            else:
                job.picture.finish()
        return draws

    def draw_insets(self, world: World, views: Sequence[View], depth: float) -> int:
        """Draw the insets over the views of the first screen; return the draw calls.

        Args:
            world: The world.
            views: Views of the frame.
            depth: Distance of the heads-up display [m].
        """
        shown = [(_inset_key(name), inset) for name, inset in world.insets.items() if name in world]
        shown = [(key, inset) for key, inset in shown if self.pictures[key].drawn]
        if not shown:
            return 0
        eyes = [view for view in views if view.screen == views[0].screen]
        plane, draws = plane_of_views(eyes, depth), 0
        for key, inset in shown:
            pixels = inset_pixels(inset, eyes[0])
            draws += sum(self._insets.draw(inset, self.pictures[key], pixels, eye, plane) for eye in eyes)
        return draws

    def release(self) -> None:
        """Free all pictures."""
        self._insets.release()
        for picture in self.pictures.values():
            picture.release()
        self.pictures.clear()

    def _queue_mirrors(self, world: World, number: int, drawn: ViewDraws, batch: Batch, resolution: float) -> ViewDraws:
        """Queue a picture for each visible mirror; return the view with its mirrors."""
        seen, shown = drawn.materials, []
        for name, mirror in world.mirrors.items():
            key = live_key(name)
            picture = self.pictures[key]
            self.held.discard(key)
            if key not in seen or not isinstance(picture, MirrorPicture):
                continue
            reflection = self.reflect(world, name, mirror, drawn.view, drawn.rectangle[2:], resolution)
            if reflection is not None:
                self.jobs.append(PictureJob(picture, number, [batch(reflection.view, (key, number))]))
                self.held.add(key)
            shown.append((picture, number, reflection))
        return replace(drawn, mirrors=shown)

    def reflect(
        self, world: World, name: str, mirror: Mirror, view: View, size: Size, resolution: float
    ) -> Reflection | None:
        """Return the reflection of a view in a mirror; None where it shows none.

        Args:
            world: The world, updated.
            name: Name of the mirror's node.
            mirror: The mirror.
            view: The view.
            size: Size of the view's picture [px].
            resolution: Factor on the resolution of mirrors.
        """
        body = body_of(world.find(name)) if name in world else None
        if body is None:
            return None
        mesh = world.meshes[body.subentities[0].mesh]
        plane = plane_of_sheet(mesh)
        if plane is None:
            if name not in self._reported:
                self._reported.add(name)
                self.issues.append(Issue("", "", f'mirror "{name}": its mesh is not flat; drawn without a picture'))
            return None
        world_from_body = body.node.world_matrix()
        of_world = np.asarray(np.linalg.solve(world_from_body.T, plane), np.float64)
        of_world = of_world / float(np.linalg.norm(of_world[:3]))
        ends = np.stack(mesh.bounds).astype(np.float64)
        local = np.array([[ends[k >> axis & 1][axis] for axis in range(3)] for k in range(8)])
        corners = local @ world_from_body[:3, :3].T + world_from_body[:3, 3]
        return reflect_view(view, size, of_world, corners, mirror.resolution * resolution)

    def queue_cameras(self, world: World, view: View, seen: set[str], batch: Batch) -> None:
        """Queue insets, and the screens visible with some materials, in mirrors, insets or other screens.

        Screens are drawn before the mirrors that show them.
        """
        mirrored = self.jobs
        self.jobs = []
        for name, inset in world.insets.items():
            if name in world and self.due(_inset_key(name), inset.every):
                self._queue_camera(world, _inset_key(name), inset.camera, inset_pixels(inset, view)[2:], batch)
        insets, self.jobs = self.jobs, []
        waiting, known = [seen, *(each.materials for job in (*mirrored, *insets) for each in job.drawn)], set[str]()
        while waiting:
            seen = waiting.pop()
            for name, screen in world.screens.items():
                key = live_key(name)
                if key in seen and name not in known:
                    known.add(name)
                    if self.due(key, screen.every):
                        waiting += self._queue_camera(world, key, screen.camera, screen.size, batch)
        self.jobs += mirrored + insets

    def _queue_camera(self, world: World, key: str, camera: str, size: Size, batch: Batch) -> list[set[str]]:
        """Queue the picture of a camera; return the materials seen in it, as the only one."""
        eye = world.find(camera).camera if camera in world else None
        if eye is None:
            return []
        drawn = batch(desktop_views(eye, size)[0], key)
        self.jobs.append(PictureJob(self.pictures[key], 0, [drawn]))
        return [drawn.materials]

    def due(self, key: str, every: int) -> bool:
        """Whether the picture of a key is drawn in this frame, of which every `every`-th one draws it."""
        return not self.pictures[key].drawn or self._frames % every == 0


def _inset_key(node: str) -> str:
    return f"inset:{node}"
