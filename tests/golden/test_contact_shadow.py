"""What the governor never takes: shadows under the hand, without which nobody sees where it is, and under people."""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np
import pytest

from mimics_app.app.picture.contact_shadow import ContactShadow
from mimics_app.app.picture.held_quality import measure_frame_ms
from mimics_app.app.picture.nudges import hand_of, nudges_of
from mimics_app.app.picture.picture import Picture, live_quality
from mimics_app.app.scenes.shipped import find_shipped
from mimics_app.contracts.arrays import U1
from mimics_app.contracts.clock import VirtualClock
from mimics_app.contracts.messages.board import Board
from mimics_app.rendering.visual.quality_steps import quality_steps
from mimics_app.rendering.visual.surfaces.contexts import create_surface
from mimics_app.rendering.visual.surfaces.headless import read_pixels
from mimics_app.world.files.scene.file import build_world, load_scene

SCENES = ("wavy_tunnel", "pick_and_place", "tower")
SIZE = (480, 270)


@contextmanager
def playing(name: str, *, kept: bool) -> Iterator[Picture]:
    shipped = find_shipped(name)
    assert shipped is not None
    scene = load_scene(shipped.file)
    world = build_world(scene)
    world.update()
    with create_surface("egl", SIZE) as surface:
        picture = Picture(surface, scene, world, live_quality(scene, "training", surface, full=True))
        if kept:
            picture.keep_contact_shadow(scene)
        picture.hand = hand_of(scene, world)
        picture.hand.set_position((-0.08, 0.35, 0.06))
        world.update()
        yield picture
        picture.renderer.release()


def take_everything(picture: Picture) -> None:
    for step in quality_steps(picture.renderer):
        if step.name != "resolution scale":  # the same pixels are compared
            step.apply(len(step.levels) - 1)


def seen(picture: Picture) -> U1:
    """The picture of the second of two frames: the shadow follows what the world showed last."""
    for _ in range(2):
        picture.show_frame(Board(), VirtualClock())
        picture.renderer.world.update()
    picture.show_frame(Board(), VirtualClock())
    return read_pixels(picture.surface)[..., :3].astype(int)


@pytest.mark.parametrize("name", SCENES)
def test_a_shadow_stays_under_the_hand_when_everything_else_is_given_up(name: str) -> None:
    pictures = {}
    for kept in (True, False):
        with playing(name, kept=kept) as picture:
            full = seen(picture)
            take_everything(picture)
            pictures[kept] = full, seen(picture)
            view = picture.views[0]
            hand = np.append(picture.hand.world_matrix()[:3, 3], 1.0)
    assert np.array_equal(pictures[True][0], pictures[False][0]), "with shadows it is not drawn"
    darker = (pictures[False][1] - pictures[True][1]).max(axis=-1) > 12
    assert ((pictures[True][1] - pictures[False][1]) <= 1).all(), "it only darkens"
    clip = view.clip_from_world @ hand
    across, height = 0.5 * (clip[0] / clip[3] + 1.0) * SIZE[0], 0.5 * (1.0 - clip[1] / clip[3]) * SIZE[1]
    rows, columns = np.nonzero(darker)
    rows = rows[abs(columns - across) < 0.12 * SIZE[0]]  # people have theirs elsewhere
    assert rows.size > 30 and np.median(rows) > height, "seen below the hand"


def test_it_follows_the_hand() -> None:
    with playing("tower", kept=True) as picture:
        take_everything(picture)
        before = seen(picture)
        place = np.array(picture.hand.position)
        picture.hand.set_position(place + [0.08, 0.0, 0.0])
        picture.renderer.world.update()
        after = seen(picture)
    darker, lighter = ((after - before).max(axis=-1) < -12), ((after - before).min(axis=-1) > 12)
    assert darker.any() and lighter.any()
    assert np.nonzero(darker)[1].mean() > np.nonzero(lighter)[1].mean() + 5


def test_people_near_the_eye_have_one_below_their_soles_that_turns_with_them() -> None:
    """Without it their feet float once the governor has taken the shadow maps; far away nobody sees that."""
    shipped = find_shipped("canyon_walk")
    assert shipped is not None
    scene = load_scene(shipped.file)
    world = build_world(scene)
    shadow, person = ContactShadow(scene, world), world.find("own_body")
    world.update()
    shadow.follow(np.zeros(3))
    world.update()
    spots = [world.node(index) for index in world.effects.contact_shadows]
    spot = min(spots, key=lambda node: math.dist(node.world_matrix()[[0, 2], 3], person.world_matrix()[[0, 2], 3]))
    for place, eye, seen in (((0.4, 0.2, -3.0), (0.0, 2.0, 0.0), True), ((0.4, 0.2, -60.0), (0.0, 2.0, 0.0), False)):
        world.find("person").set_position(place)
        world.find("person").set_orientation((0.0, math.sin(0.3), 0.0, math.cos(0.3)))
        world.update()
        shadow.follow(np.array(eye))
        world.update()
        assert spot.visible is seen
        matrix = spot.world_matrix()
        np.testing.assert_allclose(matrix[[0, 2], 3], np.array(place)[[0, 2]])
        depth = world.effects.projectors[spot.index].depth
        assert place[1] < matrix[1, 3] + 0.5 * depth < place[1] + 0.05 and depth > 0.1, "it begins just over the soles"
        np.testing.assert_allclose(matrix[:3, 2], (0.0, 1.0, 0.0), atol=1e-9, err_msg="it looks down")
        np.testing.assert_allclose(np.abs(matrix[:3, 1] @ person.world_matrix()[:3, 2]), 1.0, atol=1e-9)
    shadow.follow(np.array((0.4, 2.0, -59.0)))
    assert spot.visible
    world.find("person").visible = False
    shadow.follow(np.array((0.4, 2.0, -59.0)))
    assert not spot.visible, "nobody is seen there"


def test_a_level_is_chosen_by_frames_in_which_the_hand_moves_and_the_room_stays() -> None:
    """Its moving shadow is drawn in them, and the picture is never forgotten; whole frames are of something at rest."""
    with playing("tower", kept=True) as picture:
        renderer, forgotten, drawn = picture.renderer, list[int](), list[int]()
        draw, forget = renderer.draw_finished, renderer.forget_picture
        renderer.draw_finished = lambda views: drawn.append((stats := draw(views)).triangles) or stats
        renderer.forget_picture = lambda: forgotten.append(len(drawn)) or forget()
        nudge = nudges_of(load_scene(find_shipped("tower").file), renderer.world)
        place = np.array(picture.hand.position)
        measure_frame_ms(picture, nudge)
        assert forgotten == [0] and min(drawn[2:]) > 0
        np.testing.assert_array_equal(picture.hand.position, place)
        moved, drawn[:] = drawn[-1], []
        measure_frame_ms(picture)
        assert forgotten[-4:] == [0, 1, 2, 3] and drawn[-1] < moved
