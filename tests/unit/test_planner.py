"""The planner with planted tables: what is within the tolerance and cheapest runs, and nothing else moves."""

from __future__ import annotations

import json
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import get_args, get_type_hints

import msgspec
import pytest

from mimics_app.app.picture.methods import with_methods
from mimics_app.app.planner.explain import OF_OBJECTS, TICK_GROUP, explain_plan
from mimics_app.app.planner.plan import apply_plan, choose, load_table, plan_scene
from mimics_app.app.planner.tolerances import BY_PROFILE, tolerances_of
from mimics_app.app.planner.uses import USES
from mimics_app.app.scenes.loading import load_checked_scene
from mimics_app.app.settings import PROFILES
from mimics_app.app.touch.device_fit import device_values
from mimics_app.contracts.loop.controller_slots import Slot, names_in
from mimics_app.contracts.loop.haptic_objects import ObjectIntegrator, Projection
from mimics_app.contracts.ports.method_table import Row, Table
from mimics_app.contracts.system.resources import root
from mimics_app.lab.catalogue import GROUPS, load_methods
from mimics_app.rendering.haptic.controllers.registry import find_controller
from mimics_app.rendering.haptic.devices.registry import build_device
from mimics_app.rendering.haptic.scene_objects import objects_of_scene
from mimics_app.rendering.haptic.scene_tunnel import PROJECTIONS
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.scenarios.parts.robot_scene import robot_block
from mimics_app.world.components.objects import HapticObject
from mimics_app.world.components.robot import Robot
from mimics_app.world.components.systems import HapticSettings, Tolerances
from mimics_app.world.components.tolerance_units import FIELD_OF_UNIT

SCENE = root() / "scenes" / "wavy_tunnel.json"
PART_KEYS = [
    "part",
    "group",
    "method",
    "cost_us",
    "error",
    "unit",
    "tolerance",
    "next_cheaper",
    "too_dear",
    "more_ms",
    "note",
    "within",
    "tick_us",
]


def row(method: str, cost_us: float, error: float, unit: str, **settings: object) -> Row:
    return Row(method, cost_us, cost_us, error, unit, settings)


def projection(word: str, cost_us: float, error: float) -> Row:
    return row(word, cost_us, error, "m", projection=word)


def planted(**changed: list[Row]) -> Table:
    """Two methods a group: a quick one that is wrong by 1e-4 of the unit (200 us), a slow one by 1e-9 (10 us)."""
    groups = {
        "tunnel projection": [projection("newton one step", 1.0, 1e-4), projection("newton warm", 2.0, 1e-9)],
        "tunnel frame": [row("double reflection", 2.0, 1e-9, "rad")],
        "admittance form": [
            row("seed", 0.5, 2.0, "N", form="seed"),
            row("polar", 1.0, 2e-3, "N", form="polar"),
            row("cartesian", 2.0, 1e-9, "N", form="cartesian"),
        ],
        "colliding bodies": [
            row("exact drag", 1.0, 0.05, "restitution", integrator="exact_drag"),
            row("semi-implicit", 2.0, 0.018, "restitution", integrator="semi_implicit"),
        ],
        "spatialiser": [
            row("stereo", 10.0, 200.0, "us of interaural delay", hrtf=False),
            row("hrtf", 40.0, 10.0, "us of interaural delay", hrtf=True),
        ],
    }
    return Table({**groups, **{name.replace("_", " "): rows for name, rows in changed.items()}}, {}, {})


@pytest.fixture
def scene():
    return load_checked_scene(SCENE)


def leave_open(scene) -> None:
    """The form of the admittance and the integrator are the planner's, and there is a body that moves."""
    for entity in scene.entities:
        if "admittance" in entity.components:
            entity.components["admittance"] = msgspec.structs.replace(entity.components["admittance"], form="auto")
    scene.entities[0].components["haptic_object"] = HapticObject(stiffness=1000.0, damping=5.0)


def accepting(scene, **tolerances: float):
    scene.systems["tolerances"] = Tolerances(**tolerances)
    return scene


def test_body_signals_and_learning_are_asked_for_by_the_run(scene):
    """No component of a scene is a recorder of body signals; a task may name its policy."""
    left = {
        one["part"]: one["why"] for one in explain_plan(scene, plan_scene(scene, "training", planted()))["left_out"]
    }
    assert "--physio" in left["body signals and the person's state"]
    assert "--learn" in left["learned adaptation"]
    walk = load_checked_scene(root() / "scenes" / "guided_walk.json")
    parts = [one["part"] for one in explain_plan(walk, plan_scene(walk, "training", planted()))["left_out"]]
    assert "body signals and the person's state" in parts and "learned adaptation" not in parts


