"""Coarser forms of people: fewer triangles and vertices, near the surface, of the same skin; a crowd shows them."""

from __future__ import annotations

import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from assets.builders.avatars.detail import LEVELS, coarser, coverages
from assets.builders.avatars.person import EVERYBODY
from assets.builders.avatars.whole_person import Figure, make_figure
from mimics_app.app.bench.people_workload import People
from mimics_app.app.bench.render_bench import RenderBench, measure_render
from mimics_app.contracts.system.resources import root
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.world.files.gltf.file import load_gltf
from tests.golden.drawing import draw_offscreen

AVATARS = root() / "assets" / "models" / "avatars"


@pytest.fixture(scope="module")
def figure() -> Figure:
    return make_figure(EVERYBODY[3], 1)


def test_parts_become_coarser_and_stay_near(figure: Figure) -> None:
    body = figure.pieces["skin"]
    before, errors = len(body.triangles), []
    for level in LEVELS:
        piece, error = coarser(body, level)
        assert len(piece.triangles) < 0.6 * before and piece.triangles.max() == len(piece.places) - 1
        assert np.allclose(piece.weights.sum(axis=1), 1.0)
        assert (piece.weights > 0.0).sum(axis=1).max() <= level.influences
        before = len(piece.triangles)
        errors.append(error)
    assert errors == sorted(errors) and errors[0] < 0.01
    shares = coverages([body], errors)
    assert shares == sorted(shares, reverse=True) and shares[-1] == 0.0 and len(shares) == len(LEVELS) + 1


def test_levels_do_not_depend_on_the_last_digits_of_places(figure: Figure) -> None:
    """These differ between processors: left and right lose equally much, so any digit decided which edge went first."""
    hair = figure.pieces["hair"]
    other = replace(hair, places=hair.places + np.random.default_rng(1).uniform(-1e-15, 1e-15, hair.places.shape))
    for level in LEVELS:
        assert np.array_equal(coarser(hair, level)[0].triangles, coarser(other, level)[0].triangles)


@pytest.mark.parametrize("name", ["woman_anna", "player_red"])
def test_shipped_people_have_levels_on_the_same_skin(name: str) -> None:
    model = load_gltf(AVATARS / f"{name}.glb", without_pictures=True)
    levelled = [node for node in model.nodes if node.levels]
    assert len(levelled) == 3
    for node in levelled:
        counts = [
            sum(len(part.mesh.positions) for part in model.meshes[each.mesh].primitives)
            for each in (node, *(model.nodes[level] for level in node.levels))
            if each.mesh is not None
        ]
        assert counts == sorted(counts, reverse=True) and counts[-1] < 0.2 * counts[0]
        assert {model.nodes[level].skin for level in node.levels} == {node.skin}


@pytest.mark.slow
def test_a_crowd_in_levels_looks_as_one_in_full_and_is_drawn_with_a_third_of_the_triangles() -> None:
    """Of the pixels 1 % at most differ by more than 8 of 255."""
    pictures = []
    for full in (False, True):
        crowd = People(30, full)
        crowd.update(3)
        settings = RenderSettings(msaa=0, shadow_size=0)
        pictures.append(draw_offscreen(crowd.world, [crowd.view(3, (640, 360))], (640, 360), settings))
    differs = np.abs(pictures[0].astype(int) - pictures[1]).max(axis=-1) > 8
    assert 0.0 < differs.mean() <= 0.01


def test_a_crowd_is_measured_beside_itself_standing_still(tmp_path: Path) -> None:
    """The peers' workload by a person of ours; what it costs is not asked, only that all of it was done."""
    shutil.copytree(AVATARS, tmp_path / "data")
    (tmp_path / "data" / "woman_anna.glb").rename(tmp_path / "data" / "character.glb")
    found = measure_render(RenderBench("crowd", tmp_path / "data", (64, 36), frames=5, warmup=1, count=2))
    assert found["nodes"] == 2 and found["frames"] == 5
    assert min(found[key] for key in ("ns_vertex", "ns_vertex_still", "times_still")) > 0.0
