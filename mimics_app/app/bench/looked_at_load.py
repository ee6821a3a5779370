"""The load of `mimics bench frame` for a scene in which nothing is to be done: it is looked at, what moves moves."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from pathlib import Path

from mimics_app.app.bench.frame_watch import SETTLING_S, FrameWatch, Row
from mimics_app.app.picture.governor import FrameGovernor
from mimics_app.app.picture.held_quality import measure_frame_ms
from mimics_app.app.picture.picture import Picture, live_quality, picture_quality
from mimics_app.app.planner.tolerances import tolerances_of
from mimics_app.app.scenes.loading import load_checked_scene
from mimics_app.app.settings import Profile, Quality
from mimics_app.contracts.board import Board
from mimics_app.contracts.clock import Clock, MonotonicClock
from mimics_app.rendering.visual.quality_steps import quality_steps
from mimics_app.rendering.visual.surfaces.contexts import create_surface
from mimics_app.rendering.visual.surfaces.surface import Surface
from mimics_app.world.scene.file import build_world
from mimics_app.world.scene.scene import Scene
from mimics_app.world.world import World

__all__ = ["measure_looked_at"]

_PROFILE: Profile = "training"


@dataclass
class _LookedAt:
    """A picture that is drawn again and again."""

    world: World
    clock: Clock
    picture: Picture | None
    governor: FrameGovernor | None

    def draw(self) -> None:
        """One frame."""
        assert self.picture is not None and self.governor is not None
        begun_ns = self.clock.now_ns()
        with self.picture.begin_frame().stage("world update"):
            self.world.effects.time = self.world.motion.time = 1e-9 * begun_ns
            self.world.update()
        done_ns = self.picture.show_frame(Board(), self.clock)
        self.governor.note(1e-6 * (done_ns - begun_ns), done_ns)


def measure_looked_at(file: Path, size: tuple[int, int], where: str, seconds: float, quality: Quality) -> Row:
    """A row of `mimics bench frame` without touch, sound and recorder; no tick can be missed.

    Args:
        file: The scene.
        size: Of the picture [px].
        where: "window" or "egl".
        seconds: Length of the measurement [s].
        quality: As of a run.
    """
    scene = load_checked_scene(file)
    with create_surface(where, size, scene.name) as surface:
        looked_at = _open(scene, surface, quality)
        watch = FrameWatch(looked_at, seconds)
        until = looked_at.clock.now_ns() + 1e9 * (SETTLING_S + seconds)
        while looked_at.clock.now_ns() < until:
            looked_at.draw()
            watch.look()
        return watch.row() | {"scene": file.stem, "size": list(size), "missed_share": None}


def _open(scene: Scene, surface: Surface, quality: Quality) -> _LookedAt:
    world = build_world(scene)
    world.update()
    full = quality == "full"
    settings = picture_quality(scene, _PROFILE) if full else live_quality(scene, _PROFILE, surface)
    picture = Picture(surface, scene, world, settings)
    steps = quality_steps(picture.renderer)
    fixed = [step.name for step in steps] if full else []
    governor = FrameGovernor(steps, tolerances_of(scene, _PROFILE)["frame_ms"], fixed=fixed)
    governor.settle(partial(measure_frame_ms, picture))
    return _LookedAt(world, MonotonicClock(), picture, governor)