def test_a_rival_at_half_the_cost_and_equal_error_is_taken_and_at_ten_times_the_error_dropped():
    ours = row("ours", 2.0, 5e-7, "m")
    assert choose([ours, row("rival", 1.0, 5e-7, "m")], 1e-6).method == "rival"
    assert choose([ours, row("rival", 1.0, 5e-6, "m")], 1e-6).method == "ours"


def test_of_nothing_within_the_tolerance_the_most_accurate_is_taken():
    rivals = [row("a", 1.0, 1e-2, "m"), row("b", 9.0, 1e-3, "m"), row("failed", 0.1, float("inf"), "m")]
    assert choose(rivals, 1e-9).method == "b"


def test_the_order_of_the_table_decides_nothing():
    rivals = [row("b", 1.0, 1e-7, "m"), row("a", 1.0, 1e-7, "m"), row("c", 1.0, 1e-8, "m")]
    assert choose(rivals, 1e-6) == choose(rivals[::-1], 1e-6)
    assert choose(rivals, 1e-6).method == "c"


LOOSE = {"force_N": 10.0, "restitution": 0.1, "position_m": 1e-3, "angle_rad": 1e-2, "itd_us": 700.0, "frame_ms": 17.0}


@pytest.mark.parametrize(
    ("field", "value", "moved"),
    [
        ("position_m", 1e-6, {"tunnel projection": "newton warm"}),
        ("itd_us", 50.0, {"spatialiser": "hrtf"}),
        ("force_N", 1e-3, {"admittance form": "cartesian"}),
        ("restitution", 0.02, {"colliding bodies": "semi-implicit"}),
        ("frame_ms", 1.0, {}),
    ],
)
def test_tightening_one_tolerance_moves_exactly_the_methods_that_must_move(scene, field, value, moved):
    leave_open(scene)
    loose = plan_scene(accepting(scene, **LOOSE), "draft", planted()).methods
    assert loose["tunnel projection"] == "newton one step" and loose["spatialiser"] == "stereo"
    tight = plan_scene(accepting(scene, **{**LOOSE, field: value}), "draft", planted()).methods
    assert {group: method for group, method in tight.items() if loose[group] != method} == moved


def test_scene_wins_over_planner_and_is_reported(scene):
    scene.systems["haptic"] = HapticSettings(projection="newton warm")
    plan = plan_scene(accepting(scene, **LOOSE), "draft", planted())
    choice = plan.choices[0]
    assert (choice.taken.method, choice.planner.method) == ("newton warm", "newton one step")
    assert choice.refused is None, "the cheaper one is within the tolerance: it was overruled, not refused"


def test_a_method_the_scene_names_runs_although_the_table_lacks_it(scene):
    scene.systems["haptic"] = HapticSettings(projection="brute force")
    plan = plan_scene(scene, "training", planted())
    assert plan.settings["tunnel projection"] == {"projection": "brute force"}
    json.dumps(explain_plan(scene, plan))


@pytest.mark.parametrize("name", ["newton one step", "newton warm"])
def test_what_is_chosen_is_what_runs(scene, name, monkeypatch):
    table = planted(tunnel_projection=[projection(name, 1.0, 1e-12), projection("golden section", 2.0, 1e-12)])
    monkeypatch.setattr("mimics_app.app.planner.plan.load_table", lambda: (table, "planted"))
    apply_plan(scene, "study")
    tunnel = objects_of_scene(scene).rows.tunnels[0]
    assert Projection(tunnel["projection"]) is PROJECTIONS[name]


def renamed(table: Table) -> Table:
    """The same figures and settings under names that nobody ever wrote."""
    groups = {
        group: [replace(r, method=f"no. {k}") for k, r in enumerate(rows)] for group, rows in table.groups.items()
    }
    return replace(table, groups=groups)


@pytest.mark.parametrize("name", ["wavy_tunnel", "pick_and_place", "city_walk"])
@pytest.mark.parametrize("profile", PROFILES)
def test_the_product_runs_the_same_under_other_names_of_the_methods(name, profile):
    table = Table.load_shipped()
    scene = load_checked_scene(root() / "scenes" / f"{name}.json")
    ours, theirs = (plan_scene(scene, profile, each, 640 * 360) for each in (table, renamed(table)))
    assert ours.settings == theirs.settings and ours.methods != theirs.methods
    assert with_methods(RenderSettings(), ours.settings) == with_methods(RenderSettings(), theirs.settings)
    parts = explain_plan(scene, ours)["parts"], explain_plan(scene, theirs)["parts"]
    assert [part.get("tick_us") for part in parts[0]] == [part.get("tick_us") for part in parts[1]]


