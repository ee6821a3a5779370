"""Frames of a scene as PNG files: the scene is played on the virtual clock without recorder or sound."""

from __future__ import annotations

from contextlib import closing
from pathlib import Path
from typing import Protocol

from mimics_app.app.picture.drawn import Drawn
from mimics_app.app.picture.picture import Picture, picture_quality
from mimics_app.app.picture.shown_on import open_display
from mimics_app.app.picture.video import draw_film
from mimics_app.app.scenes.catalogue import is_playable
from mimics_app.app.scenes.loading import check_scene, read_scene
from mimics_app.app.session.core import SessionCore, open_core
from mimics_app.app.session.frame import Frames
from mimics_app.app.session.preparation import prepare_scene
from mimics_app.app.settings import RunSettings
from mimics_app.contracts.board import Board
from mimics_app.contracts.clock import FRAMES_PER_SECOND
from mimics_app.rendering.visual.frame_set import render_frames
from mimics_app.rendering.visual.presenting.presenter import Presenter
from mimics_app.rendering.visual.surfaces.headless import open_offscreen
from mimics_app.rendering.visual.view import View
from mimics_app.world.scene.file import build_world
from mimics_app.world.scene.scene import Scene
from mimics_app.world.world import World

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
    """Draw frames of a scene at even distances of simulated play, the last after `seconds` [s].

    A film has 60 of them a second instead.

    A scene that no scenario plays is drawn as it stands.

    Args:
        settings: Scene, seed, profile, size and display; the rest is not used.
        folder: Where frame_00000.png and so on go.
        backend: "auto", "egl", "osmesa" or "window".
        frames: How many.
        seconds: How long the simulated patient plays, from where the person of the first trial acts [s].
        camera: Entity whose camera is looked through; "": the first.
        video: File of a film (see `video.film_place`) instead of the folder's files, or None.
        board: Whether the scene's figures lie over the picture.
        read: What `read_scene` gave for the settings' scene; None: it is read here.

    Raises:
        SceneError: the scene is wrong, or has no camera, or none of that name.
        DeviceError: the context cannot be had.
    """
    scene = check_scene(read or read_scene(settings.scene))
    if video is not None:
        frames = max(1, round(FRAMES_PER_SECOND * seconds))
    with closing(_moments(scene, settings, frames, seconds)) as play:
        return _draw(play, scene, settings, folder, backend, frames, camera, video, board=board)


def _draw(
    play: _Moments,
    scene: Scene,
    settings: RunSettings,
    folder: Path,
    backend: str,
    frames: int,
    camera: str,
    video: Path | None,
    *,
    board: bool,
) -> Drawn:
    quality = picture_quality(scene, settings.profile)
    surface = open_offscreen(backend, settings.size)
    display = open_display(scene, settings.display, surface)
    picture = Picture(surface, scene, play.world, quality, camera, display)
    play.shown_by(picture.presenter)

    def views(number: int) -> list[View]:
        figures = play.to(number)
        picture.presenter.begin(play.time_ns(number))
        seen = picture.views
        if board:
            picture.lay_out(figures, seen)
        return seen

    if video is None:
        made = render_frames(picture.renderer, picture.surface, frames, views, folder, picture.presenter)
    else:
        made = draw_film(picture.renderer, picture.surface, frames, views, video, picture.presenter)
    drawn = Drawn.on(picture.surface, made)
    picture.report_issues()
    picture.close()
    return drawn


class _Moments(Protocol):
    """A world at the time of each frame."""

    @property
    def world(self) -> World: ...

    def to(self, number: int) -> Board:
        """Bring the world to frame `number` and return its board."""

    def time_ns(self, number: int) -> int:
        """Session time of frame `number` [ns]."""

    def shown_by(self, presenter: Presenter) -> None:
        """Attach the presenter that draws."""

    def close(self) -> None:
        """Nothing is drawn any more."""


def _moments(scene: Scene, settings: RunSettings, frames: int, seconds: float) -> _Moments:
    """The scene played, or as it stands where no scenario plays it."""
    if is_playable(scene):
        return _Played(open_core(prepare_scene(scene, settings)), seconds / frames)
    return _Standing(build_world(scene), settings.seed, frames, seconds)


class _Standing:
    """A world in which nothing happens but what moves on its own; it starts at time 0."""

    def __init__(self, world: World, seed: int, frames: int, seconds: float) -> None:
        self.world = world
        self._seconds_per_frame = seconds / frames
        world.update()
        world.effects.seed = seed
        world.effects.trigger("start")

    def to(self, number: int) -> Board:
        """Advance to frame `number`."""
        self.world.effects.time = self.world.motion.time = self._seconds_per_frame * (number + 1)
        self.world.update()
        return Board()

    def time_ns(self, number: int) -> int:
        return round(self._seconds_per_frame * (number + 1) * 1e9)

    def shown_by(self, presenter: Presenter) -> None:
        """Nobody is there whose head it could follow."""

    def close(self) -> None:
        """Nothing is open."""


class _Played:
    """The first trial of the scene, from where the person acts up to each frame."""

    def __init__(self, core: SessionCore, seconds_per_still: float) -> None:
        self._core = core
        self._frames = Frames(core)
        self._frames.play_to_start()
        self._start = self._frames.number
        self._frames_per_still = seconds_per_still * FRAMES_PER_SECOND

    @property
    def world(self) -> World:
        return self._core.world

    def shown_by(self, presenter: Presenter) -> None:
        self._core.shown_by(presenter)

    def to(self, number: int) -> Board:
        """Play up to still `number` and return its board."""
        wanted = self._start + round(self._frames_per_still * (number + 1))
        while self._frames.number < wanted:
            self._frames.play_on()
        return self._frames.board

    def time_ns(self, number: int) -> int:
        return self._core.clock.now_ns()

    def close(self) -> None:
        """Close the device."""
        self._core.stop()
