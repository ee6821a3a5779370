"""`mimics check` and `mimics schema`: one line an error, exit 3, one object with --json; one schema for all types."""

from __future__ import annotations

import json
from pathlib import Path

import msgspec
import pytest

from mimics_app.app.cli import main
from mimics_app.contracts.system.resources import root
from mimics_app.world.components.registry import component_types, system_types
from mimics_app.world.files.scene.schema import scene_schema
from tests.support.gltf_maker import square, write_gltf
from tests.support.scenes import scene, thing, write


def test_right_files_exit_0_and_say_what_they_hold(tmp_path, capsys):
    files = [write(tmp_path, scene(thing("a"))), write_gltf(tmp_path / "m.gltf", square())]
    assert main(["check", *map(str, files)]) == 0
    printed = capsys.readouterr()
    assert "scene.json: ok (1 entity" in printed.out
    assert "m.gltf: ok (1 node, 1 mesh" in printed.out
    assert printed.err == ""


def test_every_error_of_every_file_is_one_line_and_the_exit_is_3(tmp_path, capsys):
    document = square()
    document["nodes"][0]["mesh"] = 4
    wrong = write(tmp_path, scene(thing("a", bal={}, ball={"radius_min": -1})))
    model = write_gltf(tmp_path / "m.gltf", document)
    right = write(tmp_path, scene(), "right.json")
    assert main(["check", str(wrong), str(right), str(model), str(tmp_path / "none.json")]) == 3
    printed = capsys.readouterr()
    lines = printed.err.strip().splitlines()
    assert len(lines) == 4
    assert 'scene.json#/entities/0/components/bal: unknown component "bal"; did you mean "ball" (line 1, ' in lines[0]
    assert "#/entities/0/components/ball/radius_min: expected a number > 0.0" in lines[1]
    assert "m.gltf#/nodes/0/mesh: there is no mesh 4; the file has 1 mesh" in lines[2]
    assert "none.json" in lines[3]
    assert "right.json: ok" in printed.out


def place_in(file: Path, value: str, after: str) -> dict[str, int]:
    """Line and column of the value behind a text of a file of one line."""
    text = file.read_text()
    return {"line": 1, "column": text.index(after + value) + len(after) + 1}


def test_a_fault_is_reported_with_its_line_and_column(tmp_path, capsys):
    file = tmp_path / "scene.json"
    text = '{"format": "mimics-scene", "version": 1,\n "entities": [\n  {"id": "a", "components": {"bal": {}}}\n ]}'
    file.write_text(text)
    assert main(["check", str(file)]) == 3
    assert "#/entities/0/components/bal: " in (printed := capsys.readouterr().err)
    assert f"(line 3, column {text.splitlines()[2].index('{}') + 1})" in printed


def test_with_json_there_is_one_object_with_files_and_errors(tmp_path, capsys):
    wrong, right = write(tmp_path, scene(thing("a", bal={}))), write(tmp_path, scene(), "right.json")
    assert main(["check", str(wrong), str(right), "--json"]) == 3
    answer = json.loads(capsys.readouterr().out)
    assert list(answer)[:2] == ["schema", "command"]
    assert [(entry["file"], entry["ok"]) for entry in answer["files"]] == [(str(wrong), False), (str(right), True)]
    assert answer["errors"] == [
        {
            "file": str(wrong),
            "pointer": "/entities/0/components/bal",
            "what": 'unknown component "bal"',
            "fix": 'did you mean "ball"',
            **place_in(wrong, "{}", after='"bal": '),
        }
    ]


def test_what_follows_from_a_fault_is_not_reported_beside_it(tmp_path, capsys):
    wire = {"wires": [{"from": "ball.p_obj", "to": "ball.F_aux"}]}
    ball = thing("ball", haptic_object={"shapes": [{"shape": "sphere", "radius": 0.1}], "stifness": 3})
    wrong = write(tmp_path, scene(ball, thing("wires", connections=wire)))
    lost = write(tmp_path, {**scene({"id": "a", "prefab": "robot"}), "include": ["no.json"]}, "lost.json")
    assert main(["check", str(wrong), str(lost)]) == 3
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 2
    assert 'unknown key "stifness"' in lines[0]
    assert 'no file "no.json"' in lines[1]


@pytest.mark.parametrize(
    ("text", "advice"),
    [('{"a": 1 // one\n}', "no comments"), ('{"a": 1,}', "remove the comma"), ('{"a": [1', "before every bracket"),
     ('{"a": 1 "b": 2}', "a comma or a closing"), ("{'a': 1}", 'write "'), ("{} {}", "last bracket")],
)  # fmt: skip
def test_a_text_that_is_no_json_is_met_with_advice(tmp_path, capsys, text, advice):
    (tmp_path / "scene.json").write_text(text)
    assert main(["check", str(tmp_path / "scene.json")]) == 3
    assert advice in capsys.readouterr().err