@pytest.mark.parametrize("word", PROJECTIONS)
def test_a_renamed_projection_runs_as_its_settings_say(scene, word, monkeypatch):
    table = planted(tunnel_projection=[row("anything", 1.0, 1e-12, "m", projection=word)])
    monkeypatch.setattr("mimics_app.app.planner.plan.load_table", lambda: (table, "planted"))
    apply_plan(scene, "study")
    tunnel = objects_of_scene(scene).rows.tunnels[0]
    assert Projection(tunnel["projection"]) is PROJECTIONS[word]


@pytest.mark.parametrize("word", ["polar", "cartesian"])
def test_the_form_that_is_chosen_is_what_runs(scene, word, monkeypatch):
    leave_open(scene)
    table = planted(admittance_form=[row("anything", 1.0, 1e-12, "N", form=word)])
    monkeypatch.setattr("mimics_app.app.planner.plan.load_table", lambda: (table, "planted"))
    apply_plan(scene, "study")
    assert names_in(robot_block(scene)[0]["controller_names"])[Slot.PERSON] == f"admittance_{word}"


@pytest.mark.parametrize("word", ["exact_drag", "semi_implicit"])
def test_the_integrator_that_is_chosen_is_what_runs(word):
    """Also where the rows were computed once already, before there was a plan."""
    scene = load_checked_scene(root() / "scenes" / "examples" / "free_objects.json")
    scene.methods = {"colliding bodies": {"integrator": word}}
    bodies = objects_of_scene(scene).rows.bodies
    assert len(bodies) and set(bodies["integrator"]) == {ObjectIntegrator[word.upper()]}


def test_an_integrator_that_needs_more_damping_is_never_chosen_by_itself(scene):
    """exact_drag keeps a contact of 1000 N/m still only with b > k h/2: at 0.1 N s/m it would gain energy."""
    leave_open(scene)
    scene.entities[0].components["haptic_object"] = HapticObject(stiffness=1000.0, damping=0.1)
    plan = plan_scene(accepting(scene, restitution=1.0), "draft", planted())
    assert plan.settings["colliding bodies"] == {"integrator": "semi_implicit"}


def test_the_printed_form_runs_only_where_a_scene_asks_for_it(scene):
    leave_open(scene)
    assert plan_scene(accepting(scene, force_N=100.0), "draft", planted()).methods["admittance form"] == "polar"


WALL = root() / "scenes" / "examples" / "lokomat_wall.json"
OBSTACLE = root() / "scenes" / "examples" / "lokomat_obstacle.json"


def with_parameters(scene, **parameters: float):
    """The scene with more parameters of its controller."""
    for entity in scene.entities:
        if named := entity.components.get("controller"):
            entity.components["controller"] = msgspec.structs.replace(
                named, parameters={**named.parameters, **parameters}
            )
    return scene


def test_a_leg_in_the_orthosis_is_controlled_as_its_scene_says_and_the_rest_is_planned():
    """By the shipped table: the stiffer position control, unless the tolerance is loose, or it names another."""
    table, wall = Table.load_shipped(), load_checked_scene(WALL)
    plan = plan_scene(wall, "training", table)
    control = next(choice for choice in plan.choices if choice.group == "leg control")
    assert control.taken.settings == {"controller": "lokomat_combined"}
    assert control.planner is not None and control.planner.settings == {"controller": "lokomat_impedance"}
    assert plan.settings["leg position"] == {"computed_torque": 1.0} and "leg guidance" not in plan.methods
    assert plan.settings["leg speed"] == {"encoder": 2e-5}
    loose = plan_scene(accepting(wall, position_m=0.1), "training", table)
    assert loose.settings["leg position"] == {"computed_torque": 0.0}
    named = with_parameters(load_checked_scene(WALL), computed_torque=0)
    assert plan_scene(named, "study", table).settings["leg position"] == {"computed_torque": 0.0}
    obstacle = plan_scene(load_checked_scene(OBSTACLE), "training", table)
    assert obstacle.settings["leg guidance"] == {"guidance_window": 0.0} and "leg position" not in obstacle.methods


