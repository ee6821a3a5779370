"""The scene of the gait orthosis played as the product plays it: legs that swing, a belt that follows the reference."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import mimics_app as mimics
from mimics_app.app.scenes.loading import check_scene, read_scene
from mimics_app.app.session.preparation import prepare_scene
from mimics_app.app.settings import RunSettings
from mimics_app.contracts.loop.haptic import SafetyState
from mimics_app.contracts.system.resources import root
from mimics_app.recording.run import Run
from mimics_app.rendering.haptic.descriptors.segments import segments_of
from mimics_app.rendering.haptic.devices.simulated_lokomat import PLANT, SETTINGS
from mimics_app.rendering.haptic.kernels.lokomat import gait_person, linkage, orthosis, treadmill
from mimics_app.world.components.robot import Robot
from tests.support.command import mimics as command
from tests.support.core_play import change_component

SWING = root() / "scenes" / "examples" / "lokomat_free_swing.json"


def _changed(folder: Path, robot: dict, patient: dict) -> Path:
    """The scene with more components of the robot, and another patient."""
    document = json.loads(SWING.read_text())
    for entity in document["entities"]:
        if entity["id"] == "robot":
            entity["components"] |= robot
        if entity["id"] == "patient":
            entity["components"]["patient"] = patient
    file = folder / "changed.json"
    file.write_text(json.dumps(document))
    return file


@pytest.fixture(scope="module")
def swung(tmp_path_factory: pytest.TempPathFactory) -> tuple[Run, dict]:
    """A run of the scene for 10 s, and the answer to the terminal."""
    runs = tmp_path_factory.mktemp("runs")
    answer = json.loads(command("run", SWING, "--headless", "--seconds", 10, "--runs", runs, "--json").stdout)
    return Run.open(Path(answer["run_dir"])), answer


def test_the_result_says_how_much_the_orthosis_resists_to_legs_that_swing(swung: tuple[Run, dict]) -> None:
    """What the rods exert beyond the weight of the parts of the orthosis, which this test takes from its pendulums."""
    run, answer = swung
    samples = run.haptic[run.haptic["state"] == SafetyState.ACTIVE]
    hip, knee = samples["q"][:, 0:4:2], samples["q"][:, 1:4:2]
    assert np.ptp(hip, axis=0).min() > 0.3 and np.ptp(knee, axis=0).min() > 0.5, "both legs swing"
    own = segments_of(1.75, 75.0)
    thigh, shank = 9.81 * SETTINGS["thigh_orthosis"], 9.81 * SETTINGS["shank_orthosis"]
    lower = -shank * own.coms[1] * np.sin(hip - knee)
    upper = (thigh * own.coms[0] + shank * own.thigh) * np.sin(hip) - lower
    for joint, weight, name in ((0, upper, "hip"), (1, lower, "knee")):
        felt = -samples["torque_meas"][:, joint:4:2] - weight
        told = answer["residual_torque_nm"][name]
        assert np.sqrt(np.mean(felt**2, axis=0)) == pytest.approx(told, rel=0.01)
    assert f"{max(answer['residual_torque_nm']['hip']):.1f} N m" in Path(answer["report"]).read_text(encoding="utf-8")


def test_a_foot_that_has_arrived_stays_ready_whatever_its_encoders_flicker(swung: tuple[Run, dict]) -> None:
    state = swung[0].haptic["state"].astype(int)
    begun = state[np.flatnonzero(np.diff(state, prepend=-1))].tolist()
    came_up = [SafetyState.INIT, SafetyState.HOMED, SafetyState.READY]
    assert begun[:3] == came_up and begun[-2:] == [SafetyState.READY, SafetyState.ACTIVE] and len(begun) <= 6


def test_the_drawn_drive_is_the_simulated_one():
    with mimics.open(SWING, record="memory") as session:
        session.step(4.0)
    q = session.haptic["q"]
    for number, (side, name) in enumerate((side, name) for side in ("left", "right") for name in ("hip", "knee")):
        pivot, lever = (session.world.find(f"{side}_{name}_{end}").world_matrix() for end in ("pivot", "lever"))
        link = np.array([*(SETTINGS[f"{name}_{what}"] for what in ("fixed_arm", "moved_arm", "offset")), -1.0])
        shaft = linkage.eta_of(link, float(q[-1, number]))
        assert np.linalg.norm((lever - pivot)[:3, 3]) == pytest.approx(shaft, abs=1e-3)


def test_the_belt_runs_with_the_reference_and_stands_before_it(tmp_path: Path):
    walk = {"joint_reference": {"body_height": 1.75, "speed": 0.5, "guidance": 0.0}}
    with mimics.open(_changed(tmp_path, walk, {"intent": False}), record="memory") as session:
        session.step(2.0)
        belt = session._begun.haptics.plugin.memory[PLANT][orthosis.BELT + treadmill.BELT_SPEED :][:1]
        assert belt[0] == 0.0 and session.haptic["amplitude"][-1] == 0.0
        session.step(8.0)
        assert session.haptic["amplitude"][-1] == pytest.approx(1.0, abs=1e-3)
        assert belt[0] == pytest.approx(0.5, abs=1e-3)


def test_a_person_in_the_orthosis_walks_without_a_target(tmp_path: Path):
    file = _changed(tmp_path, {"safety": {"velocity_limit": 10.0}}, {"intent": True})
    with mimics.open(file, record="memory") as session:
        session.step(9.0)
    haptic = session.haptic
    active = np.asarray(haptic["state"]) == SafetyState.ACTIVE
    assert np.ptp(haptic["q"][active][-1500:, :4], axis=0).min() > 0.2


@pytest.mark.parametrize(
    ("asked", "person"), [("", "healthy"), ("moderate", "hemiparetic_left"), ("severe", "sci_incomplete")]
)
def test_the_patient_of_the_command_line_walks_in_the_orthosis(asked: str, person: str) -> None:
    walkers = []
    for settings in ({"patient": asked}, {}):
        scene = check_scene(read_scene(SWING))
        if not settings:
            robot = scene.first(Robot)
            change_component(scene, "robot", settings={**robot.settings, "person": person})
        memory = prepare_scene(scene, RunSettings(SWING, **settings)).plugin.memory
        walkers.append(memory[PLANT.start - gait_person.WALKER : PLANT.start])
    assert np.array_equal(*walkers)
