"""The picture of a session: a surface, a renderer, a display, and the board over the scene."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

from mimics_app.app.picture.active_view import ActiveView, view_names
from mimics_app.app.picture.board import OPERATORS_CARDS, BoardLayout
from mimics_app.app.picture.contact_shadow import ContactShadow
from mimics_app.app.picture.lost_picture import draw_or_recover
from mimics_app.app.picture.methods import with_methods
from mimics_app.app.picture.operator_picture import OperatorPicture
from mimics_app.app.picture.second_view import SecondView
from mimics_app.app.picture.shown_on import open_display
from mimics_app.app.picture.video import Film
from mimics_app.app.planner.plan import plan_scene
from mimics_app.app.planner.uses import shadow_distance_of, visual_of
from mimics_app.app.settings import Profile
from mimics_app.app.stage_timer import UNTIMED, StageTimer
from mimics_app.app.terminal.output import say
from mimics_app.contracts.arrays import F8, Vec3
from mimics_app.contracts.clock import FRAME_NS, Clock
from mimics_app.contracts.errors import SceneError, nearest
from mimics_app.contracts.messages.board import Board
from mimics_app.contracts.ports.display_port import Display, FrameTiming
from mimics_app.contracts.ports.input_port import Ray
from mimics_app.rendering.visual.figures.hud import Hud
from mimics_app.rendering.visual.figures.key_page import KeyPage
from mimics_app.rendering.visual.frame_stats import FrameStats
from mimics_app.rendering.visual.launcher.page_surface import PageSurface
from mimics_app.rendering.visual.launcher.thumbnail import load_thumbnail
from mimics_app.rendering.visual.passes.hud import plane_of_views
from mimics_app.rendering.visual.presenting.presenter import Presenter
from mimics_app.rendering.visual.renderer import Renderer
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.surfaces.headless import WritePng, write_png
from mimics_app.rendering.visual.surfaces.rasteriser import rasteriser_of
from mimics_app.rendering.visual.surfaces.surface import Size, Surface
from mimics_app.rendering.visual.view import Latch, View
from mimics_app.world.components.visible import Hud as HudComponent
from mimics_app.world.content.world import World
from mimics_app.world.files.scene.scene import Scene

__all__ = ["Picture", "live_quality", "pays_for_pixels", "picture_quality"]

_LEAD_SHARE = 0.1
"""Share of a frame's time to its display that goes into the prediction for the next one."""


def live_quality(
    scene: Scene, profile: Profile, surface: Surface, drawn: Size | None = None, *, full: bool = False
) -> RenderSettings:
    """Return the quality of a live picture; drawn on the processor, it is the planner's choice for its frame time.

    The costs of the planner's table are those of the processor. With a graphics card only the frame governor holds the
    frame time.

    Args:
        scene: The scene.
        profile: Profile whose tolerances hold where the scene states none.
        surface: Surface of the picture.
        drawn: Size of the picture as drawn, for all eyes together [px]; None: that of the surface.
        full: True for the full quality, however long a frame takes.
    """
    width, height = drawn or surface.size
    return picture_quality(scene, profile, width * height if pays_for_pixels(surface) else 0, limited=not full)


def pays_for_pixels(surface: Surface) -> bool:
    """Whether the time of a frame grows with its pixels, see `Rasteriser`."""
    return rasteriser_of(surface.ctx).pays_for_pixels


def picture_quality(scene: Scene, profile: Profile, pixels: int = 0, *, limited: bool = True) -> RenderSettings:
    """Return the quality of a picture: that of the scene's `systems.visual`, the planner's choice where it is open.

    Args:
        scene: The scene.
        profile: Profile whose tolerances hold where the scene states none.
        pixels: Size of a live picture drawn on the processor [px]; 0: the frame time is free (see `plan.plan_scene`).
        limited: False leaves the frame time of a live picture free, too.
    """
    visual = visual_of(scene)
    boards = scene.components(HudComponent)
    board = boards[0][1] if boards else HudComponent()
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
        hud_depth=board.depth,
        hud_enlarged=board.enlarged,
        fog_density=visual.fog_density,
        profile=profile,
    )
    return with_methods(wanted, plan_scene(scene, profile, pixels=pixels, limited=limited).settings)


_WITH_KEYS = 9
"""Number of cameras that a key shows, 1 to 9."""


