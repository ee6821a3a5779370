"""What a scene file is refused for: every fault at once, each at its pointer, with the nearest right name."""

from __future__ import annotations

import json
import struct

import pytest
from PIL import Image

from mimics_app.contracts.errors import Issue, SceneError
from mimics_app.world.components.registry import register_check
from mimics_app.world.files.scene.file import load_scene
from tests.support.scenes import faults, scene, thing, write

BALL = thing("ball", ball={})


def the_fault(folder, document):
    found = faults(write(folder, document))
    assert len(found) == 1, found
    return found[0]


def test_an_empty_scene_is_right(tmp_path):
    assert faults(write(tmp_path, scene())) == []


def test_all_faults_are_reported_at_once_each_with_its_place(tmp_path):
    document = scene(
        thing("ball", bal={}, ball={"radius_mn": 0.1, "radius_max": -1}),
        {"id": "eye", "transfrom": {}, "components": {"camera": {"vertical_fov": "wide"}}},
        thing("skin", mesh={"primitive": {"shape": "box"}, "material": "rd"}),
        materials={"red": {"rougness": 0.5}},
        systems={"hapitc": {}},
    )
    assert faults(write(tmp_path, document)) == [
        'scene.json#/materials/red/rougness: unknown key "rougness"; did you mean "roughness"',
        'scene.json#/entities/1/transfrom: unknown key "transfrom"; did you mean "transform"',
        'scene.json#/entities/0/components/bal: unknown component "bal"; did you mean "ball"',
        'scene.json#/entities/0/components/ball/radius_mn: unknown key "radius_mn"; did you mean "radius_min"',
        "scene.json#/entities/0/components/ball/radius_max: expected a number > 0.0, got -1",
        "scene.json#/entities/1/components/camera/vertical_fov: expected a number, got a text",
        'scene.json#/systems/hapitc: unknown system "hapitc"; did you mean "haptic"',
        'scene.json#/entities/2/components/mesh/material: no material "rd"; did you mean "red"',
    ]


def test_few_names_are_listed_where_none_is_close(tmp_path):
    """The nearest name to "position" is "rotation"; what is meant is "translation"."""
    document = scene({"id": "ball", "transform": {"position": [0, 0, 0]}})
    assert faults(write(tmp_path, document)) == [
        'scene.json#/entities/0/transform/position: unknown key "position"; known: rotation, scale, translation'
    ]


def test_comment_keys_pass_everywhere_and_change_nothing(tmp_path):
    plain = scene(thing("ball", ball={"radius_min": 0.01}), materials={"red": {}})
    noted = json.loads(json.dumps(plain))
    noted["x-title"] = ["anything", {"at": None}]
    noted["entities"][0]["x-why"] = 1
    noted["entities"][0]["components"]["x-blender"] = "text"
    noted["entities"][0]["components"]["ball"]["x-note"] = {}
    noted["materials"]["red"]["x-from"] = "a book"
    one, other = load_scene(write(tmp_path, plain, "a.json")), load_scene(write(tmp_path, noted, "b.json"))
    assert one.hash == other.hash
    assert "x-blender" not in other.entities[0].components


@pytest.mark.parametrize("token", ["NaN", "Infinity", "-Infinity", "1e999"])
def test_a_number_that_is_not_finite_gets_the_pointer_of_its_value(tmp_path, token):
    text = json.dumps(scene(thing("wall", tunnel={"control_points": [[0, 0, 0], [1, 0, 0], [2, 0, "@"], [3, 0, 0]]})))
    assert the_fault(tmp_path, text.replace('"@"', token)).startswith(
        "scene.json#/entities/0/components/tunnel/control_points/2/2: "
    )


def test_a_nan_where_a_range_is_checked_is_reported_once(tmp_path):
    text = json.dumps(scene(thing("arm", admittance={"mass": "@"}))).replace('"@"', "NaN")
    assert the_fault(tmp_path, text) == (
        "scene.json#/entities/0/components/admittance/mass: nan is not a finite number; write a number"
    )


def test_a_key_that_stands_twice_is_reported_instead_of_dropped(tmp_path):
    text = '{"format": "mimics-scene", "version": 1, "entities": [{"id": "a", "components": {"ball": {}, "ball": {}}}]}'
    assert the_fault(tmp_path, text) == 'scene.json#/entities/0/components/ball: the key "ball" is given twice'


