"""What the charts of the picture say: exact where it is said to be exact, and losing where something is given up."""

from __future__ import annotations

import itertools
from dataclasses import replace

import pytest

from mimics_app.lab.catalogue import load_methods
from mimics_app.lab.groups.frame_of_nodes import node_world
from mimics_app.lab.groups.frame_of_triangles import ball_world
from mimics_app.lab.visual.probe import differing_pixels, frame_us, show_picture
from mimics_app.rendering.visual.settings import RenderSettings


def errors(group):
    return {method.name: method.error() for method in load_methods([group]).rivals(group)}


def test_hiding_loses_no_pixel_of_the_city():
    assert errors("occlusion") == {"off": 0.0, "derived": 0.0, "authored": 0.0, "all": 0.0}


def test_coarser_forms_nearer_by_lose_ever_more_pixels():
    found = list(errors("level of detail").values())
    assert found[0] == 0.0
    assert all(after > before for before, after in itertools.pairwise(found))
    assert found[2] < 0.05, "as authored nobody should see it"


def test_edges_of_shadows_lie_within_a_texel_and_half_a_pixel():
    """Half a pixel is 1.25 mm, the texel of a cascade of 1.75 m is 3.4 mm; those of single maps are finer."""
    found = errors("sun shadows")
    assert found.pop("none") == pytest.approx(0.3)
    assert found.pop("cascades 2048") < 3.4e-3
    assert max(found.values()) < 1.25e-3


@pytest.mark.parametrize("group", ["frame of nodes", "frame of triangles"])
def test_small_frames_differ_only_where_coarser_forms_are_shown(group, monkeypatch):
    build = {"frame of nodes": node_world, "frame of triangles": ball_world}[group]
    world, move = build({"frame of nodes": 300, "frame of triangles": 120_000}[group])
    view = move(1)
    first, *others = (method.cost.args[1] for method in load_methods([group]).rivals(group))
    pictures = [show_picture(world, view.rectangle[2:], settings, view) for settings in (first, *others)]
    apart = [differing_pixels(pictures[0], picture) for picture in pictures[1:]]
    assert (max(apart) > 0.0) == (group == "frame of triangles")
    assert max(apart) < 0.2


def test_a_frame_has_a_cost_and_a_picture():
    world, move = node_world(50)
    settings = RenderSettings(msaa=0, shadow_size=0)
    view = move(0)
    assert frame_us(world, (64, 36), settings, move, 2) > 0.0
    seen = show_picture(world, (128, 72), settings, view)
    assert differing_pixels(seen, seen) == 0.0
    assert differing_pixels(seen, show_picture(world, (128, 72), replace(settings, exposure=0.5), view)) > 0.05
