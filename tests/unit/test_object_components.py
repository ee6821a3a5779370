"""Components of haptic objects: every fault is reported with its pointer and what to do."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

from mimics_app.world.components.registry import component_types
from mimics_app.world.files.scene.schema import scene_schema
from tests.support.object_scenes import CUBE, at, gltf_box, reported, thing

BALL = thing("ball_a", haptic_object={"shapes": [{"shape": "sphere", "radius": 0.05}]})
PLACE = "scene.json#/entities/0/components/"


def faulty(folder: Path, **component: object) -> list[str]:
    return reported(folder, thing("a", **component))


@pytest.mark.parametrize(
    ("component", "values", "pointer", "says"),
    [
        ("haptic_object", {}, "", "no shapes"),
        ("haptic_object", {"shapes": [{"shape": "bax"}]}, "/shapes/0/shape", 'did you mean "box"'),
        ("haptic_object", {"shapes": [{**CUBE, "size": [0.1, 0.0, 0.1]}]}, "/shapes/0/size/1", "> 0"),
        ("haptic_object", {"shapes": [{**CUBE, "rounding": 0.05}]}, "/shapes/0/rounding", "stay below 0.05 m"),
        ("haptic_object", {"shapes": [{**CUBE, "rotation": [0, 0, 0, 2]}]}, "/shapes/0/rotation", "length 2"),
        ("haptic_object", {"shapes": [CUBE], "mass": 0.0}, "/mass", ">= 1e-06"),
        ("haptic_object", {"shapes": [CUBE], "mass": 1.0, "density": 10.0}, "/density", "leave one"),
        ("haptic_object", {"shapes": [CUBE], "mas": 1.0}, "/mas", 'did you mean "mass"'),
        ("haptic_object", {"shapes": [CUBE], "inertia": [1, 1, 3]}, "/inertia", "above the sum"),
        ("haptic_object", {"shapes": [CUBE], "crush_force": 3.0}, "/crush_force", '"grip": true'),
        (
            "haptic_object",
            {"shapes": [CUBE], "enable_translation": False, "initial_velocity": [1, 0, 0]},
            "/initial_velocity",
            "translation is disabled",
        ),
        (
            "haptic_object",
            {"shapes": [CUBE], "enable_rotation": False, "initial_angular_velocity": [1, 0, 0]},
            "/initial_angular_velocity",
            "rotation is disabled",
        ),
        (
            "haptic_object",
            {"shapes": [CUBE], "friction_static": 0.2, "friction_dynamic": 0.3},
            "/friction_static",
            "slide more easily",
        ),
        (
            "haptic_object",
            {"shapes": [{**CUBE, "friction_static": 0.2}], "friction_dynamic": 0.3},
            "/shapes/0/friction_static",
            "slide more easily",
        ),
        (
            "haptic_object",
            {"shapes": [CUBE], "texture_height": 0.002},
            "/texture_height",
            "stay below texture_length / pi = 0.00159 m",
        ),
        (
            "haptic_object",
            {"shapes": [{**CUBE, "texture_length": 0.001}], "texture_height": 0.0005},
            "/texture_height",
            "steeper than 45 degrees",
        ),
        ("haptic_walls", {"size": [1, 1, 1], "left": {"texture_height": 0.01}}, "/left/texture_height", "45 degrees"),
        ("haptic_object", {"shapes": [CUBE], "stiffness": 0.0}, "/stiffness", "> 0"),
        ("haptic_object", {"shapes": [{**CUBE, "size": [0.1, 1e-9, 0.1]}]}, "/shapes/0", "1e-09 m thin"),
        ("haptic_object", {"shapes": [CUBE], "mass": 1e-5}, "/mass", "too light"),
        ("haptic_object", {"shapes": [CUBE], "mass": 1e300}, "/mass", "<= 1000000"),
        ("haptic_object", {"shapes": [CUBE], "gravity": [0, -1e300, 0]}, "/gravity/1", ">= -1000000"),
        ("haptic_object", {"shapes": [CUBE], "damping": 1e300}, "/damping", "<= 1000000"),
        ("haptic_object", {"shapes": [CUBE], "friction_dynamic": 1e300}, "/friction_dynamic", "<= 100"),
        ("haptic_object", {"shapes": [CUBE], "environment_translation_damping": 1e5}, "/mass", "exact_drag"),
        ("haptic_object", {"shapes": [CUBE], "environment_rotation_damping": 1e3}, "/mass", "smallest moment"),
        ("haptic_object", {"shapes": [{**CUBE, "position": [1e300, 0, 0]}]}, "/shapes/0/position/0", "<= 1000"),
        ("haptic_effect", {"effect": {"kind": "constant_force", "force": [1e308, 0, 0]}}, "/effect/force/0", "<="),
        ("haptic_path", {"control_points": [[0, 0, 0], [1, 0, 0], [2, 0, 0]]}, "/control_points", "takes 4 to 99"),
        ("haptic_walls", {"size": [1, 1, 1], "left": {"position": [1e300, 0, 0]}}, "/left/position/0", "<= 1000"),
        ("haptic_object", {"shapes": [{"shape": "mesh", "source": "rock"}]}, "/shapes/0/source", 'no asset "rock"'),
        ("haptic_object", {"shapes": [CUBE], "gravity": [0, 0]}, "/gravity", "length 3"),
        ("haptic_object", {"shapes": [CUBE], "integrator": "semi-implicit"}, "/integrator", "semi_implicit"),
        ("haptic_walls", {}, "", '"left" has no place'),
        ("haptic_walls", {"size": [1, 1, 0]}, "/size/2", "> 0"),
        ("haptic_walls", {"size": [1, 1, 1], "floor": {"rotation": [1, 1, 0, 0]}}, "/floor/rotation", "1.414"),
        ("haptic_effect", {"effect": {"kind": "sprig"}}, "/effect/kind", 'did you mean "spring"'),
        ("haptic_effect", {"effect": {"kind": "spring"}}, "/effect", '"stiffness" is missing'),
        ("haptic_effect", {"effect": {"kind": "workspace"}}, "/effect", "radius or a size"),
        ("haptic_effect", {"effect": {"kind": "constant_force", "force": [0, 0, 0]}}, "/effect/force", "is zero"),
        (
            "haptic_effect",
            {"effect": {"kind": "path_spring", "path": "way", "stiffness": 100}},
            "/effect/path",
            'no entity with a "haptic_path" "way"',
        ),
        (
            "haptic_effect",
            {"effect": {"kind": "viscosity", "damping": 5}, "object": "cup"},
            "/object",
            'no entity with a "haptic_object" "cup"',
        ),
        (
            "haptic_effect",
            {"effect": {"kind": "viscosity", "damping": 5}, "acts_on": "object"},
            "/acts_on",
            "no object is named",
        ),
        (
            "haptic_effect",
            {"effect": {"kind": "vibration", "direction": [0, 0, 0], "amplitude": 1, "frequency": 30}},
            "/effect/direction",
            "is zero",
        ),
        ("force_field", {"function": "curll"}, "/function", 'did you mean "curl"'),
        ("force_field", {"function": "curl", "parameters": [0] * 9}, "/parameters", "length <= 8"),
        ("haptic_path", {}, "", "control_points or a path_file"),
        ("haptic_path", {"control_points": [[0, 0, 0], [0, 0, 0], [0, 0, 0], [0, 0, 0]]}, "/control_points/1", ""),
        ("interaction_points", {"points": []}, "/points", ""),
        ("interaction_points", {"points": [{}] * 5}, "/points", "length <= 4"),
        ("connections", {"wires": []}, "/wires", ""),
    ],
)
def test_fault_is_reported_where_it_stands(tmp_path, component, values, pointer, says):
    lines = faulty(tmp_path, **{component: values})
    assert any(line.startswith(f"{PLACE}{component}{pointer}: ") and says in line for line in lines), lines


@pytest.mark.parametrize(
    ("wire", "pointer", "says"),
    [
        ({"from": "p_rop", "to": "ball_a.F_aux"}, "from", 'did you mean "p_rob"'),
        ({"from": "ball_b.p_obj", "to": "ball_a.F_aux"}, "from", 'did you mean "ball_a"'),
        ({"from": "ball_a.p_ob", "to": "ball_a.F_aux"}, "from", 'did you mean "p_obj"'),
        ({"from": "ball_a.R_obj.w", "to": "ball_a.F_aux"}, "from", "ball_a"),
        ({"from": "time", "to": "ball_a.F_au"}, "to", 'did you mean "F_aux"'),
        ({"from": "time", "to": "ball_c.F_aux"}, "to", 'did you mean "ball_a"'),
        ({"from": "time", "to": "F_aux"}, "to", "OBJECT.F_aux"),
        ({"from": "time", "to": "ball_a.position"}, "to", "F_aux"),
        ({"from": "p_rob", "to": "ball_a.F_aux", "gain": 1e300}, "gain", "beyond 1e+06"),
        ({"from": "p_rob", "to": "ball_a.F_aux", "gain": [[1, 0, 0], [0, -1e7, 0], [0, 0, 1]]}, "gain", "1e+06"),
    ],
)
def test_wire_to_nowhere_is_reported(tmp_path, wire, pointer, says):
    lines = reported(tmp_path, BALL, thing("wiring", connections={"wires": [wire]}))
    assert len(lines) == 1
    assert lines[0].startswith(f"scene.json#/entities/1/components/connections/wires/0/{pointer}: ")
    assert says in lines[0]


def test_body_too_light_for_what_it_meets_is_refused_with_the_formula(tmp_path):
    walls = thing("room", haptic_walls={"size": [1, 1, 1], "stiffness": 2000.0})
    light = thing("a", haptic_object={"shapes": [CUBE], "mass": 0.001})
    lines = reported(tmp_path, light, walls)
    assert len(lines) == 1
    assert lines[0].startswith("scene.json#/entities/0/components/haptic_object/mass: 0.001 kg is too light")
    assert "m > n (h^2 k + 2 h b)/4 =" in lines[0]
    assert reported(tmp_path, thing("a", haptic_object={"shapes": [CUBE], "mass": 0.1}), walls) == []


def test_scaled_object_is_refused_and_its_parent_too(tmp_path):
    parent = at(0, 0, 0, {"id": "base"}, scale=[2, 2, 2])
    child = {**BALL, "parent": "base"}
    assert any("scaled by 2, 2, 2" in line for line in reported(tmp_path, parent, child))


def test_open_surface_has_no_mass_of_its_own(tmp_path):
    gltf_box(tmp_path, (0.1, 0.1, 0.1), lid=False)
    shape = {"shape": "mesh", "source": "box"}
    parts = {"assets": {"box": {"uri": "box.gltf"}}}
    lines = reported(tmp_path, thing("a", haptic_object={"shapes": [shape]}), **parts)
    assert len(lines) == 1
    assert "shapes/0: " in lines[0]
    assert "not a closed surface" in lines[0]
    hull = thing("a", haptic_object={"shapes": [{**shape, "fit": "hull"}]})
    given = {"mass": 1.0, "inertia": [0.01, 0.01, 0.01], "centre": [0, 0, 0]}
    assert reported(tmp_path, hull, **parts) == []
    assert reported(tmp_path, thing("a", haptic_object={"shapes": [shape], **given}), **parts) == []


def test_fifth_different_force_field_is_refused(tmp_path):
    from mimics_app.rendering.haptic import force_fields
    from mimics_app.rendering.haptic.no_objects import no_field

    names = [f"test_{i}" for i in range(5)]
    for name in names:
        force_fields.add_field(name, no_field)
    fields = [thing(f"f{i}", force_field={"function": name}) for i, name in enumerate(names)]
    assert reported(tmp_path, *fields[:4]) == []
    assert [line.split(": ")[0] for line in reported(tmp_path, *fields)] == [
        "scene.json#/entities/4/components/force_field/function"
    ]


@pytest.mark.parametrize(
    ("entities", "place", "says"),
    [
        ([at(0, 0, 0, BALL, rotation=[0, 0, 0, 0])], "0/transform/rotation", "length 0"),
        ([{**BALL, "parent": "gone"}], "0/parent", 'no entity "gone"'),
        ([{**BALL, "parent": "b"}, {"id": "b", "parent": "ball_a"}], "0/parent", "hangs on itself"),
        ([at(1e5, 0, 0, BALL)], "0/transform/translation", "1 km"),
    ],
)
def test_object_that_stands_nowhere_is_reported_in_one_line(tmp_path, entities, place, says):
    lines = reported(tmp_path, *entities)
    assert len(lines) == 1 and lines[0].startswith(f"scene.json#/entities/{place}: ") and says in lines[0]


def test_two_objects_that_drive_each_other_are_right(tmp_path):
    """A wire carries what its source was a tick ago, so that no loop of wires has to be solved."""
    wires = [{"from": "a.v_obj", "to": "b.F_aux"}, {"from": "b.v_obj", "to": "a.F_aux"}]
    pair = [thing(name, haptic_object={"shapes": [CUBE]}) for name in "ab"]
    assert reported(tmp_path, *pair, thing("w", connections={"wires": wires})) == []


def test_a_fault_of_the_objects_own_surface_is_reported_once_for_all_its_shapes(tmp_path):
    lines = faulty(tmp_path, haptic_object={"shapes": [CUBE, CUBE, CUBE], "texture_height": 0.005})
    assert len(lines) == 1


def test_schema_describes_every_key_of_every_part():
    schema = scene_schema()
    names = ("haptic_object", "haptic_walls", "haptic_effect", "force_field", "haptic_path", "connections")
    entity = schema["$defs"]["EntitySpec"]["properties"]["components"]["properties"]
    assert {*names, "interaction_points"} <= set(entity)
    wanted = [component_types()[name].__name__ for name in names]
    wanted += [
        "BoxSolid",
        "CubeSolid",
        "SphereSolid",
        "CylinderSolid",
        "CapsuleSolid",
        "MeshSolid",
        "Wall",
        "Wire",
        "InteractionPoint",
    ]
    wanted += ["Spring", "PathSpring", "Viscosity", "ConstantForce", "Magnet", "Vibration", "StickSlip", "Workspace"]
    for name in [*wanted, "Guidance"]:
        for key, value in schema["$defs"][name]["properties"].items():
            assert key in ("shape", "kind") or "description" in json.dumps(value), f"{name}.{key}"


@pytest.mark.seconds
def test_trimesh_is_imported_only_for_models(tmp_path):
    """A scene without mesh shapes is checked without it."""
    code = (
        "import sys; from pathlib import Path; from tests.support.object_scenes import *;"
        "reported(Path(sys.argv[1]), thing('a', haptic_object={'shapes': [CUBE]}));"
        "assert 'trimesh' not in sys.modules"
    )
    subprocess.run([sys.executable, "-c", code, str(tmp_path)], check=True)
