"""Draws people for the eye: faces at 1 m and raised arms, from several sides, in the light of the avatar gallery.

Run as a script it writes one picture, of the shipped files or those of another folder:

    python -m tests.golden.people_sheet OUT.jpg [FOLDER]
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
from PIL import Image

from assets.builders.avatars.folds import BENDS
from assets.builders.avatars.person import EVERYBODY, Person
from assets.builders.avatars.skeleton import make_skeleton
from mimics_app.contracts.system.resources import root
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.view import View
from mimics_app.rendering.visual.view_matrices import compose_look_at
from mimics_app.world.content.environment import Sky
from mimics_app.world.content.motion.animator import Animator
from mimics_app.world.content.motion.pose import Pose
from mimics_app.world.content.world import World
from mimics_app.world.files.scene.model_world import read_model
from tests.golden.drawing import Picture, draw_offscreen

SHOWN = ("woman_anna", "woman_mara", "man_tom", "player_red", "therapist")
_SIZE = (270, 310)
_SETTINGS = RenderSettings(shadow_size=2048, fog_density=0.0)
_FACE_HEIGHT = 0.115
"""Distance of the middle of the face from the top of the head [m]."""


def draw_sheet(folder: Path) -> Picture:
    """Return a row for each person shown: the face from four sides, the arms at 90 and 170 degrees, [h, w, 3]."""
    return np.concatenate([_row(folder, person) for person in EVERYBODY if person.name in SHOWN])


def _row(folder: Path, person: Person) -> Picture:
    world, animator = _lit(folder / f"{person.name}.glb")
    face, chest = (
        np.array([0.0, height, 0.0]) for height in (person.body.stature - _FACE_HEIGHT, 0.86 * person.body.stature)
    )
    pictures = []
    for bend, target, away, high, sides in (
        ("", face, 1.0, 0.18, (0.0, 40.0, 90.0, 180.0)),
        ("shoulder 90", chest, 2.2, 0.22, (0.0,)),
        ("shoulder 170", chest, 2.2, 0.22, (0.0, 180.0)),
    ):
        _hold(animator, person, bend)
        world.motion.time += 0.01
        world.update()
        for degrees in sides:
            turn = math.radians(degrees)
            eye = target + away * np.array([math.sin(turn), 0.03, math.cos(turn)])
            wide = high * _SIZE[0] / _SIZE[1]
            view = View(compose_look_at(eye, target), (-wide, wide, -high, high), (0, 0, *_SIZE))
            pictures.append(draw_offscreen(world, [view], _SIZE, _SETTINGS)[..., :3])
    return np.concatenate(pictures, axis=1)


def _lit(file: Path) -> tuple[World, Animator]:
    """A world with one person in the light of scenes/avatar_gallery.json."""
    world = World()
    world.environment = Sky((0.22, 0.34, 0.55), (0.42, 0.47, 0.52), (0.3, 0.28, 0.25), 0.9)
    sun = world.root.create_child("sun", (-3.0, 6.0, 5.5))
    sun.look_at((0.0, 0.5, 0.0))
    sun.create_light("directional", colour=(1.0, 0.95, 0.86), intensity=1.35, casts_shadow=0)
    read_model(file).instantiate(world, world.root.create_child("person"))
    return world, next(iter(world.motion.animators.values()))


def _hold(animator: Animator, person: Person, bend: str) -> None:
    """Hold the first frame of the idle clip, both arms bent as one of `BENDS` says; "": as in the clip."""
    animator.reset()
    animator.play("idle", at=0.3, speed=0.0)
    if bend:
        animator.steps.append(_bent(animator, person, bend))


def _bent(animator: Animator, person: Person, bend: str) -> Callable[[Pose, float], None]:
    bones = make_skeleton(person)
    turns = {}
    for side in (1, -1):
        for joint, turn in zip(bones.names, BENDS[bend](bones, side).turns, strict=True):
            if abs(turn[3]) < 1.0 - 1e-9:
                turns[animator.rig.slot(joint)] = turn

    def step(pose: Pose, _: float) -> None:
        for slot, turn in turns.items():
            pose.rotations[slot] = turn

    return step


def main(out: Path, folder: Path) -> None:
    """Write the sheet."""
    Image.fromarray(draw_sheet(folder)).save(out, quality=78)


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]) if len(sys.argv) > 2 else root() / "assets" / "models" / "avatars")
