"""Occlusion without a driver: nothing is called hidden that a ray through some sample meets first."""

from __future__ import annotations

import numpy as np
import pytest

from mimics_app.maths.mat import compose, look_at
from mimics_app.rendering.visual.drawing.occlusion import NO_OCCLUDER, OcclusionPass, make_raster
from mimics_app.rendering.visual.kernels.occlusion import MARGIN_PX
from mimics_app.rendering.visual.view import View
from tests.support.boxes import as_items, as_occluders, first_met

CENTRE = np.array([[0.5, 0.5]])
EVERYWHERE = np.array([[0.0, 0.0], [1.0, 0.0], [0.5, 0.5], [0.0, 1.0], [1.0, 1.0]])


def drawn(world, half, view, samples=0):
    """Numbers of the boxes that stay."""
    items = as_items(half)
    picked = np.arange(len(half), dtype=np.int32)
    hide = OcclusionPass(as_occluders(half)).remove_hidden
    centres = np.ascontiguousarray(world[:, :3, 3])
    radii = np.linalg.norm(half, axis=1) * np.linalg.norm(world[:, :3, :3], axis=(1, 2))
    kept = hide(picked, len(half), view, make_raster(view, view.rectangle[2:], samples), items, world, centres, radii)
    return set(picked[:kept].tolist())


def view_of(eye, target, size, up=(0.0, 1.0, 0.0), shift=0.0, near=0.1):
    side = 0.5 * size[0] / size[1]
    return View(look_at(eye, target, up), (-side + shift, side + shift, -0.5, 0.5), (0, 0, *size), near, 500.0)


@pytest.mark.parametrize("samples", [0, 4])
@pytest.mark.parametrize("seed", range(4))
def test_no_box_is_hidden_that_shows_one_sample(seed, samples):
    """Turned, stretched and sheared boxes, some around the eye, off-axis views, pictures that blocks do not divide."""
    rng = np.random.default_rng(seed)
    size = [(64, 36), (120, 60), (171, 57), (330, 31)][seed % 4]
    count, hidden = 60, 0
    for _ in range(3):
        half = rng.uniform(0.2, 3.0, (count, 3))
        stretch = rng.uniform(0.3, 2.0, (count, 3)) * rng.choice([-1.0, 1.0], (count, 3))
        world = np.array([compose(15.0 * rng.normal(size=3), rng.normal(size=4), stretch[k]) for k in range(count)])
        world[::5] = compose(np.zeros(3), rng.normal(size=4), (1.0, 2.0, 0.5)) @ world[::5]
        view = view_of(12.0 * rng.normal(size=3), rng.normal(size=3), size, rng.normal(size=3), 0.3 * rng.normal())
        kept = drawn(world, half, view, samples)
        seen = set(np.unique(first_met(world, half, view, EVERYWHERE if samples else CENTRE)).tolist()) - {-1}
        assert seen <= kept, f"hidden though seen: {sorted(seen - kept)}"
        hidden += count - len(kept)
    assert hidden > 0, "a test in which nothing is hidden shows nothing"


@pytest.mark.parametrize("turned", [False, True])
def test_a_box_behind_a_wall_appears_with_its_first_sample(turned):
    """Moved out past each edge by tenths of a pixel. Upright edges are the hull's ties in x."""
    size = (96, 54)
    turn = (0.0, 0.0, 0.05, 1.0) if turned else (0.0, 0.0, 0.0, 1.0)
    half = np.array([[2.0, 1.5, 0.1], [0.3, 0.3, 0.3]])
    view = view_of((0.0, 0.0, 10.0), (0.0, 0.0, 0.0), size)
    pixel = 12.0 / size[1]
    for direction in ((1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)):
        edge = (2.0 if direction[0] else 1.5) * 12.0 / 9.9 - 0.3
        found = []
        for step in np.arange(-3.0, 3.0, 0.1):
            place = np.array([*direction, 0.0]) * (edge + step * pixel) + [0.0, 0.0, -2.0]
            world = np.array([compose(np.zeros(3), turn), compose(place)])
            hidden = 1 not in drawn(world, half, view)
            shown = bool((first_met(world, half, view, CENTRE) == 1).any())
            assert not (hidden and shown), f"{direction} {step}"
            found.append(hidden)
        assert found[0] and not found[-1], "hidden well inside, drawn well outside"


def test_a_wall_beside_the_eye_hides_what_is_behind_it():
    """It reaches behind the eye, where a naive projection turns inside out."""
    half = np.array([[0.5, 10.0, 50.0], [1.0, 1.0, 1.0], [1.0, 1.0, 1.0]])
    world = np.array([compose((2.0, 0.0, 0.0)), compose((20.0, 0.0, -30.0)), compose((-1.5, 0.0, -30.0))])
    view = view_of((0.0, 0.0, 0.0), (0.2, 0.0, -1.0), (160, 90))
    assert drawn(world, half, view) == {0, 2}