@pytest.mark.parametrize(
    ("text", "what"),
    [
        ("", "the file is empty"),
        ("  \n", "the file is empty"),
        ("{", "is not JSON"),
        ('{"format": "mimics-scene",}', "column"),
        ("[" * 3000 + "]" * 3000, "nested deeper than 128"),
        ('{"a":' * 150 + "1" + "}" * 150, "nested deeper than 128"),
        ("9" * 5000, "is not JSON"),
        ("[]", "is not a scene"),
        ('{"format": "gltf"}', "is not a scene"),
        ('{"format": "mimics-scene"}', "version None cannot be read"),
        ('{"format": "mimics-scene", "version": 99}', "version 99 cannot be read; this application reads up to 1"),
        ('{"format": "mimics-scene", "version": 0}', "version 0 cannot be read"),
        ('{"format": "mimics-scene", "version": true}', "version True cannot be read"),
        ('{"format": "mimics-scene", "version": "1"}', "cannot be read"),
    ],
)
def test_what_is_no_scene_at_all_is_said_so(tmp_path, text, what):
    assert what in the_fault(tmp_path, text)


def test_bytes_that_are_no_utf8_are_placed_and_a_byte_order_mark_is_not_minded(tmp_path):
    path = tmp_path / "scene.json"
    path.write_bytes(b'{"format": "\xff"}')
    assert faults(path) == ["scene.json: byte 12, in line 1, is not UTF-8; save the file as UTF-8"]
    path.write_bytes(b"\xef\xbb\xbf" + json.dumps(scene()).encode())
    assert faults(path) == []


def test_a_missing_file_and_a_folder_are_reported(tmp_path):
    assert faults(tmp_path / "none.json") == ["none.json: no such file"]
    assert "cannot be read" in faults(tmp_path)[0]


def test_units_and_axes_other_than_ours_are_refused(tmp_path):
    found = faults(write(tmp_path, scene(units="cm", up="+Z")))
    assert found == [
        'scene.json#/units: "cm" is not possible here; known: m-kg-s',
        'scene.json#/up: "+Z" is not possible here; known: +Y',
    ]


def test_an_id_twice_names_the_first(tmp_path):
    assert the_fault(tmp_path, scene(BALL, BALL)) == (
        'scene.json#/entities/1/id: the id "ball" is taken by scene.json#/entities/0/id; choose another id'
    )


@pytest.mark.parametrize("name", ["", "a b", "a/b", "a#b", "é"])
def test_ids_that_references_could_not_name_are_refused(tmp_path, name):
    assert "is not an id" in the_fault(tmp_path, scene(thing(name)))


def test_an_unknown_parent_gets_the_nearest_name(tmp_path):
    document = scene(thing("robot"), {"id": "hand", "parent": "robt"})
    assert the_fault(tmp_path, document) == 'scene.json#/entities/1/parent: no entity "robt"; did you mean "robot"'


@pytest.mark.parametrize("names", ["a", "ab", "abc"])
def test_entities_that_hang_on_themselves_are_reported_once_with_the_loop(tmp_path, names):
    entities = [{"id": name, "parent": names[(i + 1) % len(names)]} for i, name in enumerate(names)]
    entities.append({"id": "tail", "parent": "a"})
    found = the_fault(tmp_path, scene(*entities))
    assert "hangs on itself: a -> " in found


def test_a_chain_of_parents_too_deep_for_recursion_is_one_fault(tmp_path):
    touched = {"haptic_object": {"shapes": [{"shape": "sphere", "radius": 0.1}]}}
    links = [{"id": f"e{i}", "parent": f"e{i - 1}" if i else None} for i in range(3000)]
    links[-1]["components"] = touched
    assert "more than 256 entities hang on each other" in the_fault(tmp_path, scene(*links))


@pytest.mark.parametrize("key", ["\u00b2", "9" * 5000])
def test_a_key_of_digits_that_meets_a_list_in_a_prefab_has_a_place(tmp_path, key):
    document = scene({"id": "a", "prefab": "p", "components": {"light": {key: 1}}})
    document["prefabs"] = {"p": {"components": {"light": [1]}}}
    assert any("/entities/0/components/light/" in fault for fault in faults(write(tmp_path, document)))