class Picture:
    """The picture that the person sees.

    Args:
        surface: Surface to draw on; closed with the picture.
        scene: The scene, for its board and display.
        world: The world to draw; it needs a camera.
        settings: Quality.
        camera: Entity whose camera is shown first; "": as the scene's `systems.visual.view`.
        display: The display, closed with the picture; None: that of the scene.
        sparse: True for single pictures of a session, see `Renderer`.

    Attributes:
        surface: The surface.
        view: The view that is shown.
        presenter: Presenter of the drawn frames on the display.
        renderer: The renderer.
        film: Video of the shown frames; None without one.
        copies: Takers of pictures for the operator; none without.
        page: Page over the picture; None for none.
        stats: Cost of the last frame; None before the first.

    Raises:
        SceneError: The scene has no camera, or none of that name; or the file of its display is faulty.
        DeviceError: The display is not available.
    """

    def __init__(
        self,
        surface: Surface,
        scene: Scene,
        world: World,
        settings: RenderSettings,
        camera: str = "",
        display: Display | None = None,
        *,
        sparse: bool = False,
    ) -> None:
        self.surface = surface
        self._wanted = camera
        self.presenter = Presenter(display or open_display(scene, "", surface), surface)
        self._lead_ns = FRAME_NS
        self.renderer = Renderer(self.presenter.drawn, world, settings, sparse=sparse)
        self.film: Film | None = None
        self.copies: list[OperatorPicture | SecondView] = []
        self.page: KeyPage | None = None
        self._contact: ContactShadow | None = None
        self._layout = BoardLayout()
        self._image: Path | None = None
        self._operators: tuple[PageSurface, BoardLayout] | None = None
        self.stats: FrameStats | None = None
        self._defers = rasteriser_of(surface.ctx).defers
        self.show(scene, world)

    def show(self, scene: Scene, world: World) -> None:
        """Draw a scene and its world from now on: the first one, or a reloaded one."""
        if not world.cameras:
            raise SceneError(scene.issue("/entities", "has no camera", 'give an entity a "camera" component'))
        visual, names = visual_of(scene), view_names(world)
        if self._wanted and self._wanted not in names:
            what = f'has no camera "{self._wanted}"'
            raise SceneError(scene.issue("/entities", what, nearest(self._wanted, names)))
        self.view = ActiveView(world, self._wanted or visual.view or "", visual.flight, cuts=not self.presenter.worn)
        self.renderer.world = world
        if self._contact is not None and self._contact.world is not world:
            self._contact = ContactShadow(scene, world)
        board = scene.components(HudComponent)
        self._board = board[0][1] if board else None

    def show_view(self, name: str) -> None:
        """Show the view of an entity's camera from the next frame on, also after a reload of the scene.

        Raises:
            KeyError: The world has no camera of that name; the message names the nearest.
        """
        self.view.select(name)
        self._wanted = name

    def keep_contact_shadow(self, scene: Scene) -> None:
        """Draw a shadow under the hand from now on whenever the quality has no other shadows."""
        self._contact = ContactShadow(scene, self.renderer.world)

    @property
    def views(self) -> list[View]:
        """The views of the display, one for each eye or wall."""
        return self.presenter.views(self.view.camera)

    def each_view(self) -> Iterator[list[View]]:
        """Yield the same of each of the world's cameras that a key shows."""
        for camera in self.renderer.world.cameras[:_WITH_KEYS]:
            yield self.presenter.views(camera)

    @property
    def _latch(self) -> Latch | None:
        """Function that reads the head again just before drawing; None where the display follows none."""
        return partial(self.presenter.views, self.view.camera) if self.presenter.follows_head else None

    @property
    def leaving(self) -> bool:
        """Whether the person has closed the window or ended the session of the headset."""
        return self.surface.should_close or self.presenter.leaving

    def draw(self, board: Board, now_ns: int = 0) -> FrameStats:
        """Draw one frame with a board, for a session time [ns]."""
        timing = self.presenter.begin_seen(now_ns)
        self.view.advance(now_ns)
        views = self.views
        self.stats = self.renderer.draw(views, self._latch, partial(self.lay_out, board, views))
        if timing.render:
            self.presenter.present()
        else:
            self.presenter.skip()
        self.report_issues()
        return self.stats

    def begin_frame(self) -> StageTimer:
        """Begin the timing of a frame; return the timer of its stages."""
        if self.renderer.times is not None:
            self.renderer.times.begin()
        return self.timer

    @property
    def timer(self) -> StageTimer:
        """Timer of the stages of a frame."""
        return self.renderer.times or UNTIMED

    def expect(self, now_ns: int) -> FrameTiming:
        """Return when the frame that begins now will be seen: as a headset says, else as late as the last ones were."""
        if self.presenter.paces:
            return self.presenter.begin(now_ns)
        return FrameTiming(now_ns + self._lead_ns, FRAME_NS)

    def shown(self, begun_ns: int, swapped_ns: int) -> None:
        """Take the times at which a frame began and the swap of its buffers was over, which waits for the screen."""
        lead_ns = min(swapped_ns - begun_ns, 2 * FRAME_NS)
        self._lead_ns += round(_LEAD_SHARE * (lead_ns - self._lead_ns))

    def show_frame(self, board: Board, clock: Clock) -> int:
        """Draw one frame, show it, and return the time at which its work was done [ns].

        A driver that draws on the processor has done its work after the swap of the buffers. Any other is waited for
        before the swap, which waits for the display. Nothing is drawn for a headset that shows nothing.

        After a loss of the context the frame is drawn again in a new one.

        Raises:
            DeviceError: The context was lost and cannot be created again.
        """
        if self._contact is not None:
            self._contact.follow(self.view.camera.world_from_eye[:3, 3])
        self.view.advance(clock.now_ns())
        timing = self.presenter.timing if self.presenter.begun else self.presenter.begin(clock.now_ns())
        if not timing.render:
            self.presenter.skip()
            return clock.now_ns()
        return draw_or_recover(self.surface, lambda: self._show(board, clock), self.recover)

    @property
    def _takers(self) -> list[Film | OperatorPicture | SecondView]:
        return [*([] if self.film is None else [self.film]), *self.copies]

    def start_film(self, wanted: Path, *, live: bool) -> Film:
        """Make a video of the frames shown from now on; see `Film`."""
        self.film = Film(self.surface, wanted, live=live)
        return self.film

    def recover(self) -> None:
        """Create a new context and renderer after a loss; world, quality and board stay.

        Raises:
            DeviceError: The context cannot be created.
        """
        for taker in self._takers:
            taker.forget()
        self._operators = None
        self.surface.renew()
        self.presenter.renew()
        self.renderer.renew()
        self._defers = rasteriser_of(self.surface.ctx).defers

    def _show(self, board: Board, clock: Clock) -> int:
        views = self.views
        draw = self.renderer.draw if self._defers else self.renderer.draw_finished
        self.stats = draw(views, self._latch, partial(self.lay_out, board, views))
        self.presenter.present()
        if self.presenter.mirrored:
            self._draw_for_operator(board)
        waited_ns = clock.now_ns()
        with self.timer.stage("swap"):
            self.surface.swap()
        done_ns = clock.now_ns() if self._defers else waited_ns
        for taker in self._takers:
            taker.take(done_ns)
        self.report_issues()
        return done_ns

    def report_issues(self) -> None:
        """Report on stderr each deviation of the picture from the scene, once."""
        for issue in self.renderer.take_issues():
            say(str(issue))
        for fault in self.presenter.take_faults():
            say(fault)

    def lay_out(self, board: Board, views: Sequence[View]) -> None:
        """Draw a board over the picture of these views."""
        with self.timer.stage("board"):
            self._lay_out(board, views)

    def _lay_out(self, board: Board, views: Sequence[View]) -> None:
        hud = self.renderer.hud
        screen = [view for view in views if view.screen == views[0].screen]
        settings = self.renderer.settings
        plane = plane_of_views(screen, settings.hud_depth, settings.hud_enlarged)
        hud.width, hud.height = plane.canvas_width, plane.canvas_height
        worn, page = self.presenter.worn, None if self.presenter.mirrored else self.page
        self._show_image(hud, None if page is None else page.picture)
        self._layout.lay(hud, board.for_wearer() if worn else board, *self._shown_cards(), page)

    def _shown_cards(self) -> tuple[list[str], float]:
        """Return the names of the cards to show, and the full scale of their bars [N]."""
        if self._board is None:
            return [], 0.0
        operator = self.renderer.shows("forces")
        return [name for name in self._board.show if operator or name not in OPERATORS_CARDS], self._board.force_full

    def _draw_for_operator(self, board: Board) -> None:
        """Draw the whole board over the mirror of a headset."""
        if self._operators is None:
            self._operators = PageSurface(self.surface), BoardLayout()
        canvas, layout = self._operators
        canvas.fit()
        page = None if self.page is None else replace(self.page, picture=None)
        layout.lay(canvas.hud, board, *self._shown_cards(), page)
        canvas.draw(over=True)

    def _show_image(self, hud: Hud, file: Path | None) -> None:
        """Give the canvas the image of the page, as long as it is shown."""
        if file == self._image:
            return
        self._image = file
        hud.images = None if file is None else load_thumbnail(file)[None]

    def ray(self, right: float, up: float) -> Ray | None:
        """Return the ray through a point of the window, each coordinate in [-1, 1]."""
        origin, direction = self.presenter.ray(self.view.camera, right, up)
        return _triple(origin), _triple(direction)

    def save(self, file: Path, write: WritePng = write_png) -> list[Path]:
        """Write the last frame as PNG and return the files, see `Presenter.save`."""
        return self.presenter.save(file, write)

    def abandon(self) -> None:
        """Finish the video after a permanent loss of the context, with which everything else is freed already."""
        if self.film is not None:
            self.film.forget()
            self.film.finish()

    def close(self) -> None:
        """Finish the video and release everything, the surface included."""
        if self.film is not None:
            self.film.finish()
        for copy in self.copies:
            copy.release()
        if self._operators is not None:
            self._operators[0].release()
        self.renderer.release()
        self.presenter.release()
        self.surface.close()


def _triple(values: F8) -> Vec3:
    return float(values[0]), float(values[1]), float(values[2])
