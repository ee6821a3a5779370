"""The viewer's viewport: a model in a studio, or a scene, seen through an orbit camera and drawn on a surface."""

from __future__ import annotations

from mimics_app.app.picture.lost_picture import draw_or_recover
from mimics_app.app.picture.orbit_camera import OrbitCamera
from mimics_app.app.picture.picture import pays_for_pixels, picture_quality
from mimics_app.app.settings import Profile
from mimics_app.app.terminal.output import say
from mimics_app.app.viewer.shown import Shown
from mimics_app.app.viewer.studio import Studio, studio_settings
from mimics_app.contracts.errors import Issue, SceneError, nearest
from mimics_app.rendering.visual.frame_stats import FrameStats
from mimics_app.rendering.visual.renderer import Renderer
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.surfaces.surface import Surface
from mimics_app.rendering.visual.view import View
from mimics_app.world.graph.camera import Camera

__all__ = ["Viewport"]

_FEW_NOTES = 3
"""Number of notes on what is not shown, where nothing is."""


class Viewport:
    """View of one model or scene.

    Args:
        surface: Surface to draw on; owned by the caller.
        shown: The model or scene.
        profile: Quality of a scene's picture.
        camera: Entity whose camera is the first view; "": the scene's first camera, or a view of everything.

    Attributes:
        surface: The surface.
        shown: The present model or scene.
        orbit: The orbit camera.
        renderer: The renderer.
        studio: Studio around a model; None for a scene.

    Raises:
        SceneError: Nothing is visible, or there is no camera of that name.
    """

    def __init__(self, surface: Surface, shown: Shown, profile: Profile = "training", camera: str = "") -> None:
        self.surface = surface
        self.orbit = OrbitCamera()
        self._profile: Profile = profile
        self._camera = camera
        self.studio: Studio | None = None
        self.shown = shown
        settings = self._furnish(shown)
        self._samples = settings.msaa
        self.renderer = Renderer(surface, shown.world, settings)
        self.reset()

    @property
    def pays_for_pixels(self) -> bool:
        """Whether the time of a frame grows with its pixels, see `Rasteriser`."""
        return pays_for_pixels(self.surface)

    def show(self, shown: Shown) -> None:
        """Show another model or scene, or the same reloaded; the orbit camera stays."""
        self._furnish(shown)
        self.shown = shown
        self.renderer.world = shown.world

    def reset(self) -> None:
        """Return to the first view."""
        start, extent = self._start(), self.shown.extent
        if start is not None:
            reach = 1.0 if extent is None else 0.5 * float(((extent[1] - extent[0]) ** 2).sum() ** 0.5)
            self.orbit.stand_at(start, reach)
        elif extent is not None:
            self.orbit.frame(extent, self.surface.size)

    def draw(self, *, smooth: bool = True) -> FrameStats:
        """Draw one frame with the heads-up display; a lost context is created again.

        Args:
            smooth: False: without anti-aliasing, which is much faster on the processor.

        Raises:
            DeviceError: The context was lost and cannot be created again.
        """
        self.renderer.set_quality(msaa=self._samples if smooth else 0)
        return draw_or_recover(self.surface, lambda: self._report(self.renderer.draw(self.views())), self._recover)

    def draw_finished(self) -> FrameStats:
        """Draw one frame, and wait until the driver has finished it."""
        return self._report(self.renderer.draw_finished(self.views()))

    def release(self) -> None:
        """Free everything but the surface."""
        self.renderer.release()

    def _recover(self) -> None:
        self.surface.renew()
        self.renderer.renew()

    def views(self) -> list[View]:
        """Return the view of the orbit camera; the canvas of the display gets the aspect ratio of the picture."""
        self.renderer.hud.fit(self.surface.size)
        return [self.orbit.view(self.surface.size)]

    def _report(self, stats: FrameStats) -> FrameStats:
        """Report on stderr each deviation of the picture from the file, once."""
        for issue in self.renderer.take_issues():
            say(str(issue))
        return stats

    def _furnish(self, shown: Shown) -> RenderSettings:
        if shown.scene is not None:
            return picture_quality(shown.scene, self._profile)
        extent = shown.extent
        if extent is None:
            why = "; ".join(shown.notes[:_FEW_NOTES]) or "no mesh in its scene"
            raise SceneError(Issue(str(shown.path), "", f"there is nothing to see: {why}"))
        before, self.studio = self.studio, Studio(shown.world, extent, OrbitCamera().yaw)
        if before is not None:
            self.studio.take_over(before)
        return studio_settings(extent)

    def _start(self) -> Camera | None:
        cameras = {camera.node.name: camera for camera in self.shown.world.cameras}
        if not self._camera:
            return next(iter(cameras.values()), None) if self.shown.scene is not None else None
        if self._camera not in cameras:
            what = f'has no camera "{self._camera}"'
            raise SceneError(Issue(str(self.shown.path), "", what, nearest(self._camera, cameras) if cameras else ""))
        return cameras[self._camera]
