"""Levels of detail of a crowd: fewer triangles and joints, and larger time steps.

Probe: forty of the shipped people who walk at distances of 4 to 60 m. Error: share of the pixels that differ by more
than 8 of 255 from all people in full detail in every frame.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from itertools import cycle
from pathlib import Path

import numpy as np

from mimics_app.contracts.system.resources import root
from mimics_app.lab.rivals import Probes, Rival, compare
from mimics_app.lab.visual.probe import differing_pixels, frame_us, show_picture
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.view import View
from mimics_app.rendering.visual.view_matrices import compose_look_at
from mimics_app.world.content.environment import Sky
from mimics_app.world.content.world import World
from mimics_app.world.files.gltf.file import load_gltf
from mimics_app.world.files.scene.assets import ModelPart, SceneAsset
from mimics_app.world.files.scene.prefab import ModelPrefab

__all__ = ["Crowd", "load_person"]


_PEOPLE, _NEAREST, _FARTHEST = 40, 4.0, 60.0
_KINDS = ("man_omar", "player_white", "woman_anna")
_CLIP, _RATE = "walk", 30.0
_SIZE, _SIDE, _UP = (640, 360), 0.89, 0.5
_EYE = (0.0, 1.6, 0.0)
_FRAMES = 8
_LEVEL = 8
"""Smallest difference that counts [of 255]: smaller ones are not visible in motion."""
_PLAIN = RenderSettings(msaa=0, shadow_size=0, tone_map="none", fog_density=0.0)


def load_person(path: Path, *, full: bool) -> ModelPrefab:
    """Return one of the shipped people; `full`: without coarser levels."""
    model = load_gltf(path)
    if full:
        for node in model.nodes:
            node.levels, node.coverages = [], []
    asset = SceneAsset(path.stem, "model", path, model=model, files=tuple(model.files))
    return ModelPrefab(ModelPart(asset, model, tuple(model.roots)))


@cache
def _prefabs(*, full: bool) -> list[ModelPrefab]:
    folder = root() / "assets" / "models" / "avatars"
    return [load_person(folder / f"{kind}.glb", full=full) for kind in _KINDS]


@dataclass(frozen=True)
class Crowd:
    """Method to draw a crowd.

    Attributes:
        levels: Coarser levels at a distance.
        steps: Larger time steps at a distance.
        detail: As in `RenderSettings`.
    """

    levels: bool = True
    steps: bool = True
    detail: float = 1.0

    @property
    def settings(self) -> RenderSettings:
        """Settings of the renderer."""
        return replace(_PLAIN, detail=self.detail)

    def start(self) -> tuple[World, Callable[[int], View]]:
        """Return a new crowd, and a function that advances it by a frame and returns the view."""
        world = _plain()
        rng = np.random.default_rng(3)
        for number, prefab in zip(range(_PEOPLE), cycle(_prefabs(full=not self.levels)), strict=False):
            away = _NEAREST * (_FARTHEST / _NEAREST) ** (number / (_PEOPLE - 1))
            place = np.array([rng.uniform(-0.6, 0.6) * away, 0.0, -away])
            turn = 0.5 * rng.uniform(-math.pi, math.pi)
            person = world.root.create_child(f"person {number}", place, (0.0, math.sin(turn), 0.0, math.cos(turn)))
            prefab.instantiate(world, person)
            animator = world.motion.animators[person.index]
            animator.play(_CLIP, at=float(rng.uniform(0.0, animator.clips[_CLIP].duration)))
        eye = np.array(_EYE)
        view = View(compose_look_at(eye, eye - (0, 0, 1.0)), (-_SIDE, _SIDE, -_UP, _UP), (0, 0, *_SIZE), 0.5, 200.0)

        def step(frame: int) -> View:
            world.motion.time += 1.0 / _RATE
            world.motion.eye_world = eye if self.steps else None
            world.update()
            return view

        return world, step


def _plain() -> World:
    world = World()
    world.environment = Sky((0.5,) * 3, (0.6,) * 3, (0.35,) * 3, 0.5)
    sun = world.root.create_child("sun", (40.0, 90.0, 60.0))
    sun.look_at((0.0, 0.0, 0.0))
    sun.create_light("directional", intensity=1.0, casts_shadow=0)
    return world


def _cost_us(crowd: Crowd) -> float:
    world, step = crowd.start()
    return frame_us(world, _SIZE, crowd.settings, step, _FRAMES)


def _crowd_error(crowd: Crowd, whole: Crowd) -> float:
    """Return the share of the pixels that differ between two methods, the mean of some frames."""
    pictures = []
    for variant in (crowd, whole):
        world, step = variant.start()
        shown = []
        for frame in range(_FRAMES):
            view = step(frame)
            if frame % 3 == 1:
                shown.append(show_picture(world, _SIZE, variant.settings, view))
        pictures.append(shown)
    shares = [differing_pixels(one, other, level=_LEVEL) for one, other in zip(pictures[0], pictures[1], strict=True)]
    return float(np.mean(shares))


_WHOLE = Crowd(levels=False, steps=False)


_VALID = "people from 4 m away on"
compare(
    __name__,
    "a frame of forty people 4 to 60 m away; error: share of pixels that differ from all in full",
    "share of pixels",
    [
        Rival("in full", "9,900 triangles, four joints a vertex, every frame", _VALID, None, (_WHOLE,)),
        Rival(
            "steps of time",
            "from 12 m on moved every 1/30, 1/15, 1/8 s",
            _VALID,
            probed=(replace(_WHOLE, steps=True),),
        ),
        Rival(
            "coarser forms",
            "42, 13, 4.5 % of the triangles; 4, 2, 1 joints a vertex",
            _VALID,
            probed=(Crowd(steps=False),),
        ),
        Rival("both", "coarser forms by two pixels of 1080 rows, and steps of time", _VALID, {}, (Crowd(),)),
        Rival("both, 2 times as far", "the same from twice the distance on", _VALID, None, (Crowd(detail=2.0),)),
        Rival("both, 0.5 times as far", "the same from half the distance on", _VALID, None, (Crowd(detail=0.5),)),
    ],
    Probes(_cost_us, lambda crowd: _crowd_error(crowd, _WHOLE)),
    default="both",
)
