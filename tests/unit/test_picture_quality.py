"""What a scene says of its picture, and what the renderer is given."""

from __future__ import annotations

import pytest

from mimics_app.app.picture.picture import picture_quality
from mimics_app.app.planner.explain import explain_plan
from mimics_app.app.planner.plan import plan_scene
from mimics_app.world.files.scene.file import load_scene
from tests.support.scenes import faults, scene, thing, write


def of(folder, profile="training", **visual):
    document = scene(thing("eye", camera={}), systems={"visual": visual})
    return picture_quality(load_scene(write(folder, document)), profile)


@pytest.mark.parametrize(
    ("choice", "samples", "msaa", "fxaa"),
    [("samples", 8, 8, False), ("filter", 8, 0, True), ("both", 2, 2, True), ("none", 4, 0, False)],
)
def test_smooth_edges_are_made_as_the_scene_chooses(tmp_path, choice, samples, msaa, fxaa):
    quality = of(tmp_path, anti_aliasing=choice, samples=samples)
    assert (quality.msaa, quality.fxaa) == (msaa, fxaa)


def test_without_a_word_the_picture_has_samples_and_no_filter(tmp_path):
    quality = of(tmp_path)
    assert (quality.msaa, quality.fxaa, quality.bloom, quality.ambient_occlusion) == (4, False, 0.0, 0.0)


def test_a_draft_goes_without_effects_and_keeps_the_edges_a_scene_states(tmp_path):
    wanted = {"anti_aliasing": "both", "bloom": 0.2, "ambient_occlusion": 1.0, "ambient_radius": 0.7}
    full, draft = of(tmp_path, **wanted), of(tmp_path, "draft", **wanted)
    assert (full.bloom, full.ambient_occlusion, full.ambient_radius) == (0.2, 1.0, 0.7)
    assert (draft.msaa, draft.fxaa, draft.bloom, draft.ambient_occlusion) == (4, True, 0.0, 0.0)


def test_exposure_and_tone_map_are_the_scene_s_in_every_profile(tmp_path):
    for profile in ("draft", "training", "study"):
        quality = of(tmp_path, profile, exposure=2.5, tone_map="none")
        assert (quality.exposure, quality.tone_map) == (2.5, "none")


@pytest.mark.parametrize(
    ("name", "value", "says"),
    [("anti_aliasing", "smaa", "samples"), ("bloom", 1.5, "<= 1"), ("ambient_radius", 0, "> 0")],
)
def test_what_cannot_be_is_refused(tmp_path, name, value, says):
    found = faults(write(tmp_path, scene(systems={"visual": {name: value}})))
    assert len(found) == 1
    assert f"systems/visual/{name}" in found[0] and says in found[0]


def test_explain_lists_what_the_picture_goes_without(tmp_path):
    def left_out(document):
        loaded = load_scene(write(tmp_path, document))
        return {left["part"] for left in explain_plan(loaded, plan_scene(loaded, "training"))["left_out"]}

    parts = {
        "bloom, per frame",
        "ambient occlusion, per frame",
        "filter of edges, per frame",
        "pictures over the display",
    }
    assert parts <= left_out(scene(thing("eye", camera={})))
    visual = {"bloom": 0.1, "ambient_occlusion": 1.0, "anti_aliasing": "filter"}
    full = scene(thing("eye", camera={}), thing("rear", inset={"camera": "eye"}), systems={"visual": visual})
    assert not parts & left_out(full)