def test_what_is_planned_for_a_leg_reaches_its_controller_unless_the_scene_says_otherwise():
    vector = [each.name for each in find_controller("lokomat_combined").parameters for _ in range(each.size)]
    place = vector.index("computed_torque")
    for given, planned, runs in (({}, 0.0, 0.0), ({"computed_torque": 1}, 0.0, 1.0), ({}, 1.0, 1.0)):
        scene = with_parameters(load_checked_scene(WALL), **given)
        scene.methods = {"leg position": {"computed_torque": planned}}
        values = device_values(build_device(scene.one(Robot)[1]), scene, robot_block(scene))
        assert values["controller_parameters"][Slot.PERSON][place] == runs


NOT_PLANNED = {
    "joint reference": "the curves of a reference are what its author has: a table, or the series of a gait",
    "joint reference jerk": "the same, by the jerk that each adds",
    "leg position walk": 'the position controls of "leg position", by their deviation from a walk',
    "leg guidance pull": 'the guidances of "leg guidance", by their pull at who walks, but late',
    "integrator": 'the integrators of bodies on one wall alone; "colliding bodies" chooses among all a body can have',
    "bounding geometry": "the shape of an object is its author's choice",
    "effects": "each is another force: its author's choice",
    "joint mixing": "the bending of a body is a matter of appearance: the scene's `animation.skinning` states it",
    "culling": "the faster one depends on the view: the renderer counts the items of each scene",
    "frame of nodes": "culling, measured in whole frames",
    "frame of triangles": "level of detail, measured in whole frames",
    "raster threads": "the renderer places them wherever that was measured to pay",
    "loop scheduling": "the first recipe that the system grants runs",
    "model reading": "kinds of files, not rivals",
    "haptic tick": "the whole tick, by the tunnel projection that is chosen",
    "load of the person": "body signals belong to a run, not to a scene: the best of the chart, or the task's",
}
"""Groups with several methods of which the planner chooses none, with the reason."""


def test_the_planner_knows_every_group_with_two_rivals_that_run():
    registry = load_methods()
    rivals = {
        group: [method for method in registry.rivals(group) if method.runnable]
        for group in registry.groups()
        if group in GROUPS
    }
    assert {group for group, some in rivals.items() if len(some) > 1} == (
        {group for group in USES if len(rivals[group]) > 1} | set(NOT_PLANNED)
    )
    assert not set(USES) & set(NOT_PLANNED) and set(USES) <= set(rivals)


def test_the_shipped_table_has_the_rivals_that_run_and_their_settings():
    """But `2 samples`: the driver it was measured with takes 4 for them."""
    registry, table = load_methods(), Table.load_shipped()
    for group, rows in table.groups.items():
        runnable = {method.name: method.settings for method in registry.rivals(group) if method.runnable}
        runnable.pop("2 samples", None)
        assert {r.method: r.settings for r in rows} == runnable, group


def test_smoke_is_lit_at_vertices_in_live_software_rendering_but_of_a_study():
    """By the shipped table."""
    fire, table = load_checked_scene(root() / "scenes/examples/billboards_and_particles.json"), Table.load_shipped()
    live = [plan_scene(fire, profile, table, pixels=1280 * 720).methods["particle light"] for profile in PROFILES]
    assert live == ["vertex", "vertex", "pixel"]
    assert plan_scene(fire, "training", table).methods["particle light"] == "pixel"


def test_people_are_lit_at_vertices_in_live_software_rendering_only(scene):
    """By the shipped table; the stricter the profile, the smaller the triangles."""
    shipped, live = Table.load_shipped(), 1280 * 720
    limits = [plan_scene(scene, profile, shipped, pixels=live).settings["vertex light"] for profile in PROFILES]
    draft, training, study = (each["vertex_light"] for each in limits)
    assert draft >= training > study
    assert plan_scene(scene, "training", shipped).settings["vertex light"] == {"vertex_light": 0.0}


def test_without_a_plan_the_tunnel_runs_the_tracked_newton(scene):
    tunnel = objects_of_scene(scene).rows.tunnels[0]
    assert Projection(tunnel["projection"]) is Projection.NEWTON_WARM


def test_shipped_table_draft_and_study_choose_differently(scene):
    table = Table.load_shipped()
    draft, study = (plan_scene(scene, profile, table).methods for profile in ("draft", "study"))
    assert draft["tunnel projection"] == "newton one step" and study["tunnel projection"] == "newton warm"
    assert draft["spatialiser"] == "stereo" and study["spatialiser"] == "hrtf"
    same = ("tunnel frame", "admittance form")
    assert [draft[group] for group in same] == [study[group] for group in same]