def test_an_asset_that_cannot_be_read_is_reported_where_it_is_named(tmp_path, monkeypatch):
    def refuse(*_):
        raise PermissionError(13, "Permission denied")

    (tmp_path / "path.csv").write_text("x,y,z\n")
    monkeypatch.setattr("mimics_app.world.files.scene.model_shelf.open_regular", refuse)
    found = the_fault(tmp_path, scene(assets={"path": {"uri": "path.csv"}}))
    assert found == 'scene.json#/assets/path/uri: "path.csv" cannot be read: Permission denied'


@pytest.mark.parametrize(
    ("transform", "what"),
    [
        ({"rotation": [0, 0, 0, 0]}, "/rotation: a quaternion of length 0 instead of 1"),
        ({"rotation": [0, 0, 0.5, 1]}, "/rotation: a quaternion of length 1.118"),
        ({"rotation": [0, 0, 1]}, "/rotation: expected a list [..] of length 4, got 3"),
        ({"scale": [1, 0, 1]}, "/scale/1: a scale of 0"),
        ({"translation": 3}, "/translation: expected a list [..], got a whole number"),
        ({"translaton": [0, 0, 0]}, '/translaton: unknown key "translaton"; did you mean "translation"'),
    ],
)
def test_transforms_that_are_none(tmp_path, transform, what):
    assert what in the_fault(tmp_path, scene({"id": "a", "transform": transform}))


def test_a_quaternion_written_with_four_decimals_and_a_mirror_pass(tmp_path):
    turn = {"rotation": [0.7071, 0, 0, 0.7071], "scale": [-1, 1, 1]}
    assert faults(write(tmp_path, scene({"id": "a", "transform": turn}))) == []


@pytest.mark.parametrize(
    ("components", "what"),
    [
        ({"admittance": {"mass": -3}}, "admittance/mass: expected a number >= 0.001, got -3"),
        ({"admittance": {"form": "polr"}}, 'admittance/form: "polr" is not possible here; did you mean "polar"'),
        ({"ball": {"radius_min": 0.05}}, "ball/radius_min: 0.05 m is above radius_max"),
        ({"joint_pd": {"kd": [0, 1, 0]}}, "joint_pd/kd/1: 1 is unstable"),
        ({"safety": {"late_hold_s": 0.02}}, "safety/late_hold_s: 0.02 s is not below late_damp_s, 0.01 s"),
        ({"safety": {"stale_warn_s": 0.02}}, "safety/stale_warn_s"),
        (
            {"robot": {"robot_to_world": {"rotation": [[1, 0, 0], [0, 1, 0], [0, 0, -1]]}}},
            "robot/robot_to_world/rotation: is not a rotation: it mirrors",
        ),
        (
            {"robot": {"robot_to_world": {"rotation": [[1, 0, 0], [0, 1, 0.1], [0, 0, 1]]}}},
            "robot/robot_to_world/rotation: is not a rotation: its rows are off by 0.1",
        ),
        ({"robot": {"joint_min": [0.3, -0.5, -0.2]}}, "robot/joint_max/0: 0.18 is not above joint_min, 0.3"),
        ({"robot": {"joint_min": [-0.5, -0.5, -0.2]}}, "robot/joint_min/0: -0.5 exceeds the device's own limit, -0.18"),
        ({"robot": {"joint_max": [0.1, 4.0, 0.2]}}, "robot/joint_max/1: 4 exceeds the device's own limit"),
        (
            {"robot": {"velocity_limit": [1e5, 0.1, 0.1]}},
            "robot/velocity_limit/0: 100000 exceeds the device's own limit",
        ),
        ({"robot": {"axis_offset": 0.1}}, "robot/joint_min/0: the arm could reach through the axis"),
        ({"robot": {"masses": [3, 0, 3]}}, "robot/masses/1: a moving mass must be greater than 0"),
        ({"tunnel": {}}, "tunnel: needs either control_points or a path_file"),
        ({"tunnel": {"control_points": [[0, 0, 0]]}}, "tunnel/control_points: 1 control points; a cubic takes 4 to 99"),
        ({"tunnel": {"path_file": "no.csv"}}, 'tunnel/path_file: no file "no.csv"'),
        (
            {"tunnel": {"control_points": [[0, 0, 0]] * 5, "basis_functions": 9}},
            "tunnel/basis_functions: applies to a path_file",
        ),
        ({"mesh": {}}, "mesh: needs either a primitive or a source"),
        (
            {"mesh": {"primitive": {"shape": "bx"}}},
            'mesh/primitive/shape: "bx" is not possible here; did you mean "box"',
        ),
        ({"mesh": {"primitive": {"size": [1, 1, 1]}}}, 'mesh/primitive: the key "shape" is missing; one of: box,'),
        (
            {"mesh": {"primitive": {"shape": "ring", "inner_radius": 0.6}}},
            "mesh/primitive/inner_radius: 0.6 m is not inside outer_radius",
        ),
        ({"mesh": {"source": "robot"}}, 'mesh/source: no asset "robot"; the scene has none'),
        ({"camera": {"near": 2, "far": 1}}, "camera/far: 1 m is not beyond near, 2 m"),
        ({"light": {"kind": "spot", "inner_cone": 1.0}}, "light/inner_cone: 1 rad is not inside outer_cone"),
        ({"light": {"range": 0}}, "light/range: expected a number > 0.0, got 0"),
        ({"sound": {}}, "sound: needs either an asset or a synth recipe"),
        (
            {"sound_emitter": {"sound": "bell"}},
            'sound_emitter/sound: no entity with a "sound" "bell"; the scene has none',
        ),
        ({"sound_emitter": {}}, 'sound_emitter: the key "sound" is missing'),
        ({"tunnel_view": {"material": "glas"}}, 'tunnel_view/material: no material "glas"'),
        ({"ball": 3}, "ball: expected an object"),
    ],
)
def test_components_whose_values_cannot_be(tmp_path, components, what):
    found = faults(write(tmp_path, scene(thing("a", **components))))
    assert len(found) == 1, found
    assert f"#/entities/0/components/{what}" in found[0]


