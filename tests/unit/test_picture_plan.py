"""The planner chooses the picture's methods: by error for stills, within half a frame's time for a live picture."""

from __future__ import annotations

import json
from dataclasses import replace

import pytest

from mimics_app.app.picture.methods import with_methods
from mimics_app.app.picture.picture import live_quality, picture_quality
from mimics_app.app.planner.explain import explain_plan
from mimics_app.app.planner.plan import ROOM, plan_scene
from mimics_app.app.planner.uses import USES
from mimics_app.contracts.ports.method_table import Row, Table
from mimics_app.lab.catalogue import load_methods
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.world.files.scene.file import load_scene
from tests.support.scenes import scene, thing, write

PIXELS = 640 * 360
"""As many as the table's pictures have: a cost of 1000 us is a millisecond of the frame."""

ROOM_MS = ROOM * 17.0


def row(group: str, method: str, cost_ms: float, error: float) -> Row:
    unit = {
        "anti aliasing": "px",
        "sun shadows": "m of a shadow's edge",
        "bloom": "of the effect",
        "ambient occlusion": "of the effect",
        "occlusion": "share of pixels",
        "level of detail": "share of pixels",
    }[group]
    return Row(method, 1e3 * cost_ms, cost_ms, error, unit, SETTINGS[group][method])


def maps(size: int) -> dict[str, object]:
    return {"cascaded": False, "shadow_size": size}


SETTINGS: dict[str, dict[str, dict[str, object]]] = {
    "anti aliasing": {
        "none": {"msaa": 0, "fxaa": False},
        "filter": {"msaa": 0, "fxaa": True},
        "4 samples": {"msaa": 4, "fxaa": False},
        "4 samples, filter": {"msaa": 4, "fxaa": True},
    },
    "sun shadows": {
        "map 256": maps(256),
        "map 512": maps(512),
        "map 1024": maps(1024),
        "cascades 2048": {"cascaded": True, "shadow_size": 2048},
        "stencil additive": {"shadows": "stencil_additive"},
        "stencil modulative": {"shadows": "stencil_modulative"},
    },
    "ambient occlusion": {"none": {"ambient_occlusion": 0.0}, "eight places": {}},
    "bloom": {"none": {"bloom": 0.0}, "six copies": {}},
    "occlusion": {"off": {"occlusion": "off"}, "all": {"occlusion": "all"}},
    "level of detail": {
        "2 times as far": {"detail": 2.0},
        "as authored": {"detail": 1.0},
        "0.5 times as far": {"detail": 0.5},
    },
}

FIGURES = {
    "anti aliasing": [("none", 5, 0.3), ("filter", 8, 0.14), ("4 samples", 15, 0.08), ("4 samples, filter", 17, 0.09)],
    "sun shadows": [
        ("map 256", 6, 5e-4),
        ("map 512", 8, 1.5e-4),
        ("map 1024", 12, 5e-5),
        ("cascades 2048", 9, 6e-4),
        ("stencil additive", 30, 1e-6),
        ("stencil modulative", 10, 1e-6),
    ],
    "ambient occlusion": [("none", 5, 1.0), ("eight places", 7, 0.02)],
    "bloom": [("none", 5, 1.0), ("six copies", 7, 0.01)],
    "occlusion": [("off", 20, 0.0), ("all", 11, 0.0)],
    "level of detail": [("2 times as far", 12, 0.004), ("as authored", 10, 0.02), ("0.5 times as far", 9, 0.09)],
}


def planted(**changed) -> Table:
    figures = {**FIGURES, **{name.replace("_", " "): rows for name, rows in changed.items()}}
    return Table({group: [row(group, *one) for one in rows] for group, rows in figures.items()}, {}, {})


SUN = thing("sun", light={"kind": "directional", "casts_shadow": True})
EYE = thing("eye", camera={})


@pytest.fixture
def of(tmp_path):
    """A scene of a camera and a sun with this `visual`, and these tolerances."""

    def load(tolerances=None, *, things=(EYE, SUN), **visual):
        systems = {"visual": visual, "tolerances": tolerances or {}}
        return load_scene(write(tmp_path, scene(*things, systems=systems)))

    return load


def methods(loaded, profile="training", pixels=0, table=None):
    return plan_scene(loaded, profile, table or planted(), pixels).methods


def test_a_still_takes_the_cheapest_within_the_tolerance_whatever_a_frame_would_take(of):
    assert methods(of()) == {"sun shadows": "map 512", "anti aliasing": "4 samples"}


def test_a_tighter_tolerance_moves_its_own_method_alone(of):
    assert methods(of({"shadow_m": 1e-4})) == {"sun shadows": "map 1024", "anti aliasing": "4 samples"}
    assert methods(of({"shadow_m": 1e-5})) == {"sun shadows": "stencil additive", "anti aliasing": "4 samples"}
    assert methods(of({"edge_px": 0.3})) == {"sun shadows": "map 512", "anti aliasing": "none"}