def test_the_spectral_mixer_is_cheaper_and_taken_only_where_it_is_asked_for(scene):
    """It starts with more work: see decision 200."""
    table = Table.load_shipped()
    costs = {r.method: r.cost_us for r in table.groups["spatialiser"]}
    assert costs["spectral"] < costs["hrtf"]
    usual = plan_scene(scene, "study", table)
    assert next(c.taken.settings["mixer"] for c in usual.choices if c.group == "spatialiser") == "openal"
    exact = plan_scene(accepting(scene, itd_us=10.0), "study", table)
    assert next(c.taken.settings["mixer"] for c in exact.choices if c.group == "spatialiser") == "spectral"


@pytest.mark.parametrize(
    ("audio", "components", "mixer"),
    [
        ({}, {}, "openal"),
        ({}, {"sound_obstacle": {"size": [1, 1, 1]}}, "openal"),
        ({}, {"sound_room": {"size": [4, 3, 4]}}, "spectral"),
        ({}, {"sound_bus": {"ducks": ["main"]}}, "spectral"),
        ({}, {"sound_emitter": {"sound": "hum", "distance_model": "linear"}}, "spectral"),
        ({}, {"sound_emitter": {"sound": "hum", "doppler": 0.0}}, "spectral"),
        ({"head_width": 0.16}, {}, "spectral"),
        ({"hrtf": False, "speakers": "5.1"}, {}, "spectral"),
    ],
)
@pytest.mark.parametrize("profile", PROFILES)
def test_a_scene_is_heard_with_all_it_says_of_its_sound(tmp_path, profile, audio, components, mixer):
    """OpenAL has no rooms, buses or other heads, and would leave them out without a word."""
    entities = [{"id": "hum", "components": {"sound": {"synth": "wind"}}}, {"id": "it", "components": components}]
    document = {"format": "mimics-scene", "version": 1, "name": "heard", "scenario": "none", "entities": entities}
    (tmp_path / "scene.json").write_text(json.dumps(document | {"systems": {"audio": audio}}))
    plan = plan_scene(load_checked_scene(tmp_path / "scene.json"), profile, Table.load_shipped())
    assert [c.taken.settings["mixer"] for c in plan.choices if c.group == "spatialiser"] == [mixer]


def test_shipped_table_knows_every_method_a_scene_may_name():
    groups = Table.load_shipped().groups

    def stated(group: str, field: str) -> set[object]:
        return {r.settings[field] for r in groups[group]}

    names = get_args(get_args(get_type_hints(HapticSettings, include_extras=True)["projection"])[0])
    assert set(names) - {"auto"} == set(PROJECTIONS) == stated("tunnel projection", "projection")
    assert {"cartesian", "polar", "seed"} == stated("admittance form", "form")
    assert {"semi_implicit", "explicit", "exact_drag", "implicit_midpoint"} == stated("colliding bodies", "integrator")
    assert {True, False} == stated("spatialiser", "hrtf")
    assert {*OF_OBJECTS, TICK_GROUP} <= set(groups)
    for group in USES:
        assert len({FIELD_OF_UNIT[r.unit] for r in groups[group]}) == 1, group


def test_every_profile_bounds_every_error_and_each_is_stricter_than_the_one_before(scene):
    fields = set(Tolerances.__struct_fields__)
    assert all(set(BY_PROFILE[profile]) == fields for profile in PROFILES)
    for looser, stricter in pairwise(PROFILES):
        assert all(BY_PROFILE[stricter][field] <= BY_PROFILE[looser][field] for field in fields)
    assert tolerances_of(accepting(scene, itd_us=12.5), "draft") == {**BY_PROFILE["draft"], "itd_us": 12.5}


def test_explained_object_has_the_keys_scripts_rely_on(scene):
    answer = explain_plan(scene, plan_scene(scene, "training", Table.load_shipped()))
    assert {"profile", "parts", "left_out"} <= set(answer)
    for part in answer["parts"]:
        assert list(part) == [key for key in PART_KEYS if part.get(key) is not None], "what does not apply is absent"
        assert "next_cheaper" not in part or list(part["next_cheaper"]) == ["method", "error"]
    assert all(list(left)[:2] == ["part", "why"] and None not in left.values() for left in answer["left_out"])
    refused = {part["group"]: part.get("next_cheaper") for part in answer["parts"]}["tunnel projection"]
    assert refused["method"] == "newton one step" and refused["error"] > 1e-6