def test_sounds_that_cannot_be_made_are_refused_as_by_run(tmp_path, capsys):
    (tmp_path / "odd.wav").write_bytes(b"RIFFxxxxWAVE")
    sounds = thing("a", sound={"synth": "bongo"}), thing("b", sound={"asset": "odd"})
    assert main(["check", str(write(tmp_path, {**scene(*sounds), "assets": {"odd": {"uri": "odd.wav"}}}))]) == 3
    told = capsys.readouterr().err
    assert '/entities/0/components/sound/synth: no recipe "bongo"' in told
    assert "/entities/1/components/sound/asset: odd.wav cannot be read as a sound" in told


def test_what_is_likely_not_meant_is_pointed_at(tmp_path, capsys):
    robot = {"id": "robot", "prefab": "robot"}
    room = {"include": ["mimics:scenes/parts/touch_room.json"], "scenario": "none"}
    wide = thing("wide", haptic_object={"shapes": [{"shape": "sphere", "radius": 40.0}], "enable_translation": False})
    far = thing("far", haptic_object={"shapes": [{"shape": "sphere", "radius": 0.04}], "enable_translation": False})
    far["transform"] = {"translation": [100.0, 0.0, 0.0]}
    heard = thing("heard", sound={"synth": "apple", "trigger": "contakt"})
    assert main(["check", str(write(tmp_path, {**scene(robot, wide, far, heard), **room}))]) == 0
    told = capsys.readouterr().out
    assert '"wide" is 80 m wide; lengths are metres (line 1, ' in told
    assert '"far" is 100.0 m' in told and "out of its reach" in told
    assert 'did you mean "contact"' in told
    assert told.count("components/haptic_object") == 2


def test_a_scenario_that_is_nowhere_is_refused(tmp_path, capsys):
    document = {**scene(), "scenario": "wavy_tunel"}
    assert main(["check", str(write(tmp_path, document))]) == 3
    assert '/scenario: no scenario "wavy_tunel"; leave it out; did you mean "wavy_tunnel"' in capsys.readouterr().err


def test_a_hairpin_is_refused_by_check_as_by_run(tmp_path, capsys):
    bend = [[0, 0, 0], [0.1, 0, 0], [0.2, 0, 0], [0.2, 0.01, 0], [0.1, 0.01, 0], [0, 0.01, 0]]
    wrong = write(tmp_path, scene(thing("t", tunnel={"control_points": bend, "radius": 0.05})))
    assert main(["check", str(wrong)]) == 3
    assert "scene.json#/entities/0/components/tunnel" in capsys.readouterr().err


def test_the_schema_names_every_component_and_system_with_units(capsys):
    assert main(["schema"]) == 0
    schema = json.loads(capsys.readouterr().out)
    definitions = schema["$defs"]
    whole = definitions["EntitySpec"]["then"]["properties"]["components"]["properties"]
    assert set(whole) == set(component_types())
    assert set(definitions["SceneSpec"]["properties"]["systems"]["properties"]) == set(system_types())
    assert definitions["Tunnel"]["properties"]["stiffness"]["description"].endswith("[N/m]")
    assert definitions["Tunnel"]["description"].startswith("The tunnel of D2.1")
    assert "task" in definitions["SceneSpec"]["properties"]


def test_the_schema_can_be_written_to_a_file_or_not_at_all(tmp_path, capsys):
    assert main(["schema", "--out", str(tmp_path / "s.json")]) == 0
    assert capsys.readouterr().out == ""
    assert json.loads((tmp_path / "s.json").read_text()) == json.loads(json.dumps(scene_schema()))
    assert main(["schema", "--out", str(tmp_path / "no" / "s.json")]) == 3


def test_the_schema_has_no_dangling_reference():
    schema = scene_schema()
    text = json.dumps(schema)
    references = {part.split('"')[0] for part in text.split('"#/$defs/')[1:]}
    assert references <= set(schema["$defs"])
    assert len(references) > 30


@pytest.mark.parametrize("name", sorted(component_types()))
def test_every_component_says_what_each_field_means(name):
    struct = component_types()[name]
    assert struct.__doc__
    schema = msgspec.json.schema_components([struct])[1][struct.__name__]
    for field, definition in schema["properties"].items():
        assert definition.get("description") or any("description" in part for part in definition.get("anyOf", [])), (
            field
        )


