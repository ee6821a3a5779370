"""The load of `mimics bench frame` for scenes without a task: the scene is drawn with its effects and animations."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

from mimics_app.app.bench.frame_watch import FrameWatch, Row
from mimics_app.app.bench.people_workload import ON_SIDEWALKS, People
from mimics_app.app.bench.render_workloads import Walk
from mimics_app.app.picture.governor import FrameGovernor
from mimics_app.app.picture.held_quality import measure_frame_ms
from mimics_app.app.picture.picture import Picture, live_quality
from mimics_app.app.planner.tolerances import tolerances_of
from mimics_app.app.scenes.loading import load_checked_scene
from mimics_app.app.settings import Profile, Quality
from mimics_app.contracts.clock import Clock, MonotonicClock
from mimics_app.contracts.messages.board import Board
from mimics_app.rendering.visual.quality_steps import lower_to_scale, quality_steps
from mimics_app.rendering.visual.surfaces.contexts import create_surface
from mimics_app.rendering.visual.surfaces.surface import Surface
from mimics_app.world.content.world import World
from mimics_app.world.files.scene.file import build_world
from mimics_app.world.files.scene.scene import Scene

__all__ = ["PEOPLE", "STAND_INS", "measure_looked_at"]

PEOPLE = Path("people")
"""Stands for a scene: people on both sidewalks of the city."""

_WALK = Path("walk")
"""Stands for a scene: the city, seen by somebody who walks along a street and looks to both sides."""

STAND_INS = (_WALK, PEOPLE)
"""All of these."""

_SPEED = 1.4
"""Walking speed [m/s]."""
_STREET = 220.0
"""Length of the walk, after which it begins again [m]."""
_GAZE_ANGLE, _GAZE_PERIOD_S, _DISTANCE = math.radians(20.0), 6.0, 10.0
"""Largest angle from the direction of the walk, time from one side to it again [s], and distance looked at [m]."""

_PROFILE: Profile = "training"


@dataclass
class _LookedAt:
    """A picture that is drawn repeatedly; `move` brings its world to a time [s]."""

    move: Callable[[float], None]
    clock: Clock
    picture: Picture | None
    governor: FrameGovernor | None

    def draw(self) -> None:
        """Draw one frame."""
        assert self.picture is not None and self.governor is not None
        begun_ns = self.clock.now_ns()
        with self.picture.begin_frame().stage("world update"):
            self.move(1e-9 * begun_ns)
        done_ns = self.picture.show_frame(Board(), self.clock)
        self.governor.note(1e-6 * (done_ns - begun_ns), done_ns)


def measure_looked_at(
    file: Path, size: tuple[int, int], where: str, seconds: float, quality: Quality, scale: float
) -> Row:
    """Return a row of `mimics bench frame` without touch, sound and recorder.

    Args:
        file: The scene, or one of `STAND_INS`.
        size: Size of the picture [px].
        where: "window" or "egl".
        seconds: Length of the measurement [s].
        quality: "auto" or "full", see `RunSettings`.
        scale: Below 1: the quality is fixed, see `lower_to_scale`.
    """
    stand_ins = {PEOPLE: _crowd, _WALK: _walk}
    scene, world, move = stand_ins[file]() if file in stand_ins else _as_it_stands(load_checked_scene(file))
    with create_surface(where, size, scene.name) as surface:
        looked_at = _open(scene, world, move, surface, quality)
        if scale < 1.0 and looked_at.picture is not None:
            lower_to_scale(looked_at.picture.renderer, scale)
        watch = FrameWatch(looked_at, seconds)
        while not watch.done:
            looked_at.draw()
            watch.measure()
        return watch.row() | {"scene": file.stem, "size": list(size), "missed_share": None}


def _as_it_stands(scene: Scene) -> tuple[Scene, World, Callable[[float], None]]:
    world = build_world(scene)

    def move(time_s: float) -> None:
        world.effects.time = world.motion.time = time_s
        world.update()

    return scene, world, move


def _crowd() -> tuple[Scene, World, Callable[[float], None]]:
    """Return the hundred people of `mimics bench render people`, seen by the first camera of the city."""
    people = People(ON_SIDEWALKS, full=False)
    eye = people.world.cameras[0].node.world_matrix()[:3, 3]
    return people.scene, people.world, partial(people.walk, eye=eye)


def _walk() -> tuple[Scene, World, Callable[[float], None]]:
    """Return the city with a moving camera: every pixel is new in every frame."""
    walk = Walk()
    camera = walk.world.cameras[0].node
    start = np.array(Walk.start)

    def move(time_s: float) -> None:
        gaze = _GAZE_ANGLE * math.sin(2.0 * math.pi * time_s / _GAZE_PERIOD_S)
        place = start - (0.0, 0.0, _SPEED * time_s % _STREET)
        camera.set_position(place)
        camera.look_at(place + _DISTANCE * np.array([math.sin(gaze), 0.02, -math.cos(gaze)]))
        walk.world.update()

    return walk.scene, walk.world, move


def _open(scene: Scene, world: World, move: Callable[[float], None], surface: Surface, quality: Quality) -> _LookedAt:
    move(0.0)
    full = quality == "full"
    settings = live_quality(scene, _PROFILE, surface, full=full)
    picture = Picture(surface, scene, world, settings)
    steps = quality_steps(picture.renderer)
    fixed = [step.name for step in steps] if full else []
    governor = FrameGovernor(steps, tolerances_of(scene, _PROFILE)["frame_ms"], fixed=fixed)
    governor.stabilise(partial(measure_frame_ms, picture))
    return _LookedAt(move, MonotonicClock(), picture, governor)
