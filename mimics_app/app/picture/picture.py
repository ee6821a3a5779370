"""The picture of a session: a surface, a renderer on it, and the views of the scene's camera."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from mimics_app.app.picture.board import OPERATORS_CARDS, draw_board
from mimics_app.app.picture.key_page import Keys, draw_keys
from mimics_app.app.picture.lost_picture import draw_or_recover
from mimics_app.app.picture.methods import with_methods
from mimics_app.app.picture.video import Film
from mimics_app.app.planner.plan import plan_scene
from mimics_app.app.planner.uses import shadow_distance_of, visual_of
from mimics_app.app.settings import Profile
from mimics_app.contracts.board import Board
from mimics_app.contracts.clock import Clock
from mimics_app.contracts.errors import SceneError, nearest
from mimics_app.contracts.input_port import Ray
from mimics_app.contracts.stage_timer import UNTIMED, StageTimer
from mimics_app.rendering.visual.displays.desktop import desktop_views
from mimics_app.rendering.visual.figures.hud import CANVAS_HEIGHT
from mimics_app.rendering.visual.frame_stats import FrameStats
from mimics_app.rendering.visual.renderer import Renderer
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.surfaces.capabilities import read_capabilities
from mimics_app.rendering.visual.surfaces.headless import save_png
from mimics_app.rendering.visual.surfaces.surface import Surface
from mimics_app.rendering.visual.view import View
from mimics_app.world.components.visible import Hud as HudComponent
from mimics_app.world.scene.scene import Scene
from mimics_app.world.world import World

__all__ = ["Picture", "draws_in_software", "live_quality", "picture_quality"]


def live_quality(scene: Scene, profile: Profile, surface: Surface) -> RenderSettings:
    """Quality of a picture that must keep up: on the processor its frames bear only what the planner finds room for.

    The table's costs are of pictures drawn on the processor; of another driver they say nothing, and the frame
    governor alone minds the time.
    """
    width, height = surface.size
    return picture_quality(scene, profile, width * height if draws_in_software(surface) else 0)


def draws_in_software(surface: Surface) -> bool:
    """Whether the driver draws on the processor."""
    return read_capabilities(surface.ctx).software


def picture_quality(scene: Scene, profile: Profile, pixels: int = 0) -> RenderSettings:
    """Quality of the picture: what the scene's `systems.visual` says, and the planner where it leaves the choice.

    Args:
        scene: What is drawn.
        profile: Whose tolerances hold where the scene states none.
        pixels: Of a live picture drawn on the processor [px]; 0: it may take its time (see `plan.plan_scene`).
    """
    visual = visual_of(scene)
    boards = scene.components(HudComponent)
    depth = boards[0][1].depth if boards else RenderSettings().hud_depth
    wanted = RenderSettings(
        bloom=visual.bloom,
        ambient_occlusion=visual.ambient_occlusion,
        ambient_radius=visual.ambient_radius,
        exposure=visual.exposure,
        tone_map=visual.tone_map,
        shadow_size=RenderSettings().shadow_size if visual.shadow_size == "auto" else visual.shadow_size,
        shadows="texture_additive" if visual.shadows == "auto" else visual.shadows,
        shadow_distance=shadow_distance_of(scene),
        cascades=visual.cascades,
        hud_depth=depth,
        fog_density=visual.fog_density,
        profile=profile,
    )
    return with_methods(wanted, plan_scene(scene, profile, pixels=pixels).settings)


class Picture:
    """What the person sees.

    Args:
        surface: Where to draw; closed with the picture.
        scene: For the figures wanted over the picture.
        world: What is drawn; needs a camera.
        settings: Quality.
        camera: Entity whose camera is looked through; "": the first.

    Attributes:
        surface: Where it is drawn.
        renderer: What draws it.
        film: Gets every frame that is shown; None: there is no film.
        keys: A page of keys that covers the middle; () for none.
        stats: What the frame drawn last cost; None before the first.

    Raises:
        SceneError: the scene has no camera, or none of that name.
    """

    def __init__(
        self, surface: Surface, scene: Scene, world: World, settings: RenderSettings, camera: str = ""
    ) -> None:
        self.surface = surface
        self._wanted = camera
        self.renderer = Renderer(surface, world, settings)
        self.film: Film | None = None
        self.keys: Keys = ()
        self.stats: FrameStats | None = None
        self._software = draws_in_software(surface)
        self.show(scene, world)

    def show(self, scene: Scene, world: World) -> None:
        """Draw this scene from now on (the first one, or a reloaded one)."""
        if not world.cameras:
            raise SceneError(scene.issue("/entities", "has no camera", 'give an entity a "camera" component'))
        cameras = {camera.node.name: camera for camera in world.cameras}
        if self._wanted and self._wanted not in cameras:
            what = f'has no camera "{self._wanted}"'
            raise SceneError(scene.issue("/entities", what, nearest(self._wanted, cameras)))
        self._camera = cameras[self._wanted] if self._wanted else world.cameras[0]
        self.renderer.world = world
        board = scene.components(HudComponent)
        self._board = board[0][1] if board else None

    @property
    def views(self) -> list[View]:
        """The eyes of the desktop: one."""
        return desktop_views(self._camera, self.surface.size)

    def draw(self, board: Board) -> FrameStats:
        """Draw one frame with a board over it."""
        with self.timer.stage("board"):
            self.lay_out(board)
        self.stats = self.renderer.draw(self.views)
        self.tell_issues()
        return self.stats

    def begin_frame(self) -> StageTimer:
        """Where the times of the stages go that come before the picture; the frame begins with them."""
        if self.renderer.times is not None:
            self.renderer.times.begin()
        return self.timer

    @property
    def timer(self) -> StageTimer:
        """Where the times of a frame's stages go."""
        return self.renderer.times or UNTIMED

    def show_frame(self, board: Board, clock: Clock) -> int:
        """Draw one frame, bring it to the glass, and tell when its work was done [ns].

        A driver that draws on the processor has done it all when the frame is on the glass. Any other is waited for
        before that, because the glass makes a frame wait for the display.

        A context that the driver lost is made anew, and the frame drawn again.

        Raises:
            DeviceError: it was lost, and there is no other.
        """
        return draw_or_recover(self.surface, lambda: self._show(board, clock), self.recover)

    def start_film(self, wanted: Path, *, live: bool) -> Film:
        """Make a film of what is shown from now on; see `Film`."""
        self.film = Film(self.surface, wanted, live=live)
        return self.film

    def recover(self) -> None:
        """Make context and renderer anew after a loss; world, quality and board stay.

        Raises:
            DeviceError: there is no other context.
        """
        if self.film is not None:
            self.film.forget()
        self.surface.renew()
        self.renderer.renew()
        self._software = draws_in_software(self.surface)

    def _show(self, board: Board, clock: Clock) -> int:
        if self._software:
            self.draw(board)
            with self.timer.stage("swap"):
                self.surface.swap()
            done_ns = clock.now_ns()
            self._take_to_film(done_ns)
            return done_ns
        with self.timer.stage("board"):
            self.lay_out(board)
        self.stats = self.renderer.draw_finished(self.views)
        done_ns = clock.now_ns()
        with self.timer.stage("swap"):
            self.surface.swap()
        self._take_to_film(done_ns)
        self.tell_issues()
        return done_ns

    def _take_to_film(self, t_ns: int) -> None:
        if self.film is not None:
            self.film.take(t_ns)

    def tell_issues(self) -> None:
        """Say on stderr what was drawn otherwise than the scene asks, a line for each fault, once."""
        for issue in self.renderer.take_issues():
            sys.stderr.write(f"mimics: {issue}\n")

    def lay_out(self, board: Board) -> None:
        """Put a board over the picture."""
        hud = self.renderer.hud
        width, height = self.surface.size
        hud.width = CANVAS_HEIGHT * width / height
        if self._board is None:
            hud.clear()
        else:
            operator = self.renderer.shows("forces")
            show = [name for name in self._board.show if operator or name not in OPERATORS_CARDS]
            draw_board(hud, board, show, self._board.force_full)
        if self.keys:
            draw_keys(hud, self.keys)

    def ray(self, right: float, up: float) -> Ray | None:
        """The ray through a place of the window, each coordinate in [-1, 1]."""
        origin, direction = self.views[0].ray(right, up)
        return _triple(origin), _triple(direction)

    def save(self, file: Path) -> None:
        """Write the frame drawn last as PNG."""
        save_png(self.surface, file)

    def abandon(self) -> None:
        """Finish the film where the driver is gone: nothing else is left to be freed."""
        if self.film is not None:
            self.film.forget()
            self.film.finish()

    def close(self, *, keep_surface: bool = False) -> None:
        """Finish the film, and free everything, the surface included unless somebody else draws on it next."""
        if self.film is not None:
            self.film.finish()
        self.renderer.release()
        if not keep_surface:
            self.surface.close()


def _triple(values: np.ndarray[tuple[int, ...], np.dtype[np.float64]]) -> tuple[float, float, float]:
    return float(values[0]), float(values[1]), float(values[2])