def test_a_reference_is_not_led_to_an_entity_that_could_not_be_read(tmp_path):
    broken, asking = thing("bel", light={"range": 0}), thing("a", sound_emitter={"sound": "bell"})
    found = faults(write(tmp_path, scene(broken, asking)))
    assert any('no entity with a "sound" "bell"; the scene has none' in each for each in found), found
    found = faults(write(tmp_path, scene(broken, thing("a", sound_emitter={"sound": "bel"}))))
    assert len(found) == 1, "the light's: what bel was to be is not known"


def test_a_second_environment_names_the_first(tmp_path):
    found = the_fault(tmp_path, scene(thing("a", environment={}), thing("b", environment={})))
    assert '/entities/1/components/environment: a second "environment"' in found
    assert "/entities/0/components/environment" in found


def picture(path, size=(2, 2)):
    Image.new("RGB", size, (255, 0, 0)).save(path)


def test_assets_that_cannot_be_used_are_reported_where_they_are_named(tmp_path):
    picture(tmp_path / "red.png")
    (tmp_path / "cut.png").write_bytes((tmp_path / "red.png").read_bytes()[:40])
    (tmp_path / "fake.wav").write_bytes(b"RIFF....JUNK")
    (tmp_path / "notes.txt").write_text("x")
    uris = {"a": "rd.png", "b": "cut.png", "c": "fake.wav", "d": "notes.txt", "e": "", "f": "models/none.glb"}
    found = faults(write(tmp_path, scene(assets={key: {"uri": uri} for key, uri in uris.items()})))
    assert [line.split(": ")[0] for line in found] == [f"scene.json#/assets/{key}/uri" for key in uris]
    assert 'no file "rd.png"; did you mean "red.png"' in found[0]
    assert "neither PNG nor JPEG" in found[1]
    assert "is not in WAV format" in found[2]
    assert "is of an unknown kind" in found[3]
    assert "an empty file name" in found[4]
    assert 'there is no folder "models"' in found[5]


def test_a_missing_texture_is_reported_where_it_is_named_and_where_it_is_not_even_an_asset(tmp_path):
    picture(tmp_path / "red.png")
    document = scene(
        assets={"red": {"uri": "red.png"}, "gone": {"uri": "gone.png"}, "path": {"uri": "p.csv"}},
        materials={
            "a": {"base_texture": "red"},
            "b": {"base_texture": "gone"},
            "c": {"base_texture": "rd"},
            "d": {"base_texture": "path"},
        },
    )
    (tmp_path / "p.csv").write_text("x,y,z\n")
    assert faults(write(tmp_path, document)) == [
        'scene.json#/assets/gone/uri: no file "gone.png"; did you mean "red.png"',
        'scene.json#/materials/c/base_texture: no asset "rd"; did you mean "red"',
        'scene.json#/materials/d/base_texture: asset "path" is a path, not a picture',
    ]


