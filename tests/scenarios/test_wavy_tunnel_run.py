"""`mimics run scenes/wavy_tunnel.json` as a script meets it: one object, a run folder, a report, a repeatable hash."""

from __future__ import annotations

import json
import math
import re
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pyarrow.ipc
import pytest

from mimics_app.app.cli import main
from mimics_app.contracts.system.resources import root
from tests.support.command import mimics

SCENE = root() / "scenes" / "wavy_tunnel.json"


def started(*arguments: object) -> subprocess.CompletedProcess[str]:
    """As a script starts it: a process."""
    command = [sys.executable, "-m", "mimics_app.app.cli", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, timeout=240, check=False)


def run(folder: Path, *arguments: object, scene: Path = SCENE, seed: int = 7, by: Any = mimics) -> dict[str, Any]:
    options = ("--headless", "--seconds", 20, "--seed", seed, "--json", "--runs", folder)
    done = by("run", scene, *options, *arguments)
    assert done.returncode == 0, done.stderr
    answer: dict[str, Any] = json.loads(done.stdout)
    return answer


def changed_scene(folder: Path, change: Any) -> Path:
    document = json.loads(SCENE.read_text())
    change(document)
    path = folder / "wavy_tunnel.json"
    path.write_text(json.dumps(document))
    return path


def entity(document: dict[str, Any], name: str) -> dict[str, Any]:
    found: dict[str, Any] = next(e for e in document["entities"] if e["id"] == name)
    return found["components"]


@pytest.fixture(scope="module")
def answer(tmp_path_factory) -> dict[str, Any]:
    return run(tmp_path_factory.mktemp("runs"), "--pictures", 2, "--sound", "file", by=started)


def test_answer_has_the_keys_scripts_rely_on(answer):
    assert list(answer)[:2] == ["schema", "command"]
    wanted = {"seed", "simulated_s", "wall_s", "ticks", "frames", "state_hash", "scene_hash", "run_dir", "report"}
    assert wanted | {"task", "safety", "recipe", "audio", "unread"} <= set(answer)
    assert {"completed", "trials", "score", "time_s", "path_error_m", "contacts"} <= set(answer["task"])
    assert set(answer["safety"]) == {"state", "stops", "holds"}
    assert not {"lateness_us", "missed"} & set(answer)  # on a virtual clock no tick can be late
    assert {"device", "sink"} <= set(answer["audio"])
    assert (answer["ticks"], answer["frames"], answer["unread"]) == (20_000, 1200, [])


@pytest.mark.parametrize("patient", [pytest.param("moderate", marks=pytest.mark.slow), "severe"])
def test_the_easiest_tunnel_earns_more_than_the_hardest(patient, tmp_path):
    """A policy makes the task easier for who earns too little: were it the other way round, it would do so for ever."""

    def points(difficulty: str, radius: float, assistance: float) -> float:
        def change(document: dict[str, Any]) -> None:
            trial = {"label": difficulty, "values": {"radius": radius, "assistance": assistance}}
            document["task"]["trials"] = [{"name": difficulty, "trials": [trial]}]

        folder = tmp_path / difficulty
        folder.mkdir()
        options = ("--patient", patient, "--seconds", 32, "--pictures", 0, "--sound", "off")
        task = run(folder, *options, scene=changed_scene(folder, change))["task"]
        assert task["completed"] == 1
        return task["score"]

    limits = json.loads(SCENE.read_text())["task"]["parameters"]
    radius, assistance = limits["radius"], limits["assistance"]
    easiest = points("easiest", radius["max"], assistance["max"])
    assert easiest > points("hardest", radius["min"], assistance["min"])


def test_the_patient_travels_the_tunnel(answer):
    assert answer["task"]["practice"]["completed"] == 1  # the slow drives leave no time for a trial in 20 s
    assert answer["safety"] == {"state": answer["safety"]["state"], "stops": 0, "holds": 0}


def test_run_folder_can_be_read_by_anyone(answer):
    folder = Path(answer["run_dir"])
    for file in ("haptic.arrows", "parameters.arrows"):
        with pyarrow.ipc.open_stream(folder / file) as stream:
            assert stream.read_all().num_rows > 0
    assert json.loads((folder / "manifest.json").read_text())["state_hash"] == answer["state_hash"]
    report = Path(answer["report"]).read_text()
    assert "http://" not in report.replace("http://www.w3.org", "")
    assert len(list((folder / "pictures").glob("*.png"))) == 2


