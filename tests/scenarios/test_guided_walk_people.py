"""The people of the guided walk: they go as people go, do what the task says, and their steps are heard."""

from __future__ import annotations

import math

import numpy as np
import pytest

import mimics_app as mimics
from mimics_app.app.scenes.loading import load_checked_scene
from mimics_app.contracts.system.resources import root
from mimics_app.scenarios.figures.alley_figure import AlleyFigure
from mimics_app.world.content.world import World
from mimics_app.world.files.scene.file import build_world

WALK = root() / "scenes" / "guided_walk.json"
FRAME = 1.0 / 60.0


@pytest.mark.parametrize(
    ("deed", "shown", "step_heard"), [(4, "beckon", False), (5, "point", True), (0, "still", True)]
)
def test_the_avatar_does_what_the_task_says(deed: int, shown: str, step_heard: bool) -> None:
    """Who points turns to the place, and steps as they turn."""
    seen, steps = set(), []
    with mimics.open(WALK, record=False) as session:
        session.command(mimics.Policy("off"))
        session.set(deed=deed)
        world = session.world
        avatar = world.find("avatar").index
        for _ in range(60 * 8):
            session.step()
            seen.add(world.motion.machines[avatar].state)
            for index, event in world.motion.happened:
                if index == avatar:
                    assert event.kind == "step"
                    steps.append(float(world.find(f"avatar/{event.node}").world_matrix()[1, 3]))
    assert {"still", "greet", shown} <= seen
    assert {"beckon", "point"} & seen == {shown} - {"still"}
    assert bool(steps) is step_heard
    # The ankle of a foot that comes down is as far above the ground as that of a foot that stands, a heel's tilt apart.
    assert all(0.04 < height < 0.16 for height in steps)


def test_success_is_cheered_and_then_greeted() -> None:
    world = build_world(load_checked_scene(WALK))
    machine = world.motion.machines[world.find("avatar").index]
    world.motion.trigger("goal")
    assert machine.state == "cheer"
    shown = []
    for _ in range(60 * 6):
        play(world)
        shown.append(machine.state)
    assert list(dict.fromkeys(shown)) == ["cheer", "greet", "still"]


def test_feet_do_not_slide() -> None:
    """While the avatar sets out, walks and stops, one of heels and toes keeps its place to a hundredth of the way."""
    world, avatar, person = alley()
    avatar.put(-2.5)
    person.put(4.0)
    avatar.face(person)
    joints = [world.find(f"avatar/{side}{part}") for side in ("left", "right") for part in ("Foot", "Toes")]
    places = []
    for _ in range(60 * 3):
        avatar.go((2.0, 0.0), person, FRAME)
        avatar.show("still")
        play(world)
        places.append([joint.world_matrix()[[0, 2], 3] for joint in joints])
    moved = np.linalg.norm(np.diff(np.array(places), axis=0), axis=2)
    way = avatar.along + 2.5
    assert way > 3.0
    # Of a figure that glides it is all. Ankle and joint of the toes are above the sole, and roll over it.
    assert moved.min(axis=1).sum() < 0.06 * way


@pytest.mark.parametrize("place", [(1.3, 0.0), (1.1, 0.6), (0.0, -1.0), (-0.5, 0.9), (-0.4, 0.0)])
@pytest.mark.parametrize("begins", [(-0.5, 0.0), (0.6, 0.7), (0.2, -0.9)])
def test_the_avatar_walks_round_the_person_and_turns_to_them(
    begins: tuple[float, float], place: tuple[float, float]
) -> None:
    world, avatar, person = alley()
    avatar.put(*begins)
    person.put(0.0)
    avatar.face(person)
    nearest = math.inf
    for _ in range(60 * 5):
        avatar.go(place, person, FRAME)
        nearest = min(nearest, math.hypot(avatar.along - person.along, avatar.aside - person.aside))
    x, _, z = world.find("avatar").world_matrix()[:3, 2]
    assert nearest > 0.3  # two half breadths of bodies, side by side
    assert (avatar.along, avatar.aside) == pytest.approx(place, abs=0.02)
    looks = np.array([-avatar.aside, avatar.along]) / math.hypot(*place)
    assert (x, z) == pytest.approx(looks, abs=0.05)


def test_who_is_too_near_steps_back_and_keeps_looking() -> None:
    world, avatar, person = alley()
    avatar.put(1.0)
    person.put(0.0)
    avatar.face(person)
    feet = [world.find(f"avatar/{side}Foot") for side in ("left", "right")]
    heights = []
    for _ in range(60 * 3):
        avatar.go((1.6, 0.0), person, FRAME)
        avatar.show("still")
        play(world)
        heights.append([foot.world_matrix()[1, 3] for foot in feet])
    assert (np.array(heights).max(axis=0) > 0.09).all()  # both were lifted
    assert world.find("avatar").world_matrix()[2, 2] == pytest.approx(1.0)
    assert all(abs(foot.world_matrix()[2, 3] + 1.6) < 0.1 for foot in feet)  # and are under the avatar again


def alley() -> tuple[World, AlleyFigure, AlleyFigure]:
    """The scene's world, its avatar and its person."""
    world = build_world(load_checked_scene(WALK))
    return world, AlleyFigure(world, world.find("avatar"), 1.0), AlleyFigure(world, world.find("person"), -1.0)


def play(world: World) -> None:
    """A frame goes by."""
    world.motion.time += FRAME
    world.update()