def test_the_filter_is_the_full_quality_only_of_live_software_rendering(of):
    """Within a tolerance of 0.2 px it is cheaper than samples; stills and cards take samples, for thin objects."""
    wider = of({"edge_px": 0.2})
    assert methods(wider)["anti aliasing"] == "4 samples"
    for loaded, taken in ((wider, "filter"), (of(), "4 samples")):
        full = plan_scene(loaded, "training", planted(), PIXELS, limited=False)
        assert full.methods == {"sun shadows": "map 512", "anti aliasing": taken}


def test_a_draft_takes_what_is_cheapest(of):
    wanted = of(bloom=0.2, ambient_occlusion=1.0)
    cheapest = {"sun shadows": "map 256", "anti aliasing": "none", "ambient occlusion": "none", "bloom": "none"}
    assert methods(wanted, "draft") == cheapest


def test_what_a_frame_does_not_bear_gives_way_to_the_best_it_bears_and_says_why(of):
    """Samples take 10 ms more than none; shadows of 512 leave 6.5 of 8.5: the filter's 3 are borne."""
    loaded = of()
    plan = plan_scene(loaded, "training", planted(), PIXELS)
    assert plan.methods == {"sun shadows": "map 512", "anti aliasing": "filter"}
    edges = next(part for part in explain_plan(loaded, plan)["parts"] if part["group"] == "anti aliasing")
    too_dear = {"method": "4 samples", "error": 0.08, "more_ms": 10.0, "room_ms": ROOM_MS - 2.0}
    assert edges["too_dear"] == pytest.approx(too_dear)
    assert edges["more_ms"] == pytest.approx(3.0)
    json.dumps(explain_plan(loaded, plan), allow_nan=False)


def test_what_is_taken_leaves_less_for_what_is_missed_less(of):
    """8.5 ms: shadows take 2, the filter 3, corners 2; the bloom's 2 are more than the 1.5 that are left."""
    taken = methods(of(bloom=0.2, ambient_occlusion=1.0), pixels=PIXELS)
    assert (taken["ambient occlusion"], taken["bloom"]) == ("eight places", "none")
    assert methods(of(bloom=0.2), pixels=PIXELS)["bloom"] == "six copies"


def test_a_larger_picture_bears_less_and_a_longer_frame_more(of):
    assert methods(of(), pixels=4 * PIXELS) == {"sun shadows": "map 512", "anti aliasing": "none"}
    slow = of({"frame_ms": 30.0})
    assert methods(slow, pixels=PIXELS) == {"sun shadows": "map 512", "anti aliasing": "4 samples"}


def test_the_least_there_is_runs_however_little_time_there_is(of):
    assert methods(of(), pixels=1000 * PIXELS) == {"sun shadows": "map 256", "anti aliasing": "none"}


def test_a_study_gives_up_no_accuracy_for_time(of):
    loaded = of(bloom=0.2)
    assert methods(loaded, "study", pixels=100 * PIXELS) == methods(loaded, "study")
    assert methods(loaded, "study")["bloom"] == "six copies"


@pytest.mark.parametrize(
    ("visual", "group", "method"),
    [
        ({"anti_aliasing": "none"}, "anti aliasing", "none"),
        ({"anti_aliasing": "samples"}, "anti aliasing", "4 samples"),
        ({"samples": 8}, "anti aliasing", {"msaa": 8, "fxaa": False}),
        ({"samples": 0}, "anti aliasing", "none"),
        ({"anti_aliasing": "both", "samples": 2}, "anti aliasing", {"msaa": 2, "fxaa": True}),
        ({"anti_aliasing": "both", "samples": 0}, "anti aliasing", "filter"),
        ({"shadow_size": 4096}, "sun shadows", maps(4096)),
        ({"shadow_size": 1024, "shadow_distance": 30.0}, "sun shadows", {"cascaded": True, "shadow_size": 1024}),
        ({"shadow_distance": 30.0}, "sun shadows", "cascades 2048"),
        ({"shadows": "stencil_modulative"}, "sun shadows", "stencil modulative"),
        ({"shadows": "texture_modulative"}, "sun shadows", "map 512"),
    ],
)
@pytest.mark.parametrize("pixels", [0, 100 * PIXELS])
def test_what_a_scene_states_is_obeyed(of, visual, group, method, pixels):
    loaded = of(**visual)
    plan = plan_scene(loaded, "study", planted(), pixels)
    assert plan.settings[group] == (SETTINGS[group][method] if isinstance(method, str) else method)
    json.dumps(explain_plan(loaded, plan), allow_nan=False)


def test_darkening_the_finished_picture_is_never_chosen_for_speed(of):
    cheap = [("map 512", 8, 1.5e-4), ("stencil modulative", 1, 1e-9)]
    assert methods(of(), table=planted(sun_shadows=cheap))["sun shadows"] == "map 512"


def posts(*places: tuple[float, float, float], **mesh) -> list[dict]:
    """Boxes at these places."""
    shape = {"primitive": {"shape": "box", "size": [0.2, 1.0, 0.2]}, **mesh}
    return [{**thing(f"post{i}", mesh=shape), "transform": {"translation": place}} for i, place in enumerate(places)]