def test_a_picture_of_too_many_pixels_is_refused_from_its_header(tmp_path):
    header = (
        b"\x89PNG\r\n\x1a\n" + struct.pack(">I", 13) + b"IHDR" + struct.pack(">IIBBBBB", 60000, 60000, 8, 2, 0, 0, 0)
    )
    (tmp_path / "bomb.png").write_bytes(header + b"\0" * 64)
    found = the_fault(tmp_path, scene(assets={"a": {"uri": "bomb.png"}}))
    assert "bomb.png" in found


@pytest.mark.parametrize(
    "uri",
    [
        "../secret.wav",
        "/etc/passwd",
        "a/../../secret.wav",
        "%2e%2e/secret.wav",
        "http://x/y.wav",
        "file:///x.wav",
        "C:/x.wav",
        "a\\b.wav",
        "%00.wav",
    ],
)
def test_file_names_that_lead_out_of_the_folder_are_refused(tmp_path, uri):
    inside = tmp_path / "inside"
    inside.mkdir()
    (tmp_path / "secret.wav").write_bytes(b"RIFF....WAVE")
    found = the_fault(inside, scene(assets={"a": {"uri": uri}}))
    assert found.startswith("scene.json#/assets/a/uri: ")
    assert 'no file "' not in found


def test_a_link_that_leads_out_of_the_folder_is_refused(tmp_path):
    inside = tmp_path / "inside"
    inside.mkdir()
    (tmp_path / "secret.wav").write_bytes(b"RIFF....WAVE")
    (inside / "link.wav").symlink_to(tmp_path / "secret.wav")
    assert "leads out of the folder" in the_fault(inside, scene(assets={"a": {"uri": "link.wav"}}))


def test_a_later_check_does_not_see_a_component_an_earlier_one_refused(tmp_path):
    seen = []

    def late(ball, pointer, loaded):
        seen.append(pointer)
        return [Issue("", "", "late")] if ball.grasp_force_full == 99 else []

    register_check("ball", late)
    assert len(faults(write(tmp_path, scene(thing("a", ball={"radius_min": 1.0}))))) == 1
    assert seen == []
    assert faults(write(tmp_path, scene(thing("a", ball={"grasp_force_full": 99})))) == ["late"]


def test_components_of_an_unknown_type_cannot_be_asked_for(tmp_path):
    loaded = load_scene(write(tmp_path, scene(BALL)))
    with pytest.raises(KeyError, match='did you mean "ball"'):
        loaded.components("bal")
    with pytest.raises(SceneError, match='no entity has a "tunnel"'):
        from mimics_app.world.components.robot import Tunnel

        loaded.one(Tunnel)
    with pytest.raises(KeyError, match='did you mean "ball"'):
        loaded.entity("bll")


@pytest.mark.parametrize("shape", ["sphere", "cylinder", "torus"])
def test_shape_too_large_for_finite_vertices_is_refused(tmp_path, shape):
    document = scene(thing("a", mesh={"primitive": {"shape": shape, "radius": 1e308}}))
    assert "/entities/0/components/mesh/primitive/radius: expected a number <= 1000000" in the_fault(tmp_path, document)


@pytest.mark.parametrize(
    ("text", "place"),
    [
        (r'{"title": "\ud800"}', "#/title"),
        (r'{"entities": [{"id": "a", "x-note": ["b", "\udfff"]}]}', "#/entities/0/x-note/1"),
        (r'{"include": ["\ud800.json"]}', "#/include/0"),
        (r'{"\ud800": 1}', ""),
    ],
)
def test_half_a_character_is_reported_with_its_place(tmp_path, text, place):
    """A lone surrogate passes JSON and then breaks whatever writes, shows or hashes the text."""
    (tmp_path / "scene.json").write_text(text)
    with pytest.raises(SceneError) as raised:
        load_scene(tmp_path / "scene.json")
    said = [str(issue) for issue in raised.value.issues if "half of a character" in str(issue)]
    assert len(said) == 1
    assert f"scene.json{place}: " in said[0]
    assert said[0].encode()


def test_a_whole_character_in_two_escapes_is_right(tmp_path):
    document = {**scene(), "title": "\U0001f600"}
    (tmp_path / "scene.json").write_text(json.dumps(document, ensure_ascii=True))
    assert load_scene(tmp_path / "scene.json").name
