"""Frames of a scene as PNG files: the scene is played on the virtual clock without recorder or sound."""

from __future__ import annotations

from contextlib import closing
from functools import partial
from pathlib import Path

from mimics_app.app.picture.drawn import Drawn
from mimics_app.app.picture.picture import Picture, picture_quality
from mimics_app.app.picture.shown_on import open_display
from mimics_app.app.picture.video import draw_film
from mimics_app.app.scenes.loading import check_scene, read_scene
from mimics_app.app.scenes.scenario_choice import is_playable
from mimics_app.app.session.core import SessionCore, open_core
from mimics_app.app.session.frame import Frames
from mimics_app.app.session.preparation import prepare_scene
from mimics_app.app.settings import RunSettings
from mimics_app.contracts.clock import FRAMES_PER_SECOND
from mimics_app.contracts.messages.board import Board
from mimics_app.rendering.visual.frame_set import render_frames
from mimics_app.rendering.visual.presenting.presenter import Presenter
from mimics_app.rendering.visual.surfaces.headless import open_offscreen
from mimics_app.rendering.visual.view import View
from mimics_app.world.content.world import World
from mimics_app.world.files.scene.file import build_world
from mimics_app.world.files.scene.scene import Scene

__all__ = ["draw_stills"]


def draw_stills(
    settings: RunSettings,
    folder: Path,
    *,
    backend: str = "auto",
    frames: int = 1,
    seconds: float = 0.0,
    camera: str = "",
    video: Path | None = None,
    board: bool = True,
    read: Scene | None = None,
) -> Drawn:
    """Draw frames of a scene at even intervals of simulated play, the last after `seconds` [s]; of a video 60 a second.

    A scene that no scenario plays is drawn without a person.

    Args:
        settings: Scene, seed, profile, size and display; the rest is not used.
        folder: Folder of frame_00000.png and so on.
        backend: "auto", "egl", "osmesa" or "window".
        frames: Number of frames.
        seconds: Time for which the simulated patient plays, from the frame in which it may act in the first trial [s].
        camera: Entity whose camera is used; "": the first.
        video: File of a video (see `video.film_place`) instead of the folder's files, or None.
        board: Whether the scene's board is drawn over the picture.
        read: Result of `read_scene` for the settings' scene; None: it is read here.

    Raises:
        SceneError: The scene is faulty, or has no camera, or none of that name.
        DeviceError: The OpenGL context is not available.
    """
    scene = check_scene(read or read_scene(settings.scene))
    if video is not None:
        frames = max(1, round(FRAMES_PER_SECOND * seconds))
    with closing(_moments(scene, settings, frames, seconds)) as play:
        surface = open_offscreen(backend, settings.picture_size)
        display = open_display(scene, settings.display, surface)
        picture = Picture(surface, scene, play.world, picture_quality(scene, settings.profile), camera, display)
        play.shown_by(picture.presenter)
        views = partial(_views_at, picture, play, board)
        if video is None:
            made = render_frames(picture.renderer, surface, frames, views, folder, picture.presenter)
        else:
            made = draw_film(picture.renderer, surface, frames, views, video, picture.presenter)
        drawn = Drawn.on(surface, made)
        picture.report_issues()
        picture.close()
    return drawn


def _views_at(picture: Picture, play: _Standing | _Played, board: bool, number: int) -> list[View]:
    """Bring the world to a frame and return the views to draw."""
    figures = play.to(number)
    picture.presenter.begin(play.time_ns(number))
    seen = picture.views
    if board:
        picture.lay_out(figures, seen)
    return seen


def _moments(scene: Scene, settings: RunSettings, frames: int, seconds: float) -> _Standing | _Played:
    """Return the scene played by its scenario, or standing where it has none."""
    if is_playable(scene):
        return _Played(open_core(prepare_scene(scene, settings)), seconds / frames)
    return _Standing(build_world(scene), settings.seed, seconds / frames)


class _Standing:
    """A world without a task, of which effects and animations move; it starts at time 0."""

    def __init__(self, world: World, seed: int, seconds_per_still: float) -> None:
        self.world = world
        self._seconds_per_still = seconds_per_still
        world.update()
        world.effects.seed = seed
        world.effects.trigger("start")

    def to(self, number: int) -> Board:
        """Bring the world to still `number` and return its board, an empty one."""
        self.world.effects.time = self.world.motion.time = self._seconds_per_still * (number + 1)
        self.world.update()
        return Board()

    def time_ns(self, number: int) -> int:
        """Time of still `number` [ns]."""
        return round(self._seconds_per_still * (number + 1) * 1e9)

    def shown_by(self, presenter: Presenter) -> None:
        """Do nothing: there is no head to follow."""

    def close(self) -> None:
        """Do nothing: no device is open."""


class _Played:
    """The first trial of the scene, from the frame in which the person may act."""

    def __init__(self, core: SessionCore, seconds_per_still: float) -> None:
        self._core = core
        self._frames = Frames(core)
        self._frames.play_to_start()
        self._start = self._frames.number
        self._frames_per_still = seconds_per_still * FRAMES_PER_SECOND

    @property
    def world(self) -> World:
        """The world of the session."""
        return self._core.world

    def shown_by(self, presenter: Presenter) -> None:
        """Let the presenter follow the head of the person."""
        self._core.shown_by(presenter)

    def to(self, number: int) -> Board:
        """Play up to still `number` and return its board."""
        wanted = self._start + round(self._frames_per_still * (number + 1))
        while self._frames.number < wanted:
            self._frames.advance_frame()
        return self._frames.board

    def time_ns(self, number: int) -> int:
        """Session time [ns]."""
        return self._core.clock.now_ns()

    def close(self) -> None:
        """Close the device."""
        self._core.stop()