def test_sound_that_is_not_there_is_left_out_with_its_cost(scene):
    silent = replace(
        scene,
        entities=[
            replace(one, components={k: v for k, v in one.components.items() if not k.startswith("sound")})
            for one in scene.entities
        ],
    )
    answer = explain_plan(silent, plan_scene(silent, "training", planted()))
    left = {item["part"]: item.get("saved_us") for item in answer["left_out"]}
    assert left["sound process, per block of 5 ms"] == 10.0
    assert "spatialiser" not in {part["group"] for part in answer["parts"]}


@pytest.mark.parametrize(
    ("name", "ticks", "left"),
    [
        ("wavy_tunnel", "haptic tick, all of it", 4),
        ("pick_and_place", "haptic tick without its objects", 0),
        ("avatar_gallery", "", 4),
    ],
)
def test_what_only_objects_need_is_left_out_where_none_is(name, ticks, left):
    scene = load_checked_scene(root() / "scenes" / f"{name}.json")
    reported = explain_plan(scene, plan_scene(scene, "training"))
    assert [part["part"] for part in reported["parts"] if part["group"] == TICK_GROUP] == ([ticks] if ticks else [])
    assert len({*OF_OBJECTS.values()} & {part["part"] for part in reported["left_out"]}) == left


def test_shadow_is_measured_only_where_none_is_cast(scene):
    asked = []
    explain_plan(scene, plan_scene(scene, "training", planted()), lambda: asked.append(1) or 1.0)
    assert not asked, "a light of this scene casts a shadow"


def test_saved_table_stands_before_the_shipped_one_and_is_named(monkeypatch):
    newer = [row("newton warm", 1.0, 1e-9, "m")]
    monkeypatch.setattr(Table, "load_saved", classmethod(lambda cls: Table({"tunnel projection": newer}, {"m": 1}, {})))
    table, origin = load_table()
    assert origin == "saved"
    assert table.groups["tunnel projection"] == newer
    assert table.groups["spatialiser"] == Table.load_shipped().groups["spatialiser"]
    monkeypatch.setattr(Table, "load_saved", classmethod(lambda cls: None))
    assert load_table()[1] == "shipped"


def test_a_table_saved_before_methods_had_settings_is_passed_over(tmp_path, monkeypatch):
    old = {"method": "newton warm", "cost_us": 1.0, "ratio": 1.0, "error": 0.0, "unit": "m"}
    file = tmp_path / "saved.json"
    file.write_text(json.dumps({"machine": {}, "reference_us": {}, "groups": {"tunnel projection": [old]}}))
    monkeypatch.setattr("mimics_app.contracts.ports.method_table.saved_file", lambda: file)
    assert load_table()[1] == "shipped"


@pytest.mark.parametrize(
    ("name", "wanted"),
    [
        ("wavy_tunnel", {"haptic tick, all of it", "motion of the virtual mass", "direction of sounds"}),
        (
            "pick_and_place",
            {"force of a contact", "friction of a contact", "bodies that move and collide", "bodies, at rest", "grip"}
            | {"motion of the virtual mass", "rotation of bodies", "touching a shape", "direction of sounds"},
        ),
        ("examples/springs_and_magnets", {"effects and force fields", "motion of the virtual mass"}),
        ("examples/surfaces", {"force of a contact", "friction of a contact", "touching a shape"}),
    ],
)
def test_every_part_that_runs_is_listed(name, wanted):
    scene = load_checked_scene(root() / "scenes" / f"{name}.json")
    parts = explain_plan(scene, plan_scene(scene, "training", Table.load_shipped()))["parts"]
    assert wanted <= {part["part"] for part in parts}
    alone = {part["group"] for part in parts if "no rival" in part["note"]}
    assert alone <= {"friction", "rotation update", "tunnel frame", "grip"}
    assert all(part["cost_us"] is not None for part in parts), "every part has a figure"


def test_tolerance_of_zero_is_refused_with_its_place(tmp_path: Path):
    document = json.loads(SCENE.read_text())
    document["systems"] = {"tolerances": {"position_m": 0.0}}
    file = tmp_path / "scene.json"
    file.write_text(json.dumps(document))
    with pytest.raises(Exception, match="/systems/tolerances/position_m"):
        load_checked_scene(file)
