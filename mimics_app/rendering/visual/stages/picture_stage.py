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
from mimics_app.rendering.visual.passes.hud import plane_of_views
from mimics_app.rendering.visual.passes.inset import InsetPass, inset_pixels
from mimics_app.rendering.visual.pictures.live_picture import LivePicture, MirrorPicture
from mimics_app.rendering.visual.pictures.mirror_views import Reflection, plane_of_sheet, reflect_view
from mimics_app.rendering.visual.stages.world_stage import FrameScene, ViewDraws, WorldStage
from mimics_app.rendering.visual.surfaces.surface import Size
from mimics_app.rendering.visual.view import View
from mimics_app.world.live_pictures import MirrorSurface, body_of, live_key
from mimics_app.world.world import World

if TYPE_CHECKING:
    import moderngl

__all__ = ["PictureStage"]

Batch = Callable[[View, Hashable], ViewDraws]
"""Queues what is visible in a view whose rectangle starts at 0, 0."""


@dataclass(frozen=True, eq=False)
class _Job:
    """A picture to draw: its target, the number of the view it belongs to (mirrors), and its draws."""

    picture: LivePicture
    number: int
    drawn: ViewDraws


class PictureStage:
    """Draws the pictures of visible mirrors, screens and insets.

    Within a picture, mirrors show the sky, which ends recursion, and a screen in its own picture shows the last one. No
    filter is applied. Shadow maps are those of the frame.

    Attributes:
        pictures: Pictures by the key of the texture they replace.
        issues: Mirrors that are not flat, each reported once; the caller removes what it reports.
    """

    def __init__(self, ctx: moderngl.Context, shaders: ShaderLibrary) -> None:
        self._ctx = ctx
        self._insets = InsetPass(ctx, shaders)
        self.pictures: dict[str, LivePicture] = {}
        self.issues: list[Issue] = []
        self._jobs: list[_Job] = []
        self._frames = 0
        self._reported: set[str] = set()

    def update(self, world: World) -> None:
        """Create a picture for each mirror, screen and inset of the world, and free all others."""
        wanted: dict[str, Callable[[moderngl.Context], LivePicture]] = {}
        wanted |= dict.fromkeys(map(live_key, world.mirrors), MirrorPicture)
        wanted |= dict.fromkeys(map(live_key, world.screens), LivePicture)
        wanted |= dict.fromkeys(map(_inset_key, world.insets), partial(LivePicture, decoded=False))
        for key in [key for key in self.pictures if key not in wanted]:
            self.pictures.pop(key).release()
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
        self._jobs = []
        self._frames += 1
        if not (world.mirrors or world.screens or world.insets):
            return list(drawn)
        reflected = [self._queue_mirrors(world, number, each, batch, resolution) for number, each in enumerate(drawn)]
        mirrored = [job.drawn for job in self._jobs]
        insets = self._queue_insets(world, drawn[0].view, batch)
        screens = self._queue_screens(world, [*drawn, *mirrored, *insets], batch)
        self._jobs = screens + self._jobs
        return reflected

    @property
    def triangles(self) -> int:
        """Triangles of all pictures of the frame."""
        return sum(job.drawn.triangles for job in self._jobs)

    def draw(self, stage: WorldStage, scene: FrameScene, samples: int) -> int:
        """Draw the frame's pictures; return the draw calls."""
        if not self._jobs:
            return 0
        # A screen emits linear light, which is tone mapped in the view that sees the screen.
        scene = replace(scene, settings=replace(scene.settings, ambient_occlusion=0.0))
        emitted = replace(scene, settings=replace(scene.settings, tone_map="none", exposure=1.0))
        draws = 0
        for picture in self.pictures.values():
            if isinstance(picture, MirrorPicture):
                picture.show(())
        for job in self._jobs:
            size = job.drawn.rectangle[2:]
            if isinstance(job.picture, MirrorPicture):
                buffer = job.picture.begin_view(job.number, size, samples)
            else:
                buffer = job.picture.begin(size, samples)
            draws += stage.draw(buffer.framebuffer, samples, emitted if job.picture.decoded else scene, [job.drawn])
            if isinstance(job.picture, MirrorPicture):
                buffer.finish()
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
            picture = self.pictures[live_key(name)]
            if live_key(name) not in seen or not isinstance(picture, MirrorPicture):
                continue
            reflection = self._reflect(world, name, mirror, drawn, resolution)
            if reflection is not None:
                self._jobs.append(_Job(picture, number, batch(reflection.view, ("mirror", name, number))))
            shown.append((picture, number, reflection))
        return replace(drawn, mirrors=shown)

    def _reflect(
        self, world: World, name: str, mirror: MirrorSurface, drawn: ViewDraws, resolution: float
    ) -> Reflection | None:
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
        return reflect_view(drawn.view, drawn.rectangle[2:], of_world, corners, mirror.resolution * resolution)

    def _queue_insets(self, world: World, view: View, batch: Batch) -> list[ViewDraws]:
        found = []
        for name, inset in world.insets.items():
            if name in world and self._due(_inset_key(name), inset.every):
                found += self._queue_camera(world, _inset_key(name), inset.camera, inset_pixels(inset, view)[2:], batch)
        return found

    def _queue_screens(self, world: World, views: Sequence[ViewDraws], batch: Batch) -> list[_Job]:
        """Queue the screens visible in some views, and those visible on these screens; return the jobs."""
        waiting, known, first = list(views), set[str](), len(self._jobs)
        while waiting:
            seen = waiting.pop().materials
            for name, screen in world.screens.items():
                if live_key(name) in seen and name not in known:
                    known.add(name)
                    if self._due(live_key(name), screen.every):
                        waiting += self._queue_camera(world, live_key(name), screen.camera, screen.size, batch)
        jobs, self._jobs = self._jobs[first:], self._jobs[:first]
        return jobs

    def _queue_camera(self, world: World, key: str, camera: str, size: Size, batch: Batch) -> list[ViewDraws]:
        eye = world.find(camera).camera if camera in world else None
        if eye is None:
            return []
        drawn = batch(desktop_views(eye, size)[0], key)
        self._jobs.append(_Job(self.pictures[key], 0, drawn))
        return [drawn]

    def _due(self, key: str, every: int) -> bool:
        return not self.pictures[key].drawn or self._frames % every == 0


def _inset_key(node: str) -> str:
    return f"inset:{node}"