def test_a_wall_the_near_plane_cuts_hides_nothing():
    """Its front face is cut away, so that one looks into it and through it."""
    half = np.array([[5.0, 5.0, 0.02], [1.0, 1.0, 1.0]])
    view = view_of((0.0, 0.0, 0.0), (0.0, 0.0, -1.0), (160, 90), near=0.1)
    for distance, kept in ((0.09, {0, 1}), (0.5, {0})):
        world = np.array([compose((0.0, 0.0, -distance)), compose((0.0, 0.0, -30.0))])
        assert drawn(world, half, view) == kept


def test_from_inside_a_body_nothing_is_hidden_by_it():
    half = np.array([[50.0, 50.0, 50.0], [1.0, 1.0, 1.0]])
    world = np.array([compose(np.zeros(3)), compose((0.0, 0.0, -100.0))])
    assert drawn(world, half, view_of((0.0, 0.0, 0.0), (0.0, 0.0, -1.0), (160, 90))) == {0, 1}


@pytest.mark.parametrize(("gap", "hidden"), [(0.0, False), (0.05, False), (5.0, True)])
def test_what_a_depth_buffer_cannot_say_apart_stays(gap, hidden):
    """At 100 m and a near plane of 0.1 m a step of 24 bits is 6 mm, and 64 of them 0.4 m."""
    half = np.array([[20.0, 20.0, 0.1], [1.0, 1.0, 0.1]])
    world = np.array([compose((0.0, 0.0, -100.0)), compose((0.0, 0.0, -100.2 - gap))])
    kept = drawn(world, half, view_of((0.0, 0.0, 0.0), (0.0, 0.0, -1.0), (160, 90)))
    assert (1 not in kept) == hidden


def _covered(edge_px, width=960):
    """Blocks of 3 px in the middle row that a wall hides whose right edge is drawn at a place [px]."""
    view = view_of((0.0, 0.0, 10.0), (0.0, 0.0, 0.0), (width, 540))
    metre = 540.0 / 10.0  # pixels to a metre at the wall, 10 m away
    half = np.array([[1.0, 1.0, 1e-6], [0.1, 0.1, 0.1]])
    shift = (edge_px - 0.5 * width) / metre - 1.0
    world = np.array([compose((shift, 0.0, 1e-6)), compose((0.0, 0.0, -50.0))])
    hide = OcclusionPass(as_occluders(half))
    hide.remove_hidden(
        np.arange(2, dtype=np.int32), 2, view, make_raster(view, view.rectangle[2:], 0), as_items(half), world,
        np.ascontiguousarray(world[:, :3, 3]), np.linalg.norm(half, axis=1),
    )  # fmt: skip
    return np.flatnonzero(hide.nearness[90] > 0.0)


@pytest.mark.parametrize("column", [150, 168])
def test_the_outline_of_what_hides_is_exact_to_a_thousandth_of_a_pixel(column):
    """A block counts once the outline has passed its last sample by the margin, and not before.

    One percent more outline is half a pixel on this wall of 108: it would eat the whole margin.
    """
    block, last_sample = 3, 2.5
    border = column * block + last_sample + MARGIN_PX
    assert column not in _covered(border - 1e-3)
    assert column in _covered(border + 1e-3)


def test_the_outline_does_not_grow_with_the_wall():
    """The other edge, and walls of every size: where they end is where they are drawn to end."""
    for edge in np.linspace(440.0, 540.0, 67):
        covered = _covered(edge)
        assert covered[-1] == np.floor((edge - MARGIN_PX - 2.5) / 3.0)
        first = edge - 2.0 * 54.0
        assert covered[0] == np.ceil((first + MARGIN_PX - 0.5) / 3.0)


@pytest.mark.parametrize(("half_px", "worth"), [(4.0, False), (4.5, True)])
def test_a_box_of_less_than_two_blocks_is_not_drawn_as_an_occluder(half_px, worth):
    """Half its diagonal, of 5.7 or 6.4 px, against two blocks of 3 px; then nothing is tested, and nothing removed."""
    view = view_of((0.0, 0.0, 10.0), (0.0, 0.0, 0.0), (960, 540))
    metre = 54.0
    half = np.array([[half_px / metre, half_px / metre, 1e-6], [1e-3, 1e-3, 1e-3]])
    world = np.array([compose((0.0, 0.0, 0.0)), compose((0.0, 0.0, -5.0))])
    hide = OcclusionPass(as_occluders(half))
    kept = hide.remove_hidden(
        np.arange(2, dtype=np.int32), 2, view, make_raster(view, view.rectangle[2:], 0), as_items(half), world,
        np.ascontiguousarray(world[:, :3, 3]), np.linalg.norm(half, axis=1),
    )  # fmt: skip
    assert (hide.nearness is not NO_OCCLUDER) == worth
    assert kept == (1 if worth else 2)