def test_part_that_the_scenario_misses_is_reported_by_check_as_by_run(tmp_path, capsys):
    document = json.loads((root() / "scenes" / "wavy_tunnel.json").read_text())
    del next(entity for entity in document["entities"] if entity["id"] == "ball")["components"]["ball"]
    file = write(tmp_path, document, "wavy_tunnel.json")
    for words in (["check", str(file)], ["run", str(file), "--headless", "--runs", str(tmp_path)]):
        assert main(words) == 3
        assert 'wavy_tunnel.json#/entities: no entity has a "ball"' in capsys.readouterr().err


def test_ball_may_have_any_name(tmp_path, capsys):
    text = (root() / "scenes" / "wavy_tunnel.json").read_text()
    file = tmp_path / "mine.json"
    file.write_text(text.replace('"id": "ball"', '"id": "my_ball"').replace('"tunnel", "ball"', '"tunnel", "my_ball"'))
    assert main(["check", str(file)]) == 0


def test_scene_that_no_scenario_plays_is_right_and_noted(tmp_path, capsys):
    assert main(["check", str(write(tmp_path, scene(thing("a"))))]) == 0
    assert "mimics run needs a robot" in capsys.readouterr().out


@pytest.mark.parametrize("device", ["pointr", "pointer:somewhere"])
def test_a_device_that_nobody_has_is_exit_code_4_with_its_place(tmp_path, capsys, device: str):
    file = write(tmp_path, scene(thing("a", robot={"device": device})))
    assert main(["check", str(file)]) == 4
    printed = capsys.readouterr().err
    assert "scene.json#/entities/0/components/robot/device" in printed
    assert 'pointer"' in printed


def test_a_device_that_nobody_has_keeps_its_place_where_reach_is_checked(tmp_path, capsys):
    document = json.loads((root() / "scenes" / "wavy_tunnel.json").read_text())
    robots = [index for index, entity in enumerate(document["entities"]) if "robot" in entity.get("components", {})]
    document["entities"][robots[0]]["components"]["robot"]["device"] = "pointr"
    assert main(["check", str(write(tmp_path, document))]) == 4
    assert f"scene.json#/entities/{robots[0]}/components/robot/device: there is no device" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("field", "words", "said"),
    [
        ("learn", "stair", 'there is no policy "stair"; did you mean "staircase"'),
        ("estimator", "lad", 'there is no estimator "lad"; did you mean "lda"'),
        ("goal", "succes:0.7", 'unknown goal "succes:0.7": task, success:SHARE'),
    ],
)
def test_policy_goal_and_estimator_of_a_task_must_be_there(tmp_path, capsys, field: str, words: str, said: str):
    assert main(["check", str(write(tmp_path, scene(thing("a"), task={field: words})))]) == 3
    assert f"scene.json#/task/{field}: {said}" in capsys.readouterr().err


@pytest.mark.parametrize("part", sorted((root() / "scenes" / "parts").glob("*.json")), ids=lambda file: file.stem)
def test_shipped_part_is_right_by_itself_and_says_what_it_is_for(capsys, part):
    assert main(["check", str(part)]) == 0
    printed = capsys.readouterr().out
    assert "a part, " in printed


def test_hand_without_robot_and_task_is_a_part(tmp_path, capsys):
    fingers = [thing("left"), thing("right"), thing("hand", grasping_hand={"fingers": ["left", "right"]})]
    assert main(["check", str(write(tmp_path, scene(*fingers)))]) == 0
    assert "a part, without robot and task: include it in a scene" in capsys.readouterr().out
    assert main(["check", str(write(tmp_path, scene(*fingers, thing("r", robot={}))))]) == 3
    assert "the scenario needs carry in the task" in capsys.readouterr().err


def test_faults_of_several_stages_are_reported_at_once(tmp_path, capsys):
    """Two scaled bodies, a policy that is nowhere: what one stage cannot get past does not hide the others."""
    body = {"haptic_object": {"shapes": [{"shape": "box", "size": [0.1, 0.1, 0.1]}]}}
    scaled = [{**thing(name, **body), "transform": {"scale": [2.0, 2.0, 2.0]}} for name in ("first", "second")]
    file = write(tmp_path, scene(*scaled, task={"learn": "nowhere"}))
    assert main(["check", str(file)]) == 3
    lines = capsys.readouterr().err.strip().splitlines()
    assert sum("/transform/scale" in line and '"parent"' in line for line in lines) == 2
    assert sum("/task/learn" in line for line in lines) == 1 and len(lines) == 3