def test_replay_is_equal_bit_for_bit_and_one_flipped_bit_is_seen(answer, tmp_path):
    done = mimics("replay", answer["run_dir"], "--json")
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["ticks"] == 20_000
    spoilt = tmp_path / "spoilt"
    spoilt.mkdir()
    for file in Path(answer["run_dir"]).iterdir():
        if file.is_file():
            (spoilt / file.name).write_bytes(file.read_bytes())
    lines = (spoilt / "events.jsonl").read_text().splitlines(keepends=True)
    contact = next(i for i, line in enumerate(lines) if '"contact_begin"' in line)
    forged = re.sub(r'"force":([0-9.e-]+)', lambda force: f'"force":{2 * float(force[1])}', lines[contact])
    (spoilt / "events.jsonl").write_text("".join([*lines[:contact], forged, *lines[contact + 1 :]]))
    done = mimics("replay", spoilt)
    assert done.returncode == 6 and "event" in done.stderr and "force" in done.stderr
    (spoilt / "events.jsonl").write_text("".join(lines))
    content = bytearray((spoilt / "haptic.arrows").read_bytes())
    content[len(content) // 2] ^= 1
    (spoilt / "haptic.arrows").write_bytes(content)
    assert mimics("replay", spoilt).returncode == 6


@pytest.mark.parametrize(
    ("file", "was", "becomes", "said"),
    [
        ("events.jsonl", r'("kind":"state",.*"state":)"travel"', r'\1"rest"', "(state), state: recorded 'rest'"),
        ("trials.csv", r"(?m)^0,1,practice,", "0,1,other,", "trials.csv row 0, block: recorded 'other'"),
        ("session.json", r'("ready_s": )[0-9.]+', r"\g<1>0.1", "task event"),
    ],
)
def test_a_changed_event_or_figure_of_the_task_is_named_by_its_replay(
    answer, tmp_path, capsys, file, was, becomes, said
):
    spoilt = tmp_path / "spoilt"
    shutil.copytree(answer["run_dir"], spoilt)
    text, count = re.subn(was, becomes, (spoilt / file).read_text())
    assert count >= 1
    (spoilt / file).write_text(text)
    assert main(["replay", str(spoilt)]) == 6
    assert said in capsys.readouterr().err


def test_every_file_of_a_run_is_its_users_alone(answer):
    """Also what is written by others than the recorder: pictures and sound."""
    folder = Path(answer["run_dir"])
    assert folder.stat().st_mode & 0o777 == 0o700
    modes = {path.name: path.stat().st_mode & 0o777 for path in folder.rglob("*")}
    assert {"sound.wav", "pictures", "haptic.arrows", "report.html"} <= set(modes)
    assert all(mode == (0o700 if name == "pictures" else 0o600) for name, mode in modes.items()), modes


def test_same_seed_same_hash_another_seed_another(answer, tmp_path):
    assert run(tmp_path, "--pictures", 0)["state_hash"] == answer["state_hash"]
    short = [run(tmp_path, "--pictures", 0, "--seconds", 2, seed=seed)["state_hash"] for seed in (7, 8)]
    assert short[0] != short[1]


def test_one_ulp_of_wall_stiffness_changes_the_hash(answer, tmp_path):
    """The scene's stiffness reaches the wall through the task's parameter, whose default is the scene's own."""

    def one_ulp(document: dict[str, Any]) -> None:
        tunnel = entity(document, "tunnel")["tunnel"]
        tunnel["stiffness"] = math.nextafter(tunnel["stiffness"], math.inf)

    other = run(tmp_path, "--pictures", 0, scene=changed_scene(tmp_path, one_ulp))
    assert other["state_hash"] != answer["state_hash"]


def test_action_file_changes_the_task_and_is_checked(tmp_path):
    actions = tmp_path / "actions.json"
    actions.write_text(json.dumps([{"t": 0.5, "values": {"assistance": 1.0}}]))
    helped = run(tmp_path, "--action", actions, "--pictures", 0, "--seconds", 2)
    lines = [json.loads(line) for line in (Path(helped["run_dir"]) / "events.jsonl").read_text().splitlines()]
    assert any(line.get("kind") == "action" for line in lines)
    actions.write_text(json.dumps([{"t": 0.5, "values": {"asistance": 1.0}}]))
    refused = mimics("run", SCENE, "--headless", "--action", actions, "--runs", tmp_path)
    assert refused.returncode == 3
    assert "#/0/values/asistance" in refused.stderr and '"assistance"' in refused.stderr


def misspell(document: dict[str, Any]) -> None:
    tunnel = entity(document, "tunnel")["tunnel"]
    tunnel["stifness"] = tunnel.pop("stiffness")


def put_nan(document: dict[str, Any]) -> None:
    entity(document, "robot")["admittance"]["mass"] = math.nan


def bend_to_a_hairpin(document: dict[str, Any]) -> None:
    points = entity(document, "tunnel")["tunnel"]["control_points"]
    points[6:6] = [[0.002, 0.10, 0.0], [0.004, 0.10, 0.0]]


def lose_a_texture(document: dict[str, Any]) -> None:
    document["assets"]["planks"] = {"uri": "no_such_planks.png"}
    document.setdefault("materials", {})["planks"] = {"base_texture": "planks"}


def let_the_task_fold_the_walls(document: dict[str, Any]) -> None:
    document["task"]["parameters"]["radius"]["max"] = 1.5


def put_the_robot_out_of_reach(document: dict[str, Any]) -> None:
    entity(document, "robot")["robot"]["robot_to_world"]["translation"] = [3.0, 0.3, 0.0]


@pytest.mark.parametrize(
    ("change", "place"),
    [
        (put_the_robot_out_of_reach, "/components/robot/robot_to_world"),
        (let_the_task_fold_the_walls, "#/task/parameters/radius/max"),
        (misspell, "/components/tunnel/stifness"),
        (put_nan, "/components/admittance/mass"),
        (bend_to_a_hairpin, "/components/tunnel/radius"),
        (lose_a_texture, "#/assets/planks/uri"),
    ],
)
def test_broken_scene_is_refused_with_one_line_that_names_the_place(tmp_path, change, place):
    scene = changed_scene(tmp_path, change)
    for command in (("run", scene, "--headless", "--runs", tmp_path), ("check", scene)):
        done = (started if change is misspell else mimics)(*command)
        lines = [line for line in done.stderr.splitlines() if line.strip()]
        assert done.returncode == 3, done.stderr
        assert len(lines) == 1, done.stderr
        assert "wavy_tunnel.json#/" in lines[0]
        assert place in lines[0], lines[0]
    assert not list(tmp_path.glob("2*")), "a refused scene must leave no run folder"