@pytest.mark.parametrize(
    ("places", "mesh", "distance"),
    [
        ([(0.0, 0.0, 0.0), (3.0, 0.0, 4.0)], {}, 0.0),
        ([(0.0, 0.0, 0.0), (12.0, 0.0, 16.0)], {}, 20.0),  # 10 m about their middle
        ([(0.0, 0.0, 0.0), (900.0, 0.0, 0.0)], {}, 100.0),
        ([(0.0, 0.0, 0.0), (900.0, 0.0, 0.0)], {"casts_shadow": False}, 0.0),
        ([], {}, 0.0),
    ],
)
def test_a_wide_scene_gets_cascades_by_itself(of, places, mesh, distance):
    loaded = of(things=(EYE, SUN, *posts(*places, **mesh)))
    quality = picture_quality(loaded, "training")
    assert quality.shadow_distance == pytest.approx(distance)
    plan = plan_scene(loaded, "training", planted())
    assert plan.settings["sun shadows"]["cascaded"] is (distance > 0.0)
    notes = [part["note"] for part in explain_plan(loaded, plan)["parts"] if part["group"] == "sun shadows"]
    assert notes == [
        f"to {distance:g} m from the camera in 3 maps: bodies are spread over more than one map holds"
        if distance
        else ""
    ]


def test_a_distance_that_is_stated_holds_however_wide_the_scene_is(of):
    things = (EYE, SUN, *posts((0.0, 0.0, 0.0), (900.0, 0.0, 0.0)))
    for distance in (0.0, 30.0):
        assert picture_quality(of(things=things, shadow_distance=distance), "training").shadow_distance == distance


def test_what_a_scene_does_not_use_is_not_chosen(of):
    bare = of(things=(EYE,))
    assert methods(bare) == {"anti aliasing": "4 samples"}
    assert "sun shadows" not in methods(of(shadow_size=0))


def test_a_table_without_the_picture_leaves_it_as_it_is(of, monkeypatch):
    monkeypatch.setattr("mimics_app.app.planner.plan.load_table", lambda: (Table({}, {}, {}), "planted"))
    quality = picture_quality(of(), "training")
    assert quality == replace(RenderSettings(), hud_depth=quality.hud_depth)


def test_what_is_chosen_is_what_is_drawn(of, monkeypatch):
    monkeypatch.setattr("mimics_app.app.planner.plan.load_table", lambda: (planted(), "planted"))
    loaded = of({"shadow_m": 1e-5, "edge_px": 0.2}, ambient_occlusion=1.0, bloom=0.2)
    still = picture_quality(loaded, "training")
    assert (still.shadows, still.msaa, still.fxaa) == ("stencil_additive", 4, False)
    assert (still.ambient_occlusion, still.bloom) == (1.0, 0.2)
    live = picture_quality(loaded, "training", PIXELS)
    assert (live.shadows, live.shadow_size, live.fxaa) == ("texture_additive", 1024, False)
    assert (live.ambient_occlusion, live.bloom) == (1.0, 0.0)


def test_only_a_picture_that_pays_for_its_pixels_is_planned_by_its_costs(of, monkeypatch):
    class Surface:
        size = (640, 360)

    monkeypatch.setattr("mimics_app.app.planner.plan.load_table", lambda: (planted(), "planted"))
    for pays, samples in ((True, 0), (False, 4)):
        monkeypatch.setattr("mimics_app.app.picture.picture.pays_for_pixels", lambda _, answer=pays: answer)
        assert live_quality(of(), "training", Surface()).msaa == samples


def test_a_plan_made_before_a_live_picture_is_open_says_nothing_of_it(of):
    loaded = of(bloom=0.2)
    plan = plan_scene(loaded, "training", planted()).without_picture
    assert not {"sun shadows", "anti aliasing", "bloom"} & set(plan.methods)
    assert "filter of edges, per frame" not in {left["part"] for left in explain_plan(loaded, plan)["left_out"]}


def test_every_method_of_the_catalogue_has_settings_that_draw_it():
    """The settings a rival carries set the renderer as its own probe did."""
    registry = load_methods(["anti aliasing", "sun shadows", "level of detail", "occlusion"])
    for group, fields in (
        ("anti aliasing", ("msaa", "fxaa")),
        ("level of detail", ("detail",)),
        ("occlusion", ("occlusion",)),
        ("sun shadows", ("shadows", "shadow_size")),
    ):
        for method in registry.rivals(group):
            if method.runnable:
                ours, theirs = with_methods(RenderSettings(), {group: method.settings}), method.cost.args[0]
                named = [name for name in fields if name in method.settings]
                assert named
                assert [getattr(ours, name) for name in named] == [getattr(theirs, name) for name in named]


def test_shipped_table_draws_a_still_as_ever_and_knows_every_use(of):
    table = Table.load_shipped()
    assert set(USES) <= set(table.groups)
    still = picture_quality(of(), "training")
    assert (still.msaa, still.fxaa, still.shadow_size, still.shadows) == (4, False, 512, "texture_additive")
    assert plan_scene(of(), "draft", table).methods["anti aliasing"] == "none"
