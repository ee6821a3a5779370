"""A package adds a device with four points of contact of its own names: it plays, is observed, recorded, reported.

No file of the product knows it.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from mimics_app.app.api.loaded_run import load
from mimics_app.contracts.loop.haptic import EventKind
from mimics_app.contracts.loop.loop_fields import point_rows
from mimics_app.recording.run import Run
from tests.support.command import mimics, mimics_with
from tests.support.plugin_site import write_package

ROOT = Path(__file__).resolve().parents[2]
POINTS = ("thumb", "index", "middle", "palm")

DEVICE = '''"""Four rails side by side, two joints each: forward and up; a person pushes each and closes the hand."""

import math

import numpy as np

from mimics_app.compiled.kernel import typed_kernel
from mimics_app.contracts.loop.device_descriptor import KINEMATICS, DeviceDescriptor, Joint, Kinematics, described
from mimics_app.contracts.loop.loop_ports import (
    COMMAND_DQ, COMMAND_ENABLED, DATA_AGE, DATA_DQ, DATA_FORCE, DATA_GRASP, DATA_Q, READ, WRITE, DevicePlugin,
)

APART = 0.1


@typed_kernel(KINEMATICS)
def points(geometry, q, given, out):
    for c in range(4):
        out[3 * c], out[3 * c + 1], out[3 * c + 2] = q[2 * c], APART * (1.5 - c), q[2 * c + 1]
    return 0


@typed_kernel(KINEMATICS)
def by_joint(geometry, q, given, out):
    for i in range(12 * 8):
        out[i] = 0.0
    for c in range(4):
        out[(3 * c) * 8 + 2 * c] = 1.0
        out[(3 * c + 2) * 8 + 2 * c + 1] = 1.0
    return 0


@typed_kernel(READ)
def read(memory, inbox, data, tick):
    for j in range(8):
        memory[j] += 1e-3 * memory[8 + j]
        data[DATA_Q + j], data[DATA_DQ + j] = memory[j], memory[8 + j]
    for c in range(4):
        data[DATA_FORCE + 3 * c] = 0.5 * math.sin(2e-3 * tick + c)
        data[DATA_FORCE + 3 * c + 2] = -2.0 - c
        data[DATA_GRASP + c] = 1.0 + c
    data[DATA_AGE] = 0.0
    return 0


@typed_kernel(WRITE)
def write(memory, command, tick):
    for j in range(8):
        memory[8 + j] = command[COMMAND_DQ + j] if command[COMMAND_ENABLED] != 0.0 else 0.0
    return 0


FOUR = DeviceDescriptor(
    joints=tuple(Joint(f"rail {j}", "m", -0.3, 0.3, 1.0, 20.0, inertia=1.0) for j in range(8)),
    contacts=("thumb", "index", "middle", "palm"),
    kinematics=Kinematics(points, by_joint),
    geometry=lambda robot: (),
)


@described(FOUR)
def build(request):
    return DevicePlugin("four_points", read, write, np.zeros(16), delay=1e-3, simulated=True, descriptor=FOUR)
'''

ENTRY = "[mimics_app.devices]\nfour_points = four_points:build\n"

SCENE = {
    "format": "mimics-scene",
    "version": 1,
    "title": "Four points",
    "entities": [
        {"id": "eye", "transform": {"translation": [1.0, 0.5, 1.0]}, "components": {"camera": {"target": [0, 0, 0]}}},
        {"id": "ground", "components": {"haptic_walls": {"size": [2.0, 2.0, 2.0], "stiffness": 500.0, "damping": 20.0,
                                                         "floor": {"position": [0.0, -0.05, 0.0]}}}},
        {"id": "pull", "transform": {"translation": [0.0, 0.0, 0.0]},
         "components": {"haptic_effect": {
             "contact": "palm", "effect": {"kind": "constant_force", "force": [0, -1, 0]}}}},
        {"id": "hand", "components": {"ball": {"radius_min": 0.01, "radius_max": 0.01}}},
        {"id": "robot", "components": {
            "robot": {"device": "four_points", "robot_to_world": {
                "rotation": [[1, 0, 0], [0, 0, 1], [0, -1, 0]], "translation": [0, 0, 0]}},
            "admittance": {"mass": 4.0, "damping": 20.0}, "joint_pd": {"kp": [2.0], "kd": [0.2]}}},
    ],
    "task": {"goals": [{"kind": "duration", "seconds": 3}], "time_limit_s": 5},
}  # fmt: skip

SEE = """
import json, sys
from pathlib import Path
from mimics_app.tasks.observation import observe
from tests.support.scene_play import ScenePlay
play = ScenePlay(Path(sys.argv[1])).run(3.0)
seen = observe(play.snapshots[-1], play.events, 0)
print(json.dumps({
    "points": [[each.force, each.touching, each.grasp, each.hip_world] for each in seen.points],
    "contacts": sorted({each.point for each in seen.contacts}), "first": seen.grasp, "touching": seen.touching,
}))
"""


@pytest.fixture(scope="module")
def scene(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    folder = tmp_path_factory.mktemp("four")
    site = folder / "site"
    site.mkdir()
    write_package(site, "four_points", DEVICE, ENTRY)
    (folder / "scene.json").write_text(json.dumps(SCENE))
    return folder, site


def test_it_plays_and_is_recorded_and_reported_with_all_points(scene: tuple[Path, Path]) -> None:
    folder, site = scene
    file = folder / "scene.json"
    checked, done = mimics_with(
        site, ["check", file], ["run", file, "--headless", "--seconds", "3", "--runs", folder / "runs", "--json"]
    )
    assert checked.returncode == 0, checked.stdout + checked.stderr
    assert done.returncode == 0, done.stderr
    (run_folder,) = (folder / "runs").iterdir()
    run = Run.open(run_folder)
    assert run.layout.extent.contacts == 4 and run.session["names"]["points"] == list(POINTS)
    for number in range(4):
        point = point_rows(run.haptic, number)
        assert point["grasp"][-1] == 1.0 + number and point["f_meas"][-1, 2] == -2.0 - number
        assert point["depth"].max() > 0.0 and np.abs(point["f_user_world"]).max() > 1.0
        assert abs(point["f_effects"][-1, 1]) == pytest.approx(1.0 if number == 3 else 0.0)
    begun = run.events[run.events["kind"] == EventKind.CONTACT_BEGIN]["body_a"]
    assert {*begun.tolist()} == {0, -2, -3, -4}
    recording = load(run_folder)
    assert np.array_equal(recording.haptic["point_2_hip_world"], point_rows(run.haptic, 2)["hip_world"])
    trial = {name: values[0] for name, values in recording.trials.items()}
    peaks = [trial[f"point_{number}_force_peak_n"] for number in range(4)]
    assert min(peaks) > 1.0 and max(peaks) == trial["force_peak_n"], "of each point, and the largest of all"
    assert sum(trial[f"point_{number}_contacts"] for number in range(4)) == trial["contacts"] >= 4
    assert recording.trials.units["point_3_force_peak_n"] == "N"
    assert mimics("report", run_folder).returncode == 0
    page = (run_folder / "report.html").read_text()
    assert "Points of contact" in page and all(f"{name}, force peak [N]" in page for name in POINTS)


def test_a_task_sees_every_point(scene: tuple[Path, Path]) -> None:
    folder, site = scene
    environment = {**os.environ, "PYTHONPATH": f"{site}{os.pathsep}{ROOT}"}
    command = [sys.executable, "-c", SEE, str(folder / "scene.json")]
    done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    seen = json.loads(done.stdout.splitlines()[-1])
    forces, touching, grasps, places = zip(*seen["points"], strict=True)
    assert grasps == (1.0, 2.0, 3.0, 4.0) and seen["first"] == 1.0
    assert touching == (1, 1, 1, 1) and seen["touching"] == 4 and min(forces) > 1.0
    assert [round(place[2], 3) for place in places] == [-0.15, -0.05, 0.05, 0.15]
    assert seen["contacts"] == [0, 1, 2, 3]


def test_a_point_that_the_device_does_not_have_is_named(scene: tuple[Path, Path]) -> None:
    folder, site = scene
    wrong = json.loads(json.dumps(SCENE))
    wrong["entities"][2]["components"]["haptic_effect"]["contact"] = "left foot"
    (folder / "wrong.json").write_text(json.dumps(wrong))
    (answer,) = mimics_with(site, ["check", folder / "wrong.json"])
    assert answer.returncode != 0
    assert "/entities/2/components/haptic_effect/contact" in answer.stdout + answer.stderr
    assert "touches with thumb, index, middle, palm" in answer.stdout + answer.stderr
